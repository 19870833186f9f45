"""Where a branch comes back: to the beginning of its walk, or to the branch that it has left.

It is its parent's again at a branch point, located from a step that went over to the parent. Beside that
point solutions are known to their errors over their distance from it, and shorter steps are no better than
the one that failed. But the point itself is known well: on the way through it a branch is its own mirror
image, and nothing lies beyond.
"""

from __future__ import annotations

from contextlib import suppress
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.continuation import outcomes
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.locating import Disagreement, Found, passes_through, sample_at
from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.numerics.bracketing import zero_of
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Problem, Sample, Test

# What is less asymmetric, in units of a solution's range, may be near its parent.
NEAR = 0.1
# The point lies no farther ahead than so many times the step that went over to the parent.
AHEAD = 2.0
# Its eigenvalues are critical that are this near to it, in stability measure, or so many times what they are
# known to.
CRITICAL, KNOWN = 1e-3, 10.0
# How near a solution is to the beginning, in parts of a step; the same beside a branch point.
CLOSED, BESIDE = 1e-5, 1e-2
# Located branch points are at one value of the parameter, in the metric, if they differ by less.
FOUND_AGAIN = 1e-6
# What tells points at which another branch crosses.
CROSSINGS = (Test.ORIENTATION, Test.TOGETHER)
# Where a segment of a curve in two parameters is asked whether it comes nearer, and how far beside.
PLACES, ASIDE = (0.0, 0.25, 0.5, 0.75, 1.0), 1e-3


def back_at_parent(
    problem: Problem, a: Sample, length: float, settings: Settings, observer: Observer
) -> tuple[Segment, Found] | None:
    """The piece of branch from `a` to where it is its parent's, at most AHEAD steps of a length away.

    None where there is no such point, or where something else may lie before it: a fold, an eigenvalue that
    crosses, a limit, a mark.
    """
    if a.orientation == 0.0:  # a walk that begins at a branch point
        return None
    kind = kind_of_test(problem, Test.ORIENTATION)
    try:
        if not any(apart < NEAR for apart in problem.equivalence.asymmetries(a.z).values()):
            return None
        located = kind.locate(problem, a, 0)
        settled = None if located is None or not _ahead(a, located.z, length) else located.settled()
        if settled is None or not (settled.returned_to_parent and _ahead(a, settled.z, length)):
            return None
        chord = Segment(problem, a, a.varied(z=settled.z))
        there = sample_at(chord, kind, settled, a).varied(unstable=a.unstable)
        segment = Segment(problem, a, there)
        if not _nothing_between(a, there) or marked(segment, settings.sought, observer, [1.0]):
            return None
    except (*outcomes.BREAKDOWNS, LostBranch, Disagreement):
        return None
    return segment, Found(1.0, kind, settled, there, a.unstable, a.unstable, counted=True)


def _ahead(a: Sample, z: np.ndarray, length: float) -> bool:
    """Whether z, shape (N + 1,), lies ahead of a solution, and near."""
    way = z - a.z
    return bool(a.tangent @ (way / a.weights**2) > 0.0) and norm_in(way, a.weights) < AHEAD * length


def _nothing_between(a: Sample, there: Sample) -> bool:
    """Whether as many eigenvalues are unstable at a point as before it, but for the critical one, the
    parameter moves one way, and what is allowed on one side is so on the other.
    """
    if not np.array_equal(a.margins > 0.0, there.margins > 0.0):
        return False
    critical = np.abs(there.measures) <= np.maximum(CRITICAL, KNOWN * there.errors)
    least = int(np.count_nonzero((there.measures > 0.0) & ~critical))
    moves = (there.z[-1] - a.z[-1]) * a.tangent[-1] >= 0.0
    return bool(np.any(critical)) and a.unstable in (least, least + 1) and moves


def place_of_closure(segment: Segment, found: list[Found], origin: Sample) -> float | None:
    """Where an accepted step, with what is special on it, passes a walk's beginning the same way round.

    It is a place on the segment, 0..1, or None where the step does not. What begins at that parameter, within
    errors, has not been away: where it stands still to rounding, as along an explosion, it passes itself.
    """
    if segment.problem.meshed is not None:
        back = _comes_back(segment, origin)
        again = back is None and found and not segment.problem.equivalence.same(origin, segment.a)
        return _finds_again(segment, found, origin) if again else back
    z = segment.problem.equivalence.nearest_turn(origin.z, segment.a.z)
    theta = segment.position(z)
    same_way = origin.tangent / origin.weights**2 @ segment.b.tangent > 0.0
    if not (0.0 < theta <= 1.0 and same_way):
        return None
    try:
        if origin.orientation == 0.0:
            passed = passes_through(segment, z, origin.tangent, theta, BESIDE)
        else:
            passed = segment.distance(z, theta) < CLOSED
    except LostBranch:
        return None
    return float(theta) if passed else None


def _comes_back(segment: Segment, origin: Sample) -> float | None:
    """Where a segment of orbits, which begin anywhere on themselves, passes a given one.

    That is told by the parameter; of curves in two parameters, both of which may turn there, by where these
    and the period come nearest to it.
    """
    plane, value = segment.problem.line.second is not None, origin.parameter
    problem: Any = segment.problem
    way = segment.b.parameter - segment.a.parameter
    if not plane and way * origin.tangent[-1] < 0.0:
        return None

    def apart(theta: float) -> np.ndarray:
        z = segment.guess(theta)
        return np.append(
            (z[-2:] - origin.z[-2:]) / segment.weights[-2:], problem.duration(z) / origin.period - 1.0
        )

    def beyond(theta: float) -> float:
        if not plane:
            return (segment.at(theta).parameter - value) * way
        return float(apart(theta) @ (apart(theta + ASIDE) - apart(theta - ASIDE)))

    rounded = 0.0 if plane else 1e-11 * abs(way) * segment.weights[-1]
    known = [(theta, beyond(theta)) for theta in (PLACES if plane else (0.0, 1.0))]
    with suppress(LostBranch):
        for (low, first), (high, last) in pairwise(known):
            passed = last >= 0.0 and first < -rounded  # met at its end, it is the step's
            theta = (high if last == 0.0 else zero_of(beyond, low, high)) if passed else None
            if theta is not None and problem.equivalence.same(origin, segment.at(theta)):
                return theta
    return None


def _finds_again(segment: Segment, found: list[Found], origin: Sample) -> float | None:
    """The place of a branch point located on the way that is the orbit which the walk began with.

    A branch that leaves a pitchfork has the parameter's extremum there: when it comes back, the parameter
    touches the value that it began with and does not cross it.
    """
    near = FOUND_AGAIN * origin.weights[-1]
    crossings = (f for f in found if f.kind != "unlocated" and f.type.test in CROSSINGS)
    for each in (f for f in crossings if abs(f.sample.parameter - origin.parameter) <= near):
        if (each.located.problem or segment.problem).equivalence.same(origin, each.sample):
            return each.theta
    return None
