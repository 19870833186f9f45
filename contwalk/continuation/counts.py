"""Unstable counts on both sides of points that do not tell them themselves."""

from __future__ import annotations

from dataclasses import replace

from contwalk.continuation.locating import Found
from contwalk.problems.problem import Test


def with_counts(found: list[Found], count: int) -> list[Found]:
    """Marks take their unstable counts from the bifurcations before them, or at the same place.

    A solution that is a limit itself may have multipliers of the orbits beyond, as where a leg that sticks
    lasts no time: it is counted as the side that is followed.
    """
    result = []
    for point in found:
        uncounted = point.type.test in (Test.MARK, Test.MARGIN, Test.VALUE)
        if point.type.test is Test.MARGIN and point.kind != "unlocated":
            point = _counted_as_followed(point, count)
        result.append(replace(point, before=count, after=count) if uncounted else point)
        count = result[-1].after
    return result


def _counted_as_followed(limit: Found, count: int) -> Found:
    """A limit whose solution is counted as those before it; told where its own multipliers are others."""
    sample = limit.sample.counted(count)
    if sample is limit.sample:
        return limit
    own = f"unstable at the point itself are {limit.sample.unstable}, on the branch before it {count}"
    note = "; ".join(each for each in (limit.note, f"{own}, which are counted") if each)
    return replace(limit, sample=sample, note=note)
