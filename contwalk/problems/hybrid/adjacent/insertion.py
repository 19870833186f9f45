"""A guard is touched: the orbit as one in which its event happens, with no speed."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid import limits
from contwalk.problems.hybrid.adjacent.orbit import (
    AdjacentOrbit,
    NoAdjacentOrbit,
    assembled,
    opened,
    own_limit,
    refuse_change,
    starting_after,
)
from contwalk.problems.hybrid.adjacent.visiting import visited
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Transition


def inserted(
    problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float, transition: Transition
) -> AdjacentOrbit:
    """The event that is touched happens.

    z has shape (N + 1,).
    """
    i = limit.leg
    old = problem.itinerary.legs[i]
    falls = transition.direction != "rising"
    leg = Leg(old.mode, transition, falls if transition.direction != "both" else _falls(problem, z, limit))
    if transition.target != old.mode:
        visit = visited(problem, z, limit, place, leg)
        if visit is not None:
            return visit
        rest = ", ".join(leg.name for leg in problem.itinerary.legs[i:] if leg.name)
        follows = f"the rest of the itinerary ({rest}) does" if rest else "a motion without events does"
        raise NoAdjacentOrbit(
            f"after '{transition.name}' the machine is in mode '{transition.target}', from where {follows} "
            "not follow."
        )
    at = opened(problem, z, i, place)
    there, states, lasting, start, after = at.orbit, at.states, at.lasting, at.start, at.after(leg)
    refuse_change(there, transition, at.x, after)
    itinerary = problem.itinerary.inserted(i, leg)
    first, second = place * lasting[i], (1.0 - place) * lasting[i]
    states = [*states[: i + 1], after, *states[i + 1 :]]
    lasting = [*lasting[:i], first, second, *lasting[i + 1 :]]
    if not problem.itinerary.eventful:
        itinerary, states, lasting = starting_after(there, z, itinerary, i, states, lasting)
        start, i = at.t, len(itinerary) - 1
    other, unknowns = assembled(there, itinerary, states, lasting, start, z)
    return AdjacentOrbit(other, unknowns, own_limit(other, i, "rate"))


def _falls(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> bool:
    """Whether a guard of direction `both` comes down to zero: it is positive elsewhere on its leg."""
    values = discretized(problem, z).view(z)[limit.leg].guard_values(limits.transition_of(problem, limit))
    return bool(values[int(np.argmax(np.abs(values)))] > 0.0)
