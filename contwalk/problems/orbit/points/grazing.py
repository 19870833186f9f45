"""Grazings (GR): an event is touched, and happens on one side only."""

from __future__ import annotations

from contwalk.problems.orbit.points.limit import OrbitLimit


class Grazing(OrbitLimit):
    """An event is touched."""

    label, reason = "GR", "grazing"
