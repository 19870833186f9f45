"""Limits on a segment: where an orbit stops being one that the machine can move on.

A problem tells a margin for each of its limits; a sign change brackets the point, and the limit's own
equations locate it. Margins may begin and cease to exist between two solutions (a guard gets another
minimum); such a jump is no passage through zero, and no special point. One that passes zero and comes back is
least in between.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from contwalk.continuation.indicator import Indicator, between
from contwalk.continuation.locating import WELL_BEYOND, Disagreement, Found, accepted
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.numerics.bracketing import narrow
from contwalk.numerics.linear import EPSILON
from contwalk.problems.problem import Limit, LimitType, Located, Problem, Sample

# A branch that was born at a limit begins with a margin of zero, which is positive; of one that begins next
# to a limit the sign is known.
BORN, ROUNDED = 1e-7, 1e-10
# Across a bracket this narrow a margin that still changes by this part of what it is jumps; so does one that
# changes by this much across the narrowest.
NARROW, JUMPS = 1e-3, 0.05
NARROWEST, JUMPED = 1e-6, 1e-4
# Where on its first segment a branch that begins at a limit is looked at, if that is passed on it.
BESIDE = (0.5, 0.2, 0.05, 0.01)
# Two limits that pass zero at the same place, in parts of the segment, are one if their names agree.
SAME_PLACE = 1e-6
# A margin at a segment's end is too near to zero below this part of what it has changed by on the segment.
IN_DOUBT = 1e-3
# It has gone there steadily, and not jumped, if half way it is this near to the mean.
STEADY = 0.25


class Margin(Indicator):
    """The margin of a limit."""

    def kind(self, sample: Sample) -> LimitType:
        """That of the limit."""
        return limits_of(self.segment.problem)[self.which].type

    def value(self, sample: Sample) -> float:
        """As samples tell it."""
        return float(sample.margins[self.which])

    def error(self, sample: Sample) -> float:
        """In units of what the metric's change it by, what the solutions are known to, and rounding."""
        known = max(self.segment.error, sample.error) if sample.error > 0.0 else self.segment.error
        return known + EPSILON * self.segment.size

    def rate(self, sample: Sample) -> float:
        """By a place ahead; NaN where it has no value there.

        So far off an extremum, which is a square, it is what it is there to a hundredth of its error.
        """
        limited, aside = self.segment.problem.limited, 0.1 * np.sqrt(self.error(sample))
        assert limited is not None
        ahead = limited.margins(sample.z + aside * sample.tangent, sample.weights)
        return float(ahead[self.which] - sample.margins[self.which]) / aside

    def crossing(self, low: float, high: float) -> Found | None:
        """The limit there."""
        first, last = (self.value(self.segment.at(theta)) for theta in (low, high))
        return _located(self.segment, self.which, first, last, [], low, high)


def passed(segment: Segment, begins: bool) -> list[Found]:
    """The limits that pass zero on a segment, in their order; `begins`: the walk starts there.

    Raises
    ------
    Disagreement, LostBranch
        If one is passed and cannot be located.
    """
    limited, a, b = segment.problem.limited, segment.a, segment.b
    if limited is None:
        return []
    found: list[Found] = []
    lost: dict[int, LostBranch | Disagreement] = {}
    turning, hidden = _turning(segment, BORN if begins else ROUNDED)
    changed = {*_changed(a.margins, b.margins, begins), *(k for k, turns in turning.items() if turns)}
    for which in sorted(changed, key=lambda k: limited.limits[k].rank):
        knots = _knots(segment, which, begins, turning.get(which, []))
        for (low, first), (high, last) in pairwise(knots):
            if (first > 0.0) == (last > 0.0):
                continue
            try:
                point = _located(segment, which, first, last, found, low, high)
            except (LostBranch, Disagreement) as error:
                lost[which] = error
                continue
            if point is not None and not any(point is known for known in found):
                # What its equations have found it to be may be another limit than the one that led to it.
                own = point.located.among(limited.limits).type
                found.append(replace(point, type=own, entered=own.entered and first < 0.0 < last))
    for which, reason in lost.items():  # told by the leg that vanishes where they pass zero
        if not any(which in point.located.vanishing for point in found):
            raise reason
    # Beside one that is located, within errors of the solutions there, it is that one.
    places, apart = np.array([f.theta for f in found]), WELL_BEYOND / segment.length
    alone = [d for d in hidden if np.all(np.abs(places - d.theta) > apart * d.sample.error)]
    return sorted([*found, *alone], key=lambda f: f.theta)


def _turning(segment: Segment, least: float) -> tuple[dict[int, list[float]], list[Found]]:
    """Margins with one sign at both ends that have the other one at a place between, and these places.

    With them what is told of those that come as near to zero as they are known.

    One that is at zero at an end, by as much as `least`, is passed there, or leaves it. One that is larger
    than the step is long would have to change faster than anything that is watched, and one that is as large
    as they are told has no instant there.
    """
    a, b = segment.a.margins, segment.b.margins
    places: dict[int, list[float]] = {}
    hidden: list[Found] = []
    if len(a) != len(b):
        return places, hidden
    with np.errstate(invalid="ignore"):
        nearer = np.minimum(np.abs(a), np.abs(b))
        near = (a * b > 0.0) & (nearer < segment.length) & (nearer > least)
        near = np.flatnonzero(near & (np.maximum(np.abs(a), np.abs(b)) < 1.0))
    for which in near.tolist():
        own = Margin(segment, which)
        points, places[which] = between(own)
        for inside, point in enumerate(points, start=int(a[which] < 0.0)):
            comes_back = inside % 2 == 1 and own.kind(point.sample).entered
            located = replace(point.located, limit=which)
            entered = comes_back or point.kind == "unlocated"
            hidden.append(replace(point, located=located, counted=False, entered=entered))
    return places, hidden


def _knots(segment: Segment, which: int, begins: bool, turns: list[float]) -> list[tuple[float, float]]:
    """Places on a segment, and a margin at them, between which it passes zero once or not at all."""
    first, last = float(segment.a.margins[which]), float(segment.b.margins[which])
    if abs(first) <= (BORN if begins else ROUNDED) and last > 0.0:
        return []  # born there, or begun next to it, and gone to the machine's side
    # A solution that is a limit itself, to rounding, is on the machine's side: of two steps that meet
    # there one passes it.
    first, last = (ROUNDED if abs(margin) <= ROUNDED else margin for margin in (first, last))
    low = 0.0
    if begins and abs(first) <= BORN:  # it starts at the limit, which is passed at once, or again later
        low, first = _beside(segment, which) if last < 0.0 else (0.0, ROUNDED)
    beyond = [(turn, float(segment.at(turn).margins[which])) for turn in turns if turn > low]
    return [(low, first), *beyond, (1.0, last)]


def _changed(a: np.ndarray, b: np.ndarray, begins: bool) -> list[int]:
    """Those that may be passed: of different signs; all of them where the walk begins. One without a value on
    either side passes nothing that could be located: it is told as such.
    """
    known = ~(np.isnan(a) | np.isnan(b))
    if begins:
        return np.flatnonzero(known).tolist()
    positive = [(margins > 0.0) | (np.abs(margins) <= ROUNDED) for margins in (a, b)]
    return np.flatnonzero(known & (positive[0] != positive[1])).tolist()


def _beside(segment: Segment, which: int) -> tuple[float, float]:
    """Where on a segment that begins at a limit its margin is positive, and how large; else the start."""
    for theta in BESIDE:
        margin = float(segment.at(theta).margins[which])
        if margin > ROUNDED:
            return theta, margin
    return 0.0, ROUNDED


def in_doubt(segment: Segment) -> bool:
    """Whether the end of a segment is so near to a limit that it is not sure on which side.

    The next segment sees the same solution on other steps, and may see it on the other side: the limit would
    be told twice, or never. A margin that has jumped to nearly zero passes nothing.
    """
    a, b = segment.a.margins, segment.b.margins
    with np.errstate(invalid="ignore"):
        change = b - a
        near = np.flatnonzero(np.abs(b) < IN_DOUBT * np.abs(change))
    if not len(near):
        return False
    middle = segment.at(0.5).margins
    with np.errstate(invalid="ignore"):
        return bool(np.any(np.abs(middle - a - 0.5 * change)[near] < STEADY * np.abs(change[near])))


def _alike(a: Limit, b: Limit) -> bool:
    """Whether two limits are one where they coincide: of the same name, or of two events that happen at
    once.
    """
    return a.name == b.name or (a.type is b.type and a.type.shared)


def _located(
    segment: Segment,
    which: int,
    first: float,
    last: float,
    earlier: Sequence[Found],
    low: float = 0.0,
    high: float = 1.0,
) -> Found | None:
    """The limit between two margins, at `low` and at `high`, or which of the earlier ones it is.

    None where there is none.
    """
    limits = limits_of(segment.problem)
    kind = limits[which].type
    around = {low: first, high: last}

    def value(theta: float) -> float:
        around[theta] = float(segment.at(theta).margins[which])
        return around[theta]

    def known(located: Located, theta: float) -> Found | None:
        same = [f for f in earlier if abs(f.theta - theta) < SAME_PLACE]
        alike = (
            f for f in same if which in f.located.vanishing or _alike(f.located.among(limits), limits[which])
        )
        return next(alike, None)

    tried = np.inf  # width of the bracket when the equations were last tried, in vain

    def attempt(theta: float, left: float, right: float) -> Found | Literal["jumps"] | None:
        nonlocal tried
        # Beyond one, there is no such instant, or it is far from the limit.
        if abs(around[theta]) < 1.0 and right - left < 0.2 * tried:
            tried = right - left
            found = accepted(segment, kind, segment.at(theta), which, left, right, known)
            if found is not None:
                return found
        change = abs(around[left] - around[right])
        # One that is rounded has no sign: to another one within that it is no jump.
        jumps = right - left < NARROW and change > max(JUMPS * max(abs(first), abs(last)), 2.0 * ROUNDED)
        return "jumps" if jumps else None

    if max(abs(first), abs(last)) < 1.0:
        # Most margins are nearly straight between two solutions: where that puts the limit is near enough for
        # its own equations, without a solution there.
        theta = low + (high - low) * first / (first - last)
        nearer = segment.a if theta < 0.5 else segment.b
        guess = replace(nearer, z=segment.guess(theta))
        found = accepted(segment, kind, guess, which, low, high, known)
        if found is not None:
            return found
    met = narrow(value, low, high, first, last, attempt, width=NARROWEST)
    if met == "jumps" or (met is None and _jumped(around)):
        return None
    if met is not None:
        return met
    raise Disagreement(kind, f"'{limits[which].name}' passes its limit, but cannot be located.")


def _jumped(around: Mapping[float, float]) -> bool:
    """Whether a margin, known at some places of a segment, passes zero between two that are next to one."""
    near = [(around[p], around[q]) for p, q in pairwise(sorted(around)) if q - p < 4.0 * NARROWEST]
    return any((a > 0.0) != (b > 0.0) and abs(a - b) > JUMPED for a, b in near)


def limits_of(problem: Problem) -> Sequence[Limit]:
    """The limits of a problem; none where it has none."""
    return () if problem.limited is None else problem.limited.limits


def policy(problem: Problem, found: Found, events: Mapping[str, str]) -> str:
    """What is to be done at a limit: `stop`, `ignore` or `switch`.

    A watched transition does nothing, so there is nothing to switch to. A terminal grazing cannot be ignored:
    beyond it the orbit's own event happens earlier, and no orbit of this itinerary is the machine's.
    """
    if found.entered:
        return "ignore"
    limit = found.located.among(limits_of(problem))
    asked = events.get(limit.type.like or limit.type.label, "ignore")
    if limit.type.declared:
        return asked
    if asked == "switch" and not limit.acts:
        return "ignore"
    return "stop" if asked == "ignore" and final(limit, found.located) else asked


def final(limit: Limit, located: Located) -> bool:
    """Whether no solution beyond a limit is the machine's: the orbit's own event would happen earlier.

    Where it has become one with what touches, another curve of such orbits crosses.
    """
    return limit.kind == "terminal" or located.crossing is not None


def stopping(problem: Problem, found: list[Found], events: Mapping[str, str]) -> Found | None:
    """The first of the limits passed at which the branch ends; of those at one place that of lowest rank."""
    ends = [point for point in found if policy(problem, point, events) != "ignore"]
    if not ends:
        return None
    first = min(point.theta for point in ends)
    together = [point for point in ends if point.theta <= first + SAME_PLACE]
    return min(together, key=lambda point: point.located.among(limits_of(problem)).rank)


def up_to(problem: Problem, found: list[Found], end: Found, events: Mapping[str, str]) -> list[Found]:
    """The limits passed before the one at which the branch ends, or with it, and that one.

    Where a leg vanishes a watched guard may be at its limit as well: on which side of the end it is found is
    rounding, and it is told there.
    """
    ignored = [p for p in found if policy(problem, p, events) == "ignore"]
    before = [p for p in ignored if p.theta <= end.theta + SAME_PLACE]
    return [*(replace(p, theta=min(p.theta, end.theta)) for p in before), end]
