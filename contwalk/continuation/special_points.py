"""What is special on a segment but limits: on the whole of it, or up to a limit at which a branch ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.continuation.detection import bifurcations
from contwalk.continuation.kinds import crossed, kind_of_test
from contwalk.continuation.locating import SAME_POINT, Found
from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.zeros_of_test_functions import zeros_of_test_functions
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Problem, Sample, Test

# A mark this near to a bifurcation, in parts of the step, is at the same place.
COINCIDE = 1e-9
# What lies this near before the end of the admissible orbits, in parts of the step, is not told from it.
BEFORE_LIMIT = 1e-4
# The same where equations are singular at the limit, as far as solutions are not to be found nearer.
BEFORE_SINGULAR = (1e-2, 1e-1, 3e-1)
VANISHES = "orbits are not found so near to where a segment between two events vanishes"
CROSSED = "orbits are hardly known so near to where another curve of them crosses"
# What tells points at which the branch itself may turn.
TURNS = (Test.TURN, Test.ORIENTATION, Test.TOGETHER)
# A measure that is critical at both ends of a segment longer than this is so all along.
CRITICAL_ALL_ALONG = 1e-6


def everything(segment: Segment, settings: Settings, observer: Observer, born: bool) -> list[Found]:
    """All that tests tell on a segment, and marks; `born`: the branch leaves another one at its beginning."""
    zeros = zeros_of_test_functions(segment)
    found = [*(f for f in bifurcations(segment) if not _seen_by(f, zeros, segment)), *zeros]
    turns = [*([0.0] if born else []), *(f.theta for f in found if f.type.test in TURNS)]
    for mark in marked(segment, settings.sought, observer, turns):
        at = [f.theta for f in found if f.type.test is not Test.MARK and abs(f.theta - mark.theta) < COINCIDE]
        found.append(replace(mark, theta=at[0]) if at else mark)
    return found


def _seen_by(found: Found, zeros: Sequence[Found], segment: Segment) -> bool:
    """Whether a place where another curve crosses is one that a test function has told as such."""
    if found.type.test is not Test.ORIENTATION:
        return False
    crossings = (zero.located for zero in zeros if zero.located.crossing is not None)
    return any(norm_in(found.located.z - there.z, segment.weights) < SAME_POINT for there in crossings)


def everything_before(
    segment: Segment, end: Found, settings: Settings, observer: Observer, born: bool
) -> tuple[list[Found], Found]:
    """Everything special on a segment that lies before a limit at which the branch ends, and that limit.

    Solutions right beside a leg that vanishes are not to be found, and where another curve crosses they are
    hardly known: there it is looked for a little less far, which the limit is told with.
    """
    crossed, vanishing = end.located.crossing is not None, bool(end.located.vanishing)
    nearer = (*(() if crossed else (BEFORE_LIMIT,)), *(BEFORE_SINGULAR if crossed or vanishing else ()))
    for less in nearer:
        share = end.theta * (1.0 - less)
        if share <= 0.0:
            break
        try:
            part = segment.between(0.0, share)
            found = everything(part, settings, observer, born)
        except LostBranch:
            if less == nearer[-1]:
                raise
            continue
        why = CROSSED if crossed else VANISHES
        note = "" if less == BEFORE_LIMIT else _not_looked_for(segment.problem, part.b, observer, why)
        before = [replace(f, theta=share * f.theta) for f in found if not _is_end(f, end, segment)]
        return before, replace(end, note=note)
    return [], end


def _is_end(found: Found, end: Found, segment: Segment) -> bool:
    """Whether a branch point is one with orbits whose leg, which vanishes there, lasts no time all along."""
    if found.type.test is not Test.ORIENTATION or not end.located.vanishing:
        return False
    return norm_in(found.located.z - end.located.z, segment.weights) < SAME_POINT


def _not_looked_for(problem: Problem, last: Sample, observer: Observer, why: str) -> str:
    """A sentence on what may lie between the last sample that is known and the limit behind it."""
    labels = dict.fromkeys(
        kind.label for kind in problem.point_types if kind.test in (*TURNS, Test.STABILITY)
    )
    place = f"{observer.line.free} = {last.parameter:.10g}"
    return f"{', '.join(labels)} were not looked for between {place} and here: {why}"


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


def at_the_end(segment: Segment) -> list[Found]:
    """A bifurcation that the end of a segment itself is, where a walk stops and cannot look beyond it."""
    b = segment.b
    critical = np.flatnonzero(np.abs(b.measures) <= 10.0 * b.errors)
    if not len(critical):
        return []
    which = int(critical[0])
    a, longer = segment.a, segment.length > CRITICAL_ALL_ALONG
    if longer and which < len(a.measures) and abs(a.measures[which]) <= 10.0 * a.errors[which]:
        return []  # it is critical all along, as where a pair stays on the axis
    if segment.problem.diagnosis.many_branches(b.z):
        kind = kind_of_test(segment.problem, Test.ORIENTATION)
    else:
        kind = crossed(segment.problem, b, which) or kind_of_test(segment.problem, Test.TURN)
    located = kind.locate(segment.problem, b, which)
    settled = located.settled() if located is not None and kind.test is not Test.TURN else None
    if settled is None or np.linalg.norm((settled.z - b.z) / segment.weights) > SAME_POINT:
        return []
    # Beyond the end nothing is computed; the way the eigenvalue moves tells the count there.
    before = segment.a.unstable
    after = before + max(kind.changes) * int(np.nan_to_num(np.sign(b.rates[which])))
    return [Found(1.0, kind, settled, b, before, max(after, 0))]
