"""Curves of orbits from what is stored of them, and from what is stored of the branch that they leave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any

from contwalk.problems.locus.lines import whole_plane
from contwalk.problems.locus.orbit_curves import curve_of
from contwalk.problems.locus.orbit_locus import OrbitLocus
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.restoring import RESTORED_BY, Facts


def restored(facts: Facts) -> OrbitLocus:
    """The problem of a stored curve, not yet discretised."""
    first, second = facts.info.free
    plane = plane_of(facts, str(facts.info.settings["of_problem"]), (first, second))
    return OrbitLocus(plane, curve_of(facts.info.settings))


def plane_of(
    facts: Facts, kind: str, free: tuple[str, str], parameters: Mapping[str, float] | None = None
) -> OrbitPlane:
    """Orbits of a kind (`periodic_orbit` or `hybrid_orbit`) as two parameters vary, not yet discretised.

    `facts` are those of a stored branch of such orbits, or of a curve of them.
    """
    known = dict(parameters or facts.parameters)
    own = replace(facts, info=replace(facts.info, problem=kind, free=("path",)), parameters=known)
    orbit: Any = import_module(RESTORED_BY[kind]).restored(replace(own, ends=whole_plane(known, free)))
    return OrbitPlane(orbit, free)
