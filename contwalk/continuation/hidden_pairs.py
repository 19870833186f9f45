"""Two crossings that errors hide: a stability measure comes as near to zero as it is known, and turns back.

Beside its extremum the measure is a parabola: where it has a level l the branch is w away on both sides, with
w^2 proportional to l - l0. Places at levels that are known from zero, solved for in extended precision, tell
what w^2 is at zero: it is negative where the measure turns back before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from contwalk.continuation.kinds import crossed, kind_of_test
from contwalk.continuation.locating import Found, accepted, unlocated
from contwalk.continuation.segment import Placed, Segment
from contwalk.numerics.linear import EPSILON, norm_in
from contwalk.problems.problem import PointType, Sample, Test

# Levels, in units of what the measure is known to: each is four times the last one, and as far again from the
# extremum.
LEVELS = (16.0, 64.0, 256.0)
DOUBTFUL = (
    "What is critical is reached, and left again to the same side, within what is known of it: whether it is "
    "passed twice is not known. If it is, that is between {:.17g} and {:.17g}."
)


def held(sample: Sample, which: int) -> bool:
    """Whether an eigenvalue stays on the border, of a conservative motion: its measure is another one."""
    return bool(abs(sample.beyond(sample.eigenvalues)[which]) < 0.5 * abs(sample.measures[which]))


def reached(segment: Segment, sample: Sample, which: int) -> float:
    """How far measure `which` is beyond zero, as at the ends of a segment.

    Where a real part is zero and turns a motion looks conservative.
    """
    own = sample.measures if held(segment.a, which) else sample.beyond(sample.eigenvalues)
    return float(own[which])


def decided(segment: Segment, which: int, theta: float) -> list[Found]:
    """Both crossings at an extremum of a measure that is not known from zero, none, or one point for both.

    Raises
    ------
    LostBranch
        If a solution beside it cannot be computed.
    """
    sample, outside = segment.at(theta), segment.a.unstable
    kind = crossed(segment.problem, sample, which) or kind_of_test(segment.problem, Test.ORIENTATION)
    way = float(np.sign(segment.a.measures[which]))
    places = [_places(segment, kind, which, theta, way * part * sample.errors[which]) for part in LEVELS]

    def known(beside: Sample) -> bool:
        return abs(reached(segment, beside, which)) > sample.errors[which]

    if not all(len(sides) == 2 for sides in places):
        return [undecided(segment, kind, theta, known)]
    first, second, third = (0.25 * (high[0] - low[0]) ** 2 for low, high in places)
    square = (4.0 * first - second) / 3.0
    # What the parabola of the farther two levels says otherwise, and what places are rounded to.
    rounded = EPSILON * norm_in(sample.z, segment.weights) / segment.length
    error = abs(square - (4.0 * second - third) / 3.0) + 8.0 * rounded * np.sqrt(first)
    if square < -error:
        return []
    (left, low), (right, high) = places[0]
    found: dict[float, Found] = {}
    for share in (-np.sqrt(square / first), np.sqrt(square / first)) if square > error else ():
        near = low.varied(z=0.5 * ((1.0 - share) * low.z + (1.0 + share) * high.z))
        point = accepted(segment, kind, near, which, left, right)
        if point is not None and point.located.refined:
            found[segment.position(point.located.z)] = point
    begin, end = min(found, default=0.0), max(found, default=0.0)
    if not end - begin > rounded:
        return [undecided(segment, kind, theta, known)]
    inside = outside - int(way) * (1 if sample.eigenvalues[which].imag == 0.0 else 2)
    return [
        replace(found[begin], theta=begin, before=outside, after=inside, counted=True),
        replace(found[end], theta=end, before=inside, after=outside, counted=True),
    ]


def _places(segment: Segment, kind: PointType, which: int, theta: float, level: float) -> list[Placed]:
    """Where on both sides of an extremum the measure is `level`; fewer than two where that is not found."""
    for sides in _beside(segment, theta):
        if all(abs(reached(segment, side, which)) > abs(level) for side in sides):
            points = [kind.at_level(segment.problem, side, which, level) for side in sides]
            exact = [point and point.settled() for point in points]
            return [(segment.position(p.z), s.varied(z=p.z)) for p, s in zip(exact, sides, strict=True) if p]
    return []


def _beside(segment: Segment, theta: float) -> Iterator[tuple[Sample, Sample]]:
    """Solutions on both sides of a place, farther and farther away."""
    apart = np.sqrt(EPSILON)
    while apart < min(theta, 1.0 - theta):
        yield segment.at(theta - apart), segment.at(theta + apart)
        apart *= 2.0


def undecided(segment: Segment, kind: PointType, theta: float, known: Callable[[Sample], bool]) -> Found:
    """One unlocated point for two that errors may hide, or make: between the nearest that are `known`."""
    ends = segment.a, segment.b
    sides = next((sides for sides in _beside(segment, theta) if all(map(known, sides))), ends)
    first, last = sorted(side.parameter for side in sides)
    note, count = DOUBTFUL.format(first, last), segment.a.unstable
    return replace(unlocated(theta, kind, segment.at(theta), last - first, note, count, count), counted=True)
