"""Two events happen at once: the orbit as one in which they happen in the other order, or one of them alone.

A current that comes to zero just when the clock ticks: a tick takes the machine to the same mode with the
same state, whether the current's event came first or not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid.adjacent.orbit import (
    CHANGES,
    AdjacentOrbit,
    NoAdjacentOrbit,
    alike,
    assembled,
    falling_as,
    opened,
    own_limit,
)
from contwalk.problems.hybrid.adjacent.removal import visit, without_visit
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Transition


def _exchanged(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> AdjacentOrbit:
    """Two transitions that happen at once happen in the other order."""
    i, m = limit.leg, problem.layout.legs
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
    at = opened(problem, z, before)
    there, states, lasting = at.orbit, at.states, at.lasting
    legs = list(problem.itinerary.legs)
    legs[before] = Leg(origin, b, falling_as(b, legs[i]))
    legs[i] = Leg(b.target, a, falling_as(a, problem.itinerary.legs[before]))
    middle = at.after(legs[before])
    end = at.after(legs[i], middle)
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
    itinerary = replace(problem.itinerary, legs=tuple(legs))
    other, unknowns = assembled(there, itinerary, states, lasting, at.start, z)
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
    i, m = limit.leg, problem.layout.legs
    if m < 2:
        return None
    before, following = (i - 1) % m, (i + 1) % m
    first, last = problem.itinerary.legs[before], problem.itinerary.legs[i]
    assert first.transition is not None
    at = opened(problem, z, before)
    there, states, lasting, scale = at.orbit, at.states, at.lasting, at.orbit.mesh.variation
    for leg in _ending_as(problem, first.mode, last, problem.itinerary.target(i)):
        if _apart(at.after(leg), states[following], scale) > CHANGES:
            continue
        legs = list(problem.itinerary.legs)
        legs[before] = leg
        rest = [k for k in range(m) if k != i]
        start = at.start + lasting[i] if i == 0 else at.start
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
    i, m = limit.leg, problem.layout.legs
    old, target = problem.itinerary.legs[i], problem.itinerary.target(i)
    if problem.itinerary.image and i == m - 1:
        raise both_at_once(problem, limit)
    at = opened(problem, z, i)
    there, states, lasting = at.orbit, at.states, at.lasting
    leg = Leg(old.mode, transition, transition.direction != "rising")
    middle = at.after(leg)
    for last in _ending_as(problem, transition.target, old, target):
        if _apart(at.after(last, middle), states[(i + 1) % m], there.mesh.variation) > CHANGES:
            continue
        itinerary = problem.itinerary.inserted(i, leg)
        itinerary = replace(itinerary, legs=(*itinerary.legs[: i + 1], last, *itinerary.legs[i + 2 :]))
        given = [*states[: i + 1], middle, *states[i + 1 :]], [*lasting[: i + 1], 0.0, *lasting[i + 1 :]]
        neighbour, unknowns = assembled(there, itinerary, *given, at.start, z)
        return AdjacentOrbit(neighbour, unknowns, own_limit(neighbour, i + 1, "duration"))
    raise both_at_once(problem, limit)


def both_at_once(problem: LimitedOrbit, limit: Limit) -> NoAdjacentOrbit:
    """Nothing is known of an event that happens together with that which ends its leg."""
    name = problem.itinerary.legs[limit.leg].name
    return NoAdjacentOrbit(
        f"'{limit.name}' and '{name}' happen at once there, and no itinerary with both is known."
    )


def _ending_as(problem: LimitedOrbit, mode: str, like: Leg, target: str) -> Iterator[Leg]:
    """Legs of a mode that end as another one does, and lead to a mode."""
    assert like.transition is not None
    for other in problem.system.leaving(mode):
        if alike(other, like.transition) and other.target == target and other.role != "soft":
            yield Leg(mode, other, falling_as(other, like))


def _apart(a: np.ndarray, b: np.ndarray, scale: np.ndarray) -> float:
    """How far two states are apart. All have shape (n,)."""
    return float(np.abs((a - b) / scale).max())


def _at_end(problem: LimitedOrbit, i: int, transition: Transition) -> Limit:
    """The guard of another transition at the end of leg i."""
    return next(o for o in problem.limits if (o.leg, o.test, o.name) == (i, "end", transition.name))
