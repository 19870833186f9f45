"""A guard is touched: the orbit as one in which its event happens, with no speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid import limits
from contwalk.problems.hybrid.adjacent.orbit import (
    AdjacentOrbit,
    NoAdjacentOrbit,
    after_transition,
    assembled,
    own_limit,
    refuse_change,
    starts_and_durations,
    state_on_leg,
)
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.hybrid.switching import discretized
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.itinerary import Itinerary, Leg, continued, imaged_leg
from contwalk.system import Transition
from contwalk.system.declarations import ParameterValues


def inserted(
    problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float, transition: Transition
) -> AdjacentOrbit:
    """The event that is touched happens.

    z has shape (N + 1,).
    """
    there, i = discretized(problem, z), limit.leg
    old = problem.itinerary.legs[i]
    if transition.target != old.mode:
        rest = ", ".join(leg.name for leg in problem.itinerary.legs[i:] if leg.name)
        follows = f"the rest of the itinerary ({rest}) does" if rest else "a motion without events does"
        raise NoAdjacentOrbit(
            f"after '{transition.name}' the machine is in mode '{transition.target}', from where {follows} "
            "not follow."
        )
    falls = transition.direction != "rising"
    leg = Leg(old.mode, transition, falls if transition.direction != "both" else _falls(there, z, limit))
    states, lasting, start = starts_and_durations(there, z)
    x, t = state_on_leg(there, z, i, place), float(there.starting_times(z)[i]) + place * lasting[i]
    after = after_transition(problem, leg, x, t, z)
    refuse_change(there, transition, x, after)
    itinerary = problem.itinerary.inserted(i, leg)
    first, second = place * lasting[i], (1.0 - place) * lasting[i]
    states = [*states[: i + 1], after, *states[i + 1 :]]
    lasting = [*lasting[:i], first, second, *lasting[i + 1 :]]
    if not problem.itinerary.eventful:
        itinerary, states, lasting = _after_event(there, z, itinerary, i, states, lasting)
        start, i = t, len(itinerary) - 1
    other, unknowns = assembled(there, itinerary, states, lasting, start, z)
    return AdjacentOrbit(other, unknowns, own_limit(other, i, "rate"))


def _after_event(
    problem: LimitedOrbit,
    z: np.ndarray,
    itinerary: Itinerary,
    i: int,
    states: list[np.ndarray],
    lasting: list[float],
) -> tuple[Itinerary, list[np.ndarray], list[float]]:
    """What begins between events, as beginning right after the event that ends leg i: that leg comes last."""
    symmetry = problem.system.symmetry(itinerary.image) if itinerary.image else None
    p, early = ParameterValues(**problem.values_of(z)), itinerary.legs[: i + 1]
    if symmetry is not None:
        early = tuple(imaged_leg(problem.system, itinerary.image, leg) for leg in early)
    legs = continued((*itinerary.legs[i + 1 :], *early))
    # The last leg goes on as the first one.
    given = [*states[i + 1 :], *(imaged(symmetry, x, p) for x in states[1 : i + 1])]
    joined = [*lasting[i + 1 : -1], lasting[-1] + lasting[0], *lasting[1 : i + 1]]
    return replace(itinerary, legs=legs), given, joined


def _falls(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> bool:
    """Whether a guard of direction `both` comes down to zero: it is positive elsewhere on its leg."""
    values = problem.view(z)[limit.leg].guard_values(limits.transition_of(problem, limit))
    return bool(values[int(np.argmax(np.abs(values)))] > 0.0)
