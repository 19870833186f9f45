"""Two events happen at once: the orbit as one in which they happen in the other order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid.adjacent.orbit import (
    CHANGES,
    AdjacentOrbit,
    NoAdjacentOrbit,
    after_transition,
    alike,
    assembled,
    falling_as,
    own_limit,
    starts_and_durations,
    state_on_leg,
)
from contwalk.problems.hybrid.adjacent.removal import visit, without_visit
from contwalk.problems.hybrid.adjacent.skipped import without_first
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.switching import discretized
from contwalk.problems.orbit.itinerary import Leg


def _exchanged(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> AdjacentOrbit:
    """Two transitions that happen at once happen in the other order."""
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    if m < 2:
        raise NoAdjacentOrbit("the itinerary has one event only.")
    before = (i - 1) % m
    first, second = problem.itinerary.legs[before].transition, problem.itinerary.legs[i].transition
    assert first is not None
    assert second is not None
    origin, target = problem.itinerary.legs[before].mode, problem.itinerary.target(i)
    earlier = [t for t in problem.system.leaving(origin) if alike(t, second)]
    later = [t for t in problem.system.acting if alike(t, first) and t.target == target]
    pairs = [(b, a) for b in earlier for a in later if b.target == a.source]
    if not pairs:
        raise NoAdjacentOrbit(
            f"out of mode '{origin}' no '{second.name}' leads to a mode in which '{first.name}' leads to "
            f"'{target}'."
        )
    b, a = pairs[0]
    states, lasting, start = starts_and_durations(there, z)
    t = float(there.starting_times(z)[before]) + lasting[before]
    x = state_on_leg(there, z, before, 1.0)
    legs = list(problem.itinerary.legs)
    legs[before] = Leg(origin, b, falling_as(b, legs[i]))
    legs[i] = Leg(b.target, a, falling_as(a, problem.itinerary.legs[before]))
    middle = after_transition(problem, legs[before], x, t, z)
    end = after_transition(problem, legs[i], middle, t, z)
    following = (i + 1) % m
    apart = np.abs(end - states[following]) / there.mesh.variation
    if float(apart.max()) > CHANGES:
        k = int(np.argmax(apart))
        raise NoAdjacentOrbit(
            f"'{second.name}' before '{first.name}' leads to another '{problem.system.state_names[k]}' "
            f"than after it ({end[k]:.6g} and {states[following][k]:.6g}), so that no orbit in that order is "
            "near."
        )
    states[i], lasting[i] = middle, 0.0
    other, unknowns = assembled(
        there, replace(problem.itinerary, legs=tuple(legs)), states, lasting, start, z
    )
    return AdjacentOrbit(other, unknowns, own_limit(other, i, "duration"))


def gone(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> AdjacentOrbit:
    """A leg that lasts no time: the events at its ends happen in the other order, or the first of them does
    not happen, or neither where it was a visit in another mode.

    z has shape (N + 1,).
    """
    try:
        return _exchanged(problem, z, limit)
    except NoAdjacentOrbit:
        neighbour = without_first(problem, z, limit)
        if neighbour is not None:
            return neighbour
        m, legs = problem.layout.legs, problem.itinerary.legs
        first = visit(problem, z, (limit.leg - 1) % m)
        if first is None or legs[first].mode == legs[(first + 1) % m].mode:
            raise
        return without_visit(problem, z, first)
