"""Points that only a test function of their own tells: `Test.VALUE`."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from contwalk.continuation import control
from contwalk.continuation.kinds import kinds_of_test
from contwalk.continuation.locating import Disagreement, Found, accepted, locate
from contwalk.continuation.segment import Segment
from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.passing_zero import extremum, is_pole, may_pass, nearest_to_zero
from contwalk.problems.problem import PointType, Test

# Where a function is looked at on a segment: more than its ends, so that zeros that come in pairs show.
PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
# Where one that is dear is looked at first: where it stays far from zero there, it is not asked again.
FEWER = (0.0, 0.5, 1.0)
# Degrees by which no branch turns within a step.
LEADS_AWAY = 60.0


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
    for places in nearest_to_zero(known):
        place, least = extremum(value, places, known[places[1]])
        known[place] = least
    points = []
    for (low, first), (high, last) in pairwise(sorted(known.items())):
        if not (first * last < 0.0 or (last == 0.0 and abs(first) > 0.0)):
            continue
        try:
            if last != 0.0 and is_pole(value, (low, high), (first, last)):
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
        if not may_pass({theta: known[theta] for theta in places}):
            return False
    return True
