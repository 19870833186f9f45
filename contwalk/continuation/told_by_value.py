"""Points that only a function of their own tells: `Test.VALUE`."""

from __future__ import annotations

from contwalk.continuation.kinds import all_told_by
from contwalk.continuation.locating import Disagreement, Found, locate
from contwalk.continuation.segment import Segment
from contwalk.problems.problem import PointType, Test


def told_by_value(segment: Segment) -> list[Found]:
    """The points on a segment at which the function of a kind passes zero, one of each kind.

    Raises
    ------
    Disagreement, LostBranch
        If one passes zero and is not located: then the segment must be shorter.
    """
    kinds = all_told_by(segment.problem, Test.VALUE)
    return [point for kind in kinds if (point := _between(segment, kind)) is not None]


def _between(segment: Segment, kind: PointType) -> Found | None:
    """The point of a kind on a segment. One at its end belongs to it, and not to the next one as well."""

    def value(theta: float) -> float:
        return kind.value(segment.problem, segment.at(theta))

    first, last = value(0.0), value(1.0)
    if not (first * last < 0.0 or (last == 0.0 and first != 0.0)):
        return None
    found = locate(segment, kind, 0.0, 1.0, value, 0, (first, last))
    if found is None:
        raise Disagreement(kind, f"The test function of points {kind.label} passes zero, but none is found.")
    return found
