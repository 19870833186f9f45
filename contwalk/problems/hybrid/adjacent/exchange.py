"""Two events happen at once: the orbit as one in which they happen in the other order, or one of them alone.

A current that comes to zero just when the clock ticks: a tick takes the machine to the same mode with the
same state, whether the current's event came first or not.
"""

from __future__ import annotations

from collections.abc import Sequence
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
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.switching import discretized
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Transition


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


def without_first(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> AdjacentOrbit | None:
    """Of two events that happen at once the first does not happen; None where the other one leads elsewhere.

    z has shape (N + 1,).
    """
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    if m < 2:
        return None
    before, following = (i - 1) % m, (i + 1) % m
    first, last = problem.itinerary.legs[before], problem.itinerary.legs[i]
    assert first.transition is not None
    assert last.transition is not None
    states, lasting, start = starts_and_durations(there, z)
    t = float(there.starting_times(z)[before]) + lasting[before]
    x = state_on_leg(there, z, before, 1.0)
    target, scale = problem.itinerary.target(i), there.mesh.variation
    for other in problem.system.leaving(first.mode):
        if not alike(other, last.transition) or other.target != target or other.role == "soft":
            continue
        leg = Leg(first.mode, other, falling_as(other, last))
        if _apart(after_transition(problem, leg, x, t, z), states[following], scale) > CHANGES:
            continue
        legs = list(problem.itinerary.legs)
        legs[before] = leg
        rest = [k for k in range(m) if k != i]
        start = start + lasting[i] if i == 0 else start
        itinerary = replace(problem.itinerary, legs=tuple(legs[k] for k in rest))
        given = [states[k] for k in rest], [lasting[k] for k in rest]
        neighbour, unknowns = assembled(there, itinerary, *given, start, z)
        return AdjacentOrbit(neighbour, unknowns, _at_end(neighbour, rest.index(before), first.transition))
    return None


def with_first(problem: LimitedOrbit, z: np.ndarray, limit: Limit, transition: Transition) -> AdjacentOrbit:
    """An event whose guard is zero where another one ends the leg happens just before it.

    z has shape (N + 1,).

    Raises
    ------
    NoAdjacentOrbit
        If after it the other one does not lead on.
    """
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    old, target = problem.itinerary.legs[i], problem.itinerary.target(i)
    assert old.transition is not None
    refused = NoAdjacentOrbit(
        f"'{limit.name}' and '{old.name}' happen at once there, and no itinerary with both is known."
    )
    if problem.itinerary.image and i == m - 1:
        raise refused
    states, lasting, start = starts_and_durations(there, z)
    t = float(there.starting_times(z)[i]) + lasting[i]
    leg = Leg(old.mode, transition, transition.direction != "rising")
    middle = after_transition(problem, leg, state_on_leg(there, z, i, 1.0), t, z)
    for other in problem.system.leaving(transition.target):
        if not alike(other, old.transition) or other.target != target or other.role == "soft":
            continue
        last = Leg(transition.target, other, falling_as(other, old))
        after = after_transition(problem, last, middle, t, z)
        if _apart(after, states[(i + 1) % m], there.mesh.variation) > CHANGES:
            continue
        legs = (*problem.itinerary.legs[:i], leg, last, *problem.itinerary.legs[i + 1 :])
        states, lasting = [*states[: i + 1], middle, *states[i + 1 :]], _with(lasting, i)
        neighbour, unknowns = assembled(
            there, replace(problem.itinerary, legs=legs), states, lasting, start, z
        )
        return AdjacentOrbit(neighbour, unknowns, own_limit(neighbour, i + 1, "duration"))
    raise refused


def _with(lasting: Sequence[float], i: int) -> list[float]:
    """Durations with a leg of no time after leg i."""
    return [*lasting[: i + 1], 0.0, *lasting[i + 1 :]]


def _apart(a: np.ndarray, b: np.ndarray, scale: np.ndarray) -> float:
    """How far two states are apart. All have shape (n,)."""
    return float(np.abs((a - b) / scale).max())


def _at_end(problem: LimitedOrbit, i: int, transition: Transition) -> Limit:
    """The guard of another transition at the end of leg i."""
    return next(o for o in problem.limits if (o.leg, o.test, o.name) == (i, "end", transition.name))
