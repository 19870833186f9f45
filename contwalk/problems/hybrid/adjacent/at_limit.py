"""Which limit a point is, and the orbit there as one of the itinerary beyond it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.hybrid import limits, locating_limits
from contwalk.problems.hybrid.adjacent.collapse import collapsed, collapses
from contwalk.problems.hybrid.adjacent.exchange import both_at_once, gone, with_first
from contwalk.problems.hybrid.adjacent.insertion import inserted
from contwalk.problems.hybrid.adjacent.orbit import AdjacentOrbit, NoAdjacentOrbit
from contwalk.problems.hybrid.adjacent.removal import removed
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit, Margins
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.orbit.fine_steps import discretized

SECANTS = 12
# Rates of guards are zero to the root of that.
ARRIVED = 1e-4


def place_of(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> float:
    """Where on its leg a limit is met, 0..1.

    z has shape (N + 1,).
    """
    there = discretized(problem, z)
    place = float(there.margins(z).places[there.limits.index(limit)])
    return _turning(there, z, limit, place) if limit.test == "dip" else place


def begun_elsewhere(
    problem: LimitedOrbit, z: np.ndarray, limit: Limit
) -> tuple[LimitedOrbit, np.ndarray, Limit]:
    """The same orbit, beginning elsewhere if it closes up to a symmetry just where the itinerary changes.

    z has shape (N + 1,).

    Raises
    ------
    NoAdjacentOrbit
        If there is no other place where it may begin.
    """
    m, i = problem.layout.legs, limit.leg
    # What is inserted may stand anywhere; what is removed or exchanged must not meet the image. The only
    # event that there is has no other place: `removed` knows it.
    last = max(m - 2, 0)
    lowest, highest = {"duration": (1, m - 2), "rate": (0, last), "end": (0, last)}.get(
        limit.test, (0, m - 1)
    )
    if collapses(problem, limit):
        lowest, highest = 0, m - 1
    if not problem.itinerary.image or lowest <= i <= highest:
        return problem, z, limit
    if lowest > highest:
        raise NoAdjacentOrbit(f"half of the itinerary has {m} events only.")
    place = (lowest + highest + 1) // 2
    there, turned = rotated(problem, z, (i - place) % m)
    return there, turned, replace(limit, leg=place)


def limit_of(problem: LimitedOrbit, point: SpecialPoint) -> tuple[Limit, float]:
    """Which limit a stored point is, and where on its leg, 0..1."""
    z = np.array(point.unknowns)
    there = discretized(problem, z)
    values, k = there.margins(z), locating_limits.nearest(there, point)
    k = arrival(values, k, problem.layout.legs)
    limit, place = values.limits[k], float(values.places[k])
    if not limit.acts:
        raise NoAdjacentOrbit("the event that is met there acts on nothing.")
    return limit, _turning(there, z, limit, place) if limit.test == "dip" else place


def arrival(found: Margins, which: int, legs: int) -> int:
    """The limit that tells what happens at limit number `which`: of a leg that lasts no time the rate of the
    event that leads into it, where that is zero.

    The guard turns there: the leg is a visit that ceases. It is not passed in no time beyond.
    """
    limit, before = found.limits[which], (found.limits[which].leg - 1) % legs
    if limit.test != "duration":
        return which
    shares = found.relative.tolist()
    rates = [k for k, other in enumerate(found.limits) if (other.leg, other.test) == (before, "rate")]
    return next((k for k in rates if abs(shares[k]) < ARRIVED), which)


def _turning(problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float) -> float:
    """Where on its leg a guard turns, by the secant method on its exact rate from nearly there."""
    view, transition = problem.view(z)[limit.leg], limits.transition_of(problem, limit)
    piece, scalars, nodes = view.piece, view.scalars, view.nodes
    watched, values = piece.passage.watched(transition.name, transition.guard), piece.values(scalars)

    def rate(time: float) -> float:
        return float(watched(time, piece.at(nodes, np.array([time]), scalars)[0], values)[1])

    a, b = place, min(place + 1e-4, 1.0)
    fa, fb = rate(a), rate(b)
    for _ in range(SECANTS):
        if fa == fb or abs(b - a) < 1e-15:
            break
        a, fa, b = b, fb, min(max(b - fb * (b - a) / (fb - fa), 0.0), 1.0)
        fb = rate(b)
    return b


def built_at(problem: LimitedOrbit, z: np.ndarray, limit: Limit, place: float) -> AdjacentOrbit:
    """The neighbour at a limit.

    z has shape (N + 1,).

    Raises
    ------
    NoAdjacentOrbit
    """
    transition = limits.transition_of(problem, limit)
    if limit.test == "dip":
        return inserted(problem, z, limit, place, transition)
    if limit.test == "rate":
        return removed(problem, z, limit, transition)
    if limit.test == "past" or collapses(problem, limit):
        return collapsed(problem, z, [limit])
    if limit.test == "duration":
        return gone(problem, z, limit)
    if limit.test == "leaving":
        raise NoAdjacentOrbit(
            f"'{limit.name}' would happen again at once, for ever: the machine rests there."
        )
    if limit.test == "end":
        return with_first(problem, z, limit, transition)
    raise both_at_once(problem, limit)
