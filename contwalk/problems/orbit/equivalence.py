"""Whether two solutions are one orbit, which may begin at different places of itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.distance_to_orbit import distance
from contwalk.problems.orbit.extrema import with_extrema
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.orbit.view import SAMPLES
from contwalk.problems.problem import Sample

# Two orbits whose periods and states differ by less than this part are one.
ALIKE = 1e-6
# In how many samples an orbit is compared with a state: few miss a fast piece of it, and an orbit that
# comes this near, in units of its range, may pass it.
SEEN_FROM, PERHAPS = (4 * SAMPLES, 64 * SAMPLES), 1e-2


def same(orbit: DiscretizedOrbit, a: Sample, b: Sample, error: float = 0.0) -> bool:
    """Whether two solutions at the same parameter are one orbit; `b` is on this discretisation.

    `error` is what they are known to, against their size, where that is more than orbits on their own are.
    """
    if abs(a.period - b.period) > max(ALIKE, error) * abs(a.period):
        return False
    if not orbit.itinerary.eventful:
        return first_passed(orbit, b.z, [orbit.first_state(a.z)], error) is not None
    (there, known), weights = (orbit.bare(z) for z in (a.z, b.z)), orbit.bare(b.weights)
    if len(there) != len(known):
        return False
    there = orbit.nearest_turn(there, known)
    return bool(np.linalg.norm((there - known) / weights) < max(30.0 * ALIKE, error))


def first_passed(
    orbit: DiscretizedOrbit, z: np.ndarray, points: Sequence[np.ndarray], error: float = 0.0
) -> int | None:
    """Number of the first of some states at which a leg of the orbit of z starts; which it passes, if it
    begins anywhere. None if there is none.

    z has the shape (N + 1,), each point (n,). `error` is that of the points, against their size: a small
    cycle far from zero is known to less of its own range.
    """
    periods = np.array([s.period or 0.0 for s in orbit.system.states])
    near = [_alike(x / orbit.mesh.variation, error) for x in points]
    if not orbit.itinerary.eventful:
        passed = _first_on_the_way(orbit, z, points, near)
        if passed is not None or not orbit.pins:
            return passed
    each = zip(points, near, strict=True)
    return next((k for k, (x, most) in enumerate(each) if _starts_a_leg(orbit, z, x, periods, most)), None)


def _alike(in_ranges: np.ndarray, error: float) -> float:
    """How near a state that is one comes, both in units of the orbit's range, shape (n,)."""
    return min(max(30.0 * ALIKE, error * float(np.linalg.norm(in_ranges))), PERHAPS)


def _first_on_the_way(
    orbit: DiscretizedOrbit, z: np.ndarray, points: Sequence[np.ndarray], near: Sequence[float]
) -> int | None:
    """As `first_passed`: the number of the first state that the motion passes within what is `near`."""
    periods = np.array([s.period or 0.0 for s in orbit.system.states])
    stretches = orbit.stretches(z)
    for number in SEEN_FROM:
        whole = np.concatenate([_closely(stretch, number) for stretch in stretches])
        apart = [distance(whole, x, periods, orbit.mesh.variation) for x in points]
        passed = next((k for k, away in enumerate(apart) if away < near[k]), None)
        if passed is not None or min(apart, default=np.inf) > PERHAPS:
            return passed
    return None


def _closely(stretch: Stretch, number: int) -> np.ndarray:
    """Full states along a leg of the whole motion, at so many instants and where one is extreme."""
    view = stretch.view
    times, states = with_extrema(view.at, *view.sampled(number))
    return stretch.seen(view.start + view.duration * times, view.full(states))


def _starts_a_leg(
    orbit: DiscretizedOrbit, z: np.ndarray, x: np.ndarray, periods: np.ndarray, near: float
) -> bool:
    """Whether a leg of the orbit of z starts at a state, up to neutral directions."""
    for place, passage in zip(orbit.layout.states, orbit.passages, strict=True):
        start = passage.full(z[place])
        apart = x - start
        apart = apart - whole_turns(apart, periods)
        along = neutrals.directions(orbit.system, orbit.pins, start, orbit.values_of(z))
        apart = neutrals.across(apart, along, orbit.mesh.variation)
        if float(np.linalg.norm(apart / orbit.mesh.variation)) < near:
            return True
    return False
