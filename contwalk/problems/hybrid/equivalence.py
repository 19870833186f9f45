"""Whether two solutions are one orbit, which may begin at different places of itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.hybrid import cutting
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.meeting import distance
from contwalk.problems.problem import Sample

# Two orbits whose periods and states differ by less than this part are one; a leg looked at closely.
ALIKE = 1e-6
CLOSELY = np.linspace(0.0, 1.0, 2048)


def same(orbit: LimitedOrbit, a: Sample, b: Sample) -> bool:
    """Whether two solutions at the same parameter are one orbit."""
    if abs(a.period - b.period) > ALIKE * abs(a.period):
        return False
    if orbit.cuttable:
        a, b = (
            replace(each, z=cutting.bare(orbit, each.z), weights=cutting.bare(orbit, each.weights))
            for each in (a, b)
        )
    if len(a.z) != len(b.z):
        return False
    if not (orbit.itinerary.eventful or orbit.forced):
        return first_passed(orbit, b.z, [orbit.first_state(a.z)]) is not None
    there = orbit.nearest_turn(a.z, b.z)
    return bool(np.linalg.norm((there - b.z) / b.weights) < 30.0 * ALIKE)


def first_passed(orbit: LimitedOrbit, z: np.ndarray, points: Sequence[np.ndarray]) -> int | None:
    """Number of the first of some states at which a leg of the orbit of z starts; which it passes, if it
    begins anywhere. None if there is none.

    z has the shape (N + 1,), each point (n,).
    """
    periods = np.array([s.period or 0.0 for s in orbit.system.states])
    if not (orbit.itinerary.eventful or orbit.pins):
        curve = np.concatenate([stretch.at(CLOSELY)[1] for stretch in orbit.stretches(z)])
        scale = orbit.mesh.variation
        near = (k for k, x in enumerate(points) if distance(curve, x, periods, scale) < 30.0 * ALIKE)
        return next(near, None)
    for number, x in enumerate(points):
        if _starts_a_leg(orbit, z, x, periods):
            return number
    return None


def _starts_a_leg(orbit: LimitedOrbit, z: np.ndarray, x: np.ndarray, periods: np.ndarray) -> bool:
    """Whether a leg of the orbit of z starts at a state, up to neutral directions."""
    for place, passage in zip(orbit.layout.states, orbit.passages, strict=True):
        start = passage.full(z[place])
        apart = x - start
        apart = apart - whole_turns(apart, periods)
        along = neutrals.directions(orbit.system, orbit.pins, start, orbit.values_of(z))
        apart = neutrals.across(apart, along, orbit.mesh.variation)
        if float(np.linalg.norm(apart / orbit.mesh.variation)) < 30.0 * ALIKE:
            return True
    return False
