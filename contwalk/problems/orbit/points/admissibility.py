"""Limits that the plugin declares (AZ): a condition, or a guard that is only watched, is zero."""

from __future__ import annotations

from contwalk.problems.orbit.points.limit import OrbitLimit


class Admissibility(OrbitLimit):
    """What the machine is declared to keep to is lost; nothing happens there."""

    label, reason = "AZ", "inadmissible"
    declared = True
