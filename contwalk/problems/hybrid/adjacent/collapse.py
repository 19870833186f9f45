"""A leg lasts no time: the orbit as one whose leg is passed in no time, or lasts again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid import locating_limits
from contwalk.problems.hybrid.adjacent.orbit import AdjacentOrbit, assembled, own_limit, starts_and_durations
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit


def collapses(problem: LimitedOrbit, limit: Limit) -> bool:
    """Whether a leg whose duration vanishes is passed in no time beyond."""
    return limit.test == "duration" and locating_limits.collapses(problem, limit.leg)


def collapsed(problem: LimitedOrbit, z: np.ndarray, changing: Sequence[Limit]) -> AdjacentOrbit:
    """Legs last no time any more, their guards being past zero where they begin; or they do again.

    z has shape (N + 1,).
    """
    legs = list(problem.itinerary.legs)
    states, lasting, start = starts_and_durations(problem, z)
    for each in changing:
        legs[each.leg] = replace(legs[each.leg], collapsed=each.test != "past")
        lasting[each.leg] = 0.0
    i, past = changing[0].leg, changing[0].test != "past"
    other, unknowns = assembled(
        problem, replace(problem.itinerary, legs=tuple(legs)), states, lasting, start, z
    )
    return AdjacentOrbit(other, unknowns, own_limit(other, i, "past" if past else "duration"))
