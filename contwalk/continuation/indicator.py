"""Numbers that are zero at a kind of point, and two zeros of one of them within a step.

Between two solutions at which it has one sign, an indicator may come to zero and turn back. Values and rates
at both say whether it may; then the extremum is bracketed by rates. Where it is beyond zero there by more
than it is known to, there are two points. Where errors hide that, it is decided on the finest steps, or by
more digits: about its extremum an indicator is a parabola, so where it has a level l the branch is w away on
both sides, with w^2 proportional to l - l0. Places at levels that are known from zero, solved for in extended
precision, tell what w^2 is at zero: it is negative where the indicator turns back before.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import replace
from itertools import takewhile
from typing import ClassVar, Self

import numpy as np

from contwalk.continuation.locating import (
    KNOWN,
    NEIGHBOURHOOD,
    Disagreement,
    Found,
    Subsegment,
    accepted,
    around,
    on_finest_steps,
    unlocated,
)
from contwalk.continuation.segment import Placed, Segment
from contwalk.numerics import cubic
from contwalk.numerics.bracketing import narrow
from contwalk.numerics.linear import EPSILON, norm_in
from contwalk.problems.problem import Located, PointType, Sample

# Nearer to zero than this, against the ends, an extremum is looked at on the finest steps.
CLOSE = 1e-4
# What is left of the error of the steps on finer ones: a hundredth of the tolerance leaves less.
FINER = 0.05
# Levels, in units of what an indicator is known to: each is four times the last one, and as far again from
# the extremum.
LEVELS = (16.0, 64.0, 256.0)
DOUBTFUL = (
    "What is critical is reached, and left again to the same side, within what is known of it: whether it is "
    "passed twice is not known. If it is, that is between {:.17g} and {:.17g}."
)


class Indicator(ABC):
    """A number along a segment that is zero at a kind of point, what it is known to, and its rate.

    Parameters
    ----------
    segment : Segment
    which : int
        Its number among those of its class.

    Attributes
    ----------
    corner : bool
        Whether it may have a corner.
    """

    corner: ClassVar[bool] = False

    def __init__(self, segment: Segment, which: int = 0) -> None:
        self.segment, self.which = segment, which

    def on(self, segment: Segment) -> Self:
        """The same number along another segment."""
        return type(self)(segment, self.which)

    @abstractmethod
    def kind(self, sample: Sample) -> PointType:
        """What kind of point a solution is at which it is zero."""

    @abstractmethod
    def value(self, sample: Sample) -> float:
        """What it is at a solution."""

    @abstractmethod
    def error(self, sample: Sample) -> float:
        """What it is known to."""

    @abstractmethod
    def rate(self, sample: Sample) -> float:
        """Its derivative by arclength; NaN where none is known. It may have its price."""

    def crossing(self, low: float, high: float) -> Found | None:
        """The point between two positions at which it has opposite signs."""
        at = self.segment.at
        values = self.value(at(low)), self.value(at(high))
        attempt = lambda theta, *bracket: self.located(at(theta), *bracket)  # noqa: E731
        return narrow(lambda theta: self.value(at(theta)), low, high, *values, attempt)

    def located(self, near: Sample, low: float, high: float) -> Found | None:
        """The point between two positions near a sample."""
        return accepted(self.segment, self.kind(near), near, self.which, low, high)

    def at_level(self, sample: Sample, level: float) -> Located | None:
        """The solution near a sample at which it is `level`."""
        return self.kind(sample).at_level(self.segment.problem, sample, self.which, level)

    def doubt(self, sample: Sample) -> float:
        """What it may be off by on steps that are not the finest."""
        return self.error(sample)

    def flat(self, sample: Sample) -> bool:
        """Whether it stays at zero beside a solution: then it tells nothing there."""
        return False

    def beyond(self) -> int:
        """How many eigenvalues are unstable between two crossings."""
        return self.segment.a.unstable

    def known(self, sample: Sample) -> bool:
        """Whether it is known from zero."""
        return abs(self.value(sample)) > self.error(sample)


def extremum(own: Indicator, low: Placed, high: Placed) -> tuple[float, bool] | None:
    """Where between two solutions an indicator comes nearest to zero, and whether it is beyond by then.

    None where it does not come near zero, as its values and rates at both say.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    first, last = own.value(low[1]), own.value(high[1])
    sign, rates = 1.0 if first > 0.0 else -1.0, dict[float, float]()
    # An extremum lies between where it goes towards zero at one end and away from it at the other. A rate has
    # a price, so the end is asked first at which it is less likely.
    asked = ((low, -1.0), (high, 1.0)) if abs(first) <= abs(last) else ((high, 1.0), (low, -1.0))
    for (theta, sample), way in asked:
        rates[theta] = sign * own.rate(sample)
        if not rates[theta] * way > 0.0:
            return None
    place, least, passes = None, np.inf, False

    def dip(left: float, right: float) -> float | None:
        """Where in a bracket it may be near zero."""
        across = (right - left) * own.segment.length
        values = [sign * own.value(own.segment.at(theta)) for theta in (left, right)]
        if not min(values) > 0.0:
            return left
        return cubic.dip(values, [across * rates[theta] for theta in (left, right)], own.corner)

    def rate(theta: float) -> float:
        rates[theta] = float(np.nan_to_num(sign * own.rate(own.segment.at(theta)), posinf=0.0, neginf=0.0))
        return rates[theta]

    def attempt(theta: float, left: float, right: float) -> float | None:
        nonlocal place, least, passes
        sample = own.segment.at(theta)
        value = sign * own.value(sample)
        if value < least:
            place, least = theta, value
        passes = passes or value < -own.error(sample)
        return theta if passes or dip(left, right) is None else None

    if dip(low[0], high[0]) is None:
        return None
    narrow(rate, low[0], high[0], rates[low[0]], rates[high[0]], attempt, width=np.sqrt(EPSILON))
    return None if place is None else (place, passes)


def between(own: Indicator) -> tuple[list[Found], list[float]]:
    """What errors hide of an extremum on a segment, at whose ends it has one sign; where it is beyond zero.

    Raises
    ------
    Disagreement, LostBranch
    """
    found = extremum(own, (0.0, own.segment.a), (1.0, own.segment.b))
    points = None if found is None else decided(own, found[0])
    return points or [], [found[0]] if found is not None and points is None and found[1] else []


def decided(own: Indicator, theta: float) -> list[Found] | None:
    """Of an extremum that errors may hide both crossings, none, or one point for both.

    None where it is not that near to zero.

    Raises
    ------
    Disagreement, LostBranch
    """
    sample = own.segment.at(theta)
    if own.segment.problem.meshed is not None:
        return _on_finest_steps(own, theta)
    near = abs(own.value(sample)) <= KNOWN * own.error(sample)
    return _by_digits(own, theta) if near and not own.flat(own.segment.a) else None


def _on_finest_steps(own: Indicator, theta: float) -> list[Found] | None:
    """What an extremum is on the finest steps."""
    segment, sample = own.segment, own.segment.at(theta)
    ends = max(abs(own.value(end)) for end in (segment.a, segment.b))
    # Of a solution that is off it is off by what it changes by over that length of the branch.
    off = own.doubt(sample) + min(sample.error / segment.length, 1.0) * ends
    if abs(own.value(sample)) > max(CLOSE * ends, off):
        return None
    way, outside = np.sign(own.value(segment.a)), -np.inf
    for aside in NEIGHBOURHOOD * 4.0 ** np.arange(4):  # up to where it is known to be outside on these
        finer = on_finest_steps(segment, sample, own.kind(sample), around(theta, aside))
        if finer is None:
            return None
        fine, part = own.on(finer.part), finer.part
        outside = min(way * fine.value(end) for end in (part.a, part.b))
        if outside > FINER * abs(own.value(sample)) or (outside >= 0.0 and own.flat(part.a)):
            break
    if outside < 0.0 or finer is None:
        return None
    middle, passes = extremum(fine, (0.0, part.a), (1.0, part.b)) or (0.5, False)
    there = part.at(middle)
    # What is off on finer steps is a part of what these have changed.
    error = max(fine.error(there), FINER * abs(own.value(sample) - fine.value(there)))
    flat = any(own.flat(end) or abs(fine.value(end)) <= error for end in (part.a, part.b))
    if not flat and abs(fine.value(there)) <= error:
        return [finer.placed(undecided(fine, middle, error))]
    return _pair(fine, finer, middle) if passes else []


def _pair(own: Indicator, finer: Subsegment, middle: float) -> list[Found]:
    """Both crossings about a place of a part of a segment."""
    outside, inside = own.segment.a.unstable, own.beyond()
    found = []
    for low, high, counts in ((0.0, middle, (outside, inside)), (middle, 1.0, (inside, outside))):
        if (point := own.crossing(low, high)) is None:
            raise Disagreement(own.kind(own.segment.at(middle)), "Of two near crossings one is lost.")
        found.append(replace(finer.placed(point), before=counts[0], after=counts[1], counted=True))
    return found


def _by_digits(own: Indicator, theta: float) -> list[Found]:
    """What an extremum is that is nothing but rounding in doubles.

    Raises
    ------
    LostBranch
        If a solution beside it cannot be computed.
    """
    segment, sample = own.segment, own.segment.at(theta)
    way, error = float(np.sign(own.value(segment.a))), own.error(sample)
    places = [_places(own, theta, way * part * error) for part in LEVELS]
    if not all(len(sides) == 2 for sides in places):
        return [undecided(own, theta, error)]
    first, second, third = (0.25 * (high[0] - low[0]) ** 2 for low, high in places)
    square = (4.0 * first - second) / 3.0
    # What the parabola of the farther two levels says otherwise, and what places are rounded to.
    rounded = EPSILON * norm_in(sample.z, segment.weights) / segment.length
    off = abs(square - (4.0 * second - third) / 3.0) + 8.0 * rounded * np.sqrt(first)
    if square < -off:
        return []
    (left, low), (right, high) = places[0]
    found: dict[float, Found] = {}
    for share in (-np.sqrt(square / first), np.sqrt(square / first)) if square > off else ():
        near = low.varied(z=0.5 * ((1.0 - share) * low.z + (1.0 + share) * high.z))
        point = own.located(near, left, right)
        if point is not None and point.located.refined:
            found[segment.position(point.located.z)] = point
    begin, end = min(found, default=0.0), max(found, default=0.0)
    known = sum(float(point.located.error) for point in found.values())
    if not end - begin > rounded + known / max(abs(float(segment.chord[-1])), 1e-300):
        return [undecided(own, theta, error)]
    outside, inside = segment.a.unstable, own.beyond()
    return [
        replace(found[begin], theta=begin, before=outside, after=inside, counted=True),
        replace(found[end], theta=end, before=inside, after=outside, counted=True),
    ]


def _places(own: Indicator, theta: float, level: float) -> list[Placed]:
    """Where on both sides of an extremum it is `level`; fewer than two where that is not found."""
    segment = own.segment
    for sides in _beside(segment, theta):
        if all(abs(own.value(side)) > abs(level) for side in sides):
            points = [own.at_level(side, level) for side in sides]
            exact = [point and point.settled() for point in points]
            return [(segment.position(p.z), s.varied(z=p.z)) for p, s in zip(exact, sides, strict=True) if p]
    return []


def _beside(segment: Segment, theta: float, way: int = 1) -> Iterator[tuple[Sample, Sample]]:
    """Solutions on both sides of a place within the segment, each twice as far as the last; -1: inwards."""
    farthest = min(theta, 1.0 - theta) / np.sqrt(EPSILON)
    apart = np.sqrt(EPSILON) * 2.0 ** np.arange(np.ceil(np.log2(max(farthest, 1.0))))[::way]
    yield from ((segment.at(theta - each), segment.at(theta + each)) for each in apart.tolist())


def undecided(own: Indicator, theta: float, error: float) -> Found:
    """One unlocated point for two that errors may hide, or make: between the nearest that are known."""
    segment = own.segment

    def known(sample: Sample) -> bool:
        return abs(own.value(sample)) > error

    # From outside inwards: right beside the place a solution may be another branch's.
    beside = takewhile(lambda each: all(map(known, each)), _beside(segment, theta, -1))
    sides = [(segment.a, segment.b), *beside][-1]
    first, last = sorted(side.parameter for side in sides)
    note, count, there = DOUBTFUL.format(first, last), segment.a.unstable, segment.at(theta)
    point = unlocated(theta, own.kind(there), there, last - first, note, count, count)
    return replace(point, counted=True)
