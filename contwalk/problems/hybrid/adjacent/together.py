"""Limits that are met at once, as by an orbit that is its own image, and the orbit beyond all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems.hybrid.adjacent.at_limit import ARRIVED, built_at, place_of
from contwalk.problems.hybrid.adjacent.collapse import collapsed, collapses
from contwalk.problems.hybrid.adjacent.orbit import AdjacentOrbit, NoAdjacentOrbit, state_on_leg
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit.fine_steps import discretized

# Legs begin or cease to last together where their margins are this small.
TOGETHER = 1e-8
# Guards are touched together whose margins are this small, in an orbit that nobody has declared to be its own
# image: one of them is located, the others as well as the orbit is symmetric.
TOUCHES, TOUCHED = ("dip", "rate"), 1e-6
# States so far apart, in the variation of an orbit, are not the same touch.
SAME_TOUCH = 1e-2


def met_together(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> list[Limit]:
    """The other limits of the kind of one that are met where it is.

    z has shape (N + 1,).
    """
    if limit.test not in TOUCHES:
        return _collapsing(problem, z, limit)
    found = discretized(problem, z).margins(z)
    return [
        other
        for other, share in zip(found.limits, found.relative.tolist(), strict=True)
        if other.test == limit.test and other.acts and (other.leg, other.name) != (limit.leg, limit.name)
        if abs(share) < (TOUCHED if limit.test == "dip" else ARRIVED)
    ]


def built_beyond(
    problem: LimitedOrbit, z: np.ndarray, changing: Sequence[Limit], place: float
) -> AdjacentOrbit:
    """The neighbour beyond all of some limits; `place` is that of the first on its leg, where it turns.

    z has shape (N + 1,).

    Raises
    ------
    NoAdjacentOrbit
    """
    first, *others = changing
    if others and first.test not in TOUCHES:
        return collapsed(problem, z, changing)
    scale = discretized(problem, z).mesh.variation
    touched = [_touched(problem, z, other, scale) for other in others]
    neighbour = built_at(problem, z, first, place)
    for other, state in zip(others, touched, strict=True):
        there, unknowns = neighbour.problem, neighbour.z
        again = [o for o in there.limits if (o.test, o.name) == (other.test, other.name)]
        apart = [float(np.linalg.norm(_touched(there, unknowns, o, scale) - state)) for o in again]
        apart = [each if np.isfinite(each) else np.inf for each in apart]
        if not apart or not min(apart) < SAME_TOUCH:
            if other.test == "rate":
                continue  # it has gone with the first: a mode is not visited any more
            raise NoAdjacentOrbit(
                f"'{first.name}' and '{other.name}' are met at once, and cannot both be passed."
            )
        nearest = again[int(np.argmin(apart))]
        neighbour = built_at(there, unknowns, nearest, place_of(there, unknowns, nearest))
    return neighbour


def _touched(problem: LimitedOrbit, z: np.ndarray, limit: Limit, scale: np.ndarray) -> np.ndarray:
    """Where a guard is touched, or arrives; NaN where it does not turn.

    The phase of the force, as a place on a circle, and the full state in units of `scale`.
    """
    there = discretized(problem, z)
    share = 1.0 if limit.test == "rate" else float(there.margins(z).places[there.limits.index(limit)])
    if not np.isfinite(share):
        return np.full(2 + len(scale), np.nan)
    instant = there.starting_times(z)[limit.leg] + share * z[there.layout.durations][limit.leg]
    phase = 2.0 * np.pi * instant / (there.rounds * there.duration(z)) if there.forced else 0.0
    state = state_on_leg(there, z, limit.leg, share) / scale
    return np.array([np.cos(phase), np.sin(phase), *state])


def _collapsing(problem: LimitedOrbit, z: np.ndarray, limit: Limit) -> list[Limit]:
    """The other legs that begin or cease to last where one does: those of its image, of a symmetric orbit."""
    if not collapses(problem, limit) and limit.test != "past":
        return []
    found = discretized(problem, z).margins(z)
    return [
        other
        for other, share in zip(found.limits, found.relative.tolist(), strict=True)
        if other.leg != limit.leg
        and abs(share) < TOGETHER
        and (other.test == "past" or collapses(problem, other))
    ]
