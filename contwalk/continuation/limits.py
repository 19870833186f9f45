"""Limits on a segment: where an orbit stops being one that the machine can move on.

A problem tells a margin for each of its limits; a sign change brackets the point, and the limit's own
equations locate it. Margins may begin and cease to exist between two solutions (a guard gets another
minimum); such a jump is no passage through zero, and no special point.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from contwalk.continuation.locating import Disagreement, Found, accepted
from contwalk.continuation.rootfinding import narrow
from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Located, Problem

LABELS = ("GR", "OC", "AZ")
# A change of the problem's form without anything special: the branch goes on as another one.
SOFT = "soft"
# A branch that was born at a limit begins with a margin of zero, which is positive; of one that begins next
# to a limit the sign is known.
BORN, ROUNDED = 1e-7, 1e-10
# Margins on both sides of a bracket this narrow that are still this large jump.
NARROW, JUMPS = 1e-6, 1e-4
# Two limits that pass zero at the same place, in parts of the segment, are one if their names agree.
SAME_PLACE = 1e-6


def passed(segment: Segment) -> list[Found]:
    """The limits that pass zero on a segment, in their order.

    Raises
    ------
    Disagreement, LostBranch
        If one is passed and cannot be located.
    """
    problem, a, b = segment.problem, segment.a, segment.b
    found: list[Found] = []
    for which in range(len(a.margins)):
        first, last = float(a.margins[which]), float(b.margins[which])
        if abs(first) <= BORN and last > 0.0:
            continue  # born there, or begun next to it, and gone to the machine's side
        if abs(first) <= ROUNDED:
            first = ROUNDED
        if (first > 0.0) == (last > 0.0):
            continue
        point = _located(segment, which, first, last)
        if point is not None:
            found.append(point)
    kept: list[Found] = []
    for point in sorted(found, key=lambda f: problem.limits[int(f.located.vectors["limit"])].rank):
        if not any(_told(problem, f, point) for f in kept):
            kept.append(point)
    return sorted(kept, key=lambda f: f.theta)


def _told(problem: Problem, one: Found, other: Found) -> bool:
    """Whether two limits at the same place are one: of the same name, or of two events that happen
    at once.
    """
    if abs(one.theta - other.theta) >= SAME_PLACE:
        return False
    a, b = (problem.limits[int(f.located.vectors["limit"])] for f in (one, other))
    return a.name == b.name or a.label == b.label == "OC"


def _located(segment: Segment, which: int, first: float, last: float) -> Found | None:
    label = segment.problem.limits[which].label
    around = {0.0: first, 1.0: last}

    def value(theta: float) -> float:
        around[theta] = float(segment.at(theta).margins[which])
        return around[theta]

    def attempt(theta: float, left: float, right: float) -> Found | None:
        return accepted(segment, label, segment.at(theta), which, left, right)

    found = narrow(value, 0.0, 1.0, first, last, attempt, width=NARROW)
    if found is not None:
        return found
    positions = sorted(around)
    jumps = [
        abs(around[p] - around[q]) > JUMPS
        for p, q in pairwise(positions)
        if (around[p] > 0.0) != (around[q] > 0.0) and q - p < 4.0 * NARROW
    ]
    if any(jumps):
        return None
    raise Disagreement(
        label, f"'{segment.problem.limits[which].name}' passes its limit, but cannot be located."
    )


def policy(problem: Problem, located: Located, events: Mapping[str, str]) -> str:
    """What is to be done at a limit: `stop`, `ignore` or `switch`.

    A watched transition does nothing, so there is nothing to switch to. A terminal grazing cannot be ignored:
    beyond it the orbit's own event happens earlier, and no orbit of this word is the machine's.
    """
    limit = problem.limits[int(located.vectors["limit"])]
    if limit.label == SOFT:
        return "switch"
    asked = events.get(limit.label, "ignore")
    if limit.label == "AZ":
        return asked
    if asked == "switch" and not limit.acts:
        return "ignore"
    if asked == "ignore" and limit.kind == "terminal":
        return "stop"
    return asked


def stopping(problem: Problem, found: list[Found], events: Mapping[str, str]) -> Found | None:
    """The first of the limits passed at which the branch ends."""
    for point in found:
        if policy(problem, point.located, events) != "ignore":
            return point
    return None
