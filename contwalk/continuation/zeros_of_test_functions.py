"""Points that only a test function of their own tells: `Test.VALUE`."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from contwalk.continuation import control
from contwalk.continuation.kinds import kinds_of_test
from contwalk.continuation.locating import Disagreement, Found, accepted, locate
from contwalk.continuation.segment import Segment
from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.bracketing import UNSURE
from contwalk.problems.problem import PointType, Test

# Where a function is looked at on a segment: more than its ends, so that zeros that come in pairs show.
PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
# Where one that is dear is looked at first: where it stays far from zero there, it is not asked again.
FEWER = (0.0, 0.5, 1.0)
# An extremum between them is looked for this often, each time in two thirds of where it lies.
NARROWER = 12
# An extremum is looked for where it may come this near to zero, against the values beside it.
NEAR_ZERO = 0.1
# The same where values are those beside solutions.
DOUBTFUL = 0.3
# A bracket of a change of sign is narrowed until both values are so many times the first ones, as at a pole,
# or one is below this part of the first one of its side; at the most so often, each time to such parts:
# halves would meet a pole in the middle, where there is no value.
NARROWINGS, GROWN, SHRUNK = 30, 100.0, 0.5
# Degrees by which no branch turns within a step.
LEADS_AWAY = 60.0
SHARES = (0.47, 0.55)


def zeros_of_test_functions(segment: Segment) -> list[Found]:
    """The points on a segment at which the function of a kind passes zero.

    Raises
    ------
    Disagreement, LostBranch
        If one passes zero and is not located: then the segment must be shorter.
    """
    return [point for kind in kinds_of_test(segment.problem, Test.VALUE) for point in _of_kind(segment, kind)]


def _of_kind(segment: Segment, kind: PointType) -> list[Found]:
    """The points of a kind on a segment. One at its end belongs to it, and not to the next one as well."""

    def value(theta: float) -> float:
        return kind.value(segment.problem, segment.at(theta))

    if kind.of_place and not _may_pass(segment, kind):
        return []
    known = {theta: value(theta) for theta in PLACES}
    for theta in _nearest_to_zero(known):
        extremum, least = _extremum(value, known, theta)
        known[extremum] = least
    points = []
    for (low, first), (high, last) in pairwise(sorted(known.items())):
        if not (first * last < 0.0 or (last == 0.0 and abs(first) > 0.0)):
            continue
        try:
            if last != 0.0 and _is_pole(value, (low, high), (first, last)):
                continue
            found = locate(segment, kind, low, high, value, 0, (first, last))
        except NotFinite:  # right at such a point there may be no solution to begin at: then beside it
            found = accepted(segment, kind, segment.at(low), 0, low, high)
        # What is larger there than beside it is no zero, but a place at which a pole was taken for one.
        if found is None or abs(kind.value(segment.problem, found.sample)) > max(abs(first), abs(last)):
            raise Disagreement(
                kind, f"The test function of points {kind.label} passes zero, but none is found."
            )
        if not _where_curves_cross(segment, found):
            points.append(found)
    return points


def _where_curves_cross(segment: Segment, found: Found) -> bool:
    """Whether the branch's own equations are singular at a point that tells nothing of that, or beside it.

    A test function may vanish there with all else that it is made of: what it would tell has no meaning.
    Right beside it what is found is a solution on the other curve, and leads away along that.
    """
    if not found.type.of_regular:
        return False
    away = control.turn(segment.a, found.sample.tangent)
    return away > LEADS_AWAY or segment.problem.diagnosis.many_branches(found.located.z)


def _is_pole(
    value: Callable[[float], float], places: tuple[float, float], values: tuple[float, float]
) -> bool:
    """Whether a function changes its sign between two places because it has a pole there.

    The nearer to a pole, the larger it is; the nearer to a zero, the smaller.
    """
    (low, high), beside = places, list(values)
    for _ in range(NARROWINGS):
        if min(map(abs, beside)) > GROWN * max(map(abs, values)):
            return True
        tried = ((middle, value(middle)) for middle in (low + share * (high - low) for share in SHARES))
        middle, inside = next(((m, v) for m, v in tried if np.isfinite(v)), (low, float("nan")))
        side = 0 if inside * beside[0] > 0.0 else 1
        if not abs(inside) > SHRUNK * abs(values[side]):
            return False
        beside[side] = inside
        low, high = (middle, high) if side == 0 else (low, middle)
    return False


def _may_pass(segment: Segment, kind: PointType) -> bool:
    """Whether a function of places may pass zero on a segment.

    It is asked of the arc between both ends: that is many times nearer to the solutions than the function's
    course tells, and costs no solution.
    """
    known: dict[float, float] = {}
    for places in (FEWER, PLACES) if kind.dear else (PLACES,):
        try:
            known |= {t: kind.value(segment.problem, segment.nearly(t)) for t in places if t not in known}
        except (NotFinite, PluginError, np.linalg.LinAlgError):  # the solutions tell more
            return True
        if not _doubtful({theta: known[theta] for theta in places}):
            return False
    return True


def _doubtful(known: dict[float, float]) -> bool:
    """Whether values at some places leave room for a zero between them."""
    values = list(known.values())
    alike = not np.any(np.isfinite(values)) or all(_alike(a, b) for a, b in pairwise(values))
    return not alike or bool(_nearest_to_zero(known, DOUBTFUL))


def _alike(a: float, b: float) -> bool:
    """Whether two values leave no room for a zero between them: of one sign, or both smaller than errors."""
    return a * b > 0.0 or max(abs(a), abs(b)) <= UNSURE


def _nearest_to_zero(known: dict[float, float], near: float = NEAR_ZERO) -> list[float]:
    """Places beside which a function may pass zero twice: the parabola through three values comes near it."""
    places = list(known)
    triples = zip(places, places[1:], places[2:], strict=False)
    return [middle for low, middle, high in triples if _reaches(known[low], known[middle], known[high], near)]


def _reaches(low: float, middle: float, high: float, near: float) -> bool:
    """Whether the parabola through three values of one sign has its extremum between them, near zero."""
    if not (low * middle > 0.0 and middle * high > 0.0):
        return False
    low, middle, high = abs(low), abs(middle), abs(high)
    slope, bend = 0.5 * (high - low), high - 2.0 * middle + low
    if not abs(slope) < bend:
        return False
    return middle - 0.5 * slope**2 / bend < near * min(low, high)


def _extremum(
    value: Callable[[float], float], known: dict[float, float], theta: float
) -> tuple[float, float]:
    """Where a function comes nearest to zero beside a place, or beyond zero, and what it is there."""
    place = PLACES.index(theta)
    low, high, sign = PLACES[place - 1], PLACES[place + 1], 1.0 if known[theta] > 0.0 else -1.0
    best = theta, known[theta]
    for _ in range(NARROWER):
        thirds = [low + (high - low) / 3.0, high - (high - low) / 3.0]
        left, right = ((third, value(third)) for third in thirds)
        nearer = min(left, right, key=lambda found: sign * found[1])
        if sign * nearer[1] < sign * best[1]:
            best = nearer
        if not sign * nearer[1] > 0.0:
            break
        low, high = (low, thirds[1]) if nearer is left else (thirds[0], high)
    return best
