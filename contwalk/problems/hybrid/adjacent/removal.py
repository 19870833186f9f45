"""An event arrives with no speed: the orbit as one in which it does not happen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid.adjacent.orbit import (
    AdjacentOrbit,
    NoAdjacentOrbit,
    across_symmetry,
    assembled,
    minimum_of,
    refuse_change,
    starts_and_durations,
    state_on_leg,
)
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.system import Transition

# A leg that lasts less, in parts of the closure, is one of no time where its ends are limits.
VISITED = 1e-5


def removed(problem: LimitedOrbit, z: np.ndarray, limit: Limit, transition: Transition) -> AdjacentOrbit:
    """The event that arrives with no speed does not happen.

    z has shape (N + 1,).
    """
    there, i, m = discretized(problem, z), limit.leg, problem.layout.legs
    following = (i + 1) % m
    target = transition.target if m == 1 else problem.itinerary.legs[following].mode
    if target != problem.itinerary.legs[i].mode:
        first = visit(problem, z, i)
        if first is not None:
            return without_visit(problem, z, first)
        raise NoAdjacentOrbit(
            f"without '{transition.name}' the machine stays in mode '{problem.itinerary.legs[i].mode}', from "
            "where the rest of the itinerary does not follow."
        )
    states, lasting, start = starts_and_durations(there, z)
    refuse_change(
        there, transition, state_on_leg(there, z, i, 1.0), across_symmetry(there, z, states[following], i)
    )
    if m == 1:
        return _quiet(there, z, transition, start)
    itinerary = problem.itinerary.without(i)
    merged = lasting[i] + lasting[following]
    if following == 0:  # the first leg now begins where the last one did
        kept, times = [states[i], *states[1:i]], [merged, *lasting[1:i]]
        start -= lasting[i]
        place = 0
    else:
        kept = [*states[: i + 1], *states[i + 2 :]]
        times = [*lasting[:i], merged, *lasting[i + 2 :]]
        place = i
    other, unknowns = assembled(there, itinerary, kept, times, start, z)
    return AdjacentOrbit(other, unknowns, minimum_of(other, place, transition))


def visit(problem: LimitedOrbit, z: np.ndarray, i: int) -> int | None:
    """The leg, i or the one before, whose event leads into a mode that is left again at once, back again.

    z has shape (N + 1,).
    """
    itinerary, lasting, m = problem.itinerary, z[problem.layout.durations], problem.layout.legs
    for first in (i, (i - 1) % m):
        visited = (first + 1) % m
        back = itinerary.target(visited) == itinerary.legs[first].mode and not itinerary.image
        if m > 1 and back and abs(float(lasting[visited])) < VISITED * problem.duration(z):
            return first
    return None


def without_visit(problem: LimitedOrbit, z: np.ndarray, first: int) -> AdjacentOrbit:
    """A mode is not entered in which the orbit is for no time: the events at both its ends do not happen.

    z has shape (N + 1,).
    """
    there, z = rotated(problem, z, first) if first else (discretized(problem, z), z)
    legs, transition = there.itinerary.legs, there.itinerary.legs[0].transition
    assert transition is not None
    states, lasting, start = starts_and_durations(there, z)
    refuse_change(there, transition, state_on_leg(there, z, 0, 1.0), states[2 % len(legs)])
    if len(legs) == 2:
        return _quiet(there, z, transition, start)
    itinerary = replace(there.itinerary, legs=(replace(legs[2], mode=legs[0].mode), *legs[3:]))
    given = [states[0], *states[3:]], [sum(lasting[:3]), *lasting[3:]]
    other, unknowns = assembled(there, itinerary, *given, start, z)
    return AdjacentOrbit(other, unknowns, minimum_of(other, 0, transition))


def _quiet(problem: LimitedOrbit, z: np.ndarray, transition: Transition, start: float) -> AdjacentOrbit:
    """The only event of an itinerary does not happen: an orbit without events, over the whole cycle."""
    lasting, begin = problem.duration(z), start
    whole = problem.rounds * lasting
    if problem.forced:
        period = whole / problem.subharmonic
        begin = np.ceil(start / period - 1e-12) * period
    # By rounding the cycle may begin a little after the period that it is held to begin with.
    share = min(max((begin - start) / lasting, 0.0), float(problem.rounds))
    x = (
        state_on_leg(problem, z, 0, share)
        if share <= 1.0
        else across_symmetry(problem, z, state_on_leg(problem, z, 0, share - 1.0), 0)
    )
    itinerary = Itinerary((Leg(problem.itinerary.legs[0].mode),))
    other, unknowns = assembled(problem, itinerary, [x], [whole], 0.0, z)
    return AdjacentOrbit(other, unknowns, minimum_of(other, 0, transition))
