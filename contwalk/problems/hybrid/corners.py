"""Guards of other events that come to zero at a corner: the event begins to happen there, or ceases to.

A limit is located where a guard is zero and its rate is too. At the corner of a triangular ramp, or of a
least of two distances, no rate is zero.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.problems.hybrid.end_maps import passages_of
from contwalk.problems.hybrid.jumping_limits import (
    AROUND_END,
    ROUNDED,
    alike,
    beside,
    course_of,
    pieced_guards,
)
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.kink import JumpThroughZero, Met
from contwalk.problems.kinks import Course, differ, jumping, located
from contwalk.system import Transition

# How far beside a corner it is seen which way it points, in units of the leg's duration.
BESIDE = 1e-4

# Two instants of a leg.
Instants = tuple[float, float]


def passed(problem: LimitedOrbit, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """The corners that have come past zero on the way from one orbit to another.

    a and b have the shape (N + 1,).
    """
    if not any(told.acts for passage in passages_of(problem, a) for _, told in pieced_guards(passage)):
        return ()
    try:
        pairs = alike(problem.view(a), problem.view(b))
        found = tuple(met for pair in pairs for met in _on_leg(problem, *pair, a, b))
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return ()
    # Where the first one is not the machine's either, the event has happened before.
    return found if found and problem.admissible_at(a) else ()


def _on_leg(
    problem: LimitedOrbit, one: GuardedView, other: GuardedView, a: np.ndarray, b: np.ndarray
) -> Iterator[Met]:
    passage = one.piece.passage
    if passage.leg.collapsed or not min(one.duration, other.duration) > 0.0:
        return
    for own, told in pieced_guards(passage):
        if not told.acts:
            continue
        before, later = course_of(problem, one, told, a), course_of(problem, other, told, b)
        closes = passage.leg.transition is None
        least, _ = _furthest(own, before, closes=closes)
        most, place = _furthest(own, later, closes=closes)
        zero = ROUNDED * float(later.level[0])
        if place is not None and least <= zero < most:
            states = later.at(np.minimum(place, 1.0))
            where = later.where((place[0], states[0]), (place[1], states[1]))
            share = float(np.clip(least / (least - most), 0.0, 1.0)) if np.isfinite(least) else 1.0
            yield Met(JumpThroughZero(1, where, told.name), share)


def _furthest(own: Transition, course: Course, *, closes: bool) -> tuple[float, Instants | None]:
    """How far past zero a guard is, at most, at a corner that points there, and the instants beside that.

    A leg that closes the orbit without an event goes on where it has begun.
    """
    sides = course.sides(course.times, course.states)
    changes = np.flatnonzero(np.any(differ(sides[:-1], sides[1:]), axis=1)).tolist()
    places = [located(course, k) for k in changes]
    places = [(low, high) for low, high in places if low > BESIDE and high < 1.0 - BESIDE]
    found = [(low, high, np.array([low - BESIDE, low, high, high + BESIDE])) for low, high in places]
    if closes and jumping(np.array(beside(course, *AROUND_END)), course.level) != 0:
        found.append((*AROUND_END, np.array([1.0 - BESIDE, 1.0, 0.0, BESIDE])))
    furthest: tuple[float, Instants | None] = -np.inf, None
    for low, high, times in found:
        order = np.argsort(times)
        values = np.empty(4)
        states = course.at(times[order])
        values[order] = course.switching.values(course.evaluate(times[order], states))[:, 0]
        way = {"rising": 1.0, "falling": -1.0}.get(own.direction, -float(np.sign(values[0])))
        past = way * values
        if max(past[0], past[3]) < min(past[1], past[2]) and past[1] > furthest[0]:
            furthest = float(past[1]), (low, high)
    return furthest
