"""Points that are located along the branch by a function of their own: their equations are singular there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.continuation.kinds import crossed, kinds_of_test
from contwalk.continuation.locating import Found
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.errors import NotFinite
from contwalk.numerics.bracketing import NARROW, zero_of
from contwalk.problems.located import TURNED
from contwalk.problems.problem import Located, PointType, Sample, Test, finest

# On the finest steps it is looked for so far to both sides, in parts of the segment.
NEIGHBOURHOOD = 0.02
# The function may be off by so many times what eigenvalues away from the point are not known to.
KNOWN = 10.0
BESIDE_THE_FOLD = (
    "A multiplier goes from beyond 1 to beyond -1 at the fold, within what is known of it there."
)


def located_along(segment: Segment, kind: PointType, low: float, high: float, which: int) -> Found | None:
    """The point of a kind between two positions, on the finest steps that there are, if there is one."""
    theta = _zero(segment, kind, low, high)
    if theta is None:
        return None
    part, begin, width = _finest(segment, theta, low, high)
    position = theta if part is segment else _zero(part, kind, 0.0, 1.0)
    if position is None:
        return None
    sample = part.at(position)
    ends = (low, high) if part is segment else (0.0, 1.0)
    first, last = (kind.value(part.problem, part.at(end)) for end in ends)
    slope = (last - first) / (ends[1] - ends[0])
    blur = max(_blur(kind, part, part.at(end)) for end in ends) / max(abs(slope), 1e-300) + NARROW
    error = blur * abs(float(part.chord[-1])) + sample.error * float(sample.weights[-1])
    located = Located(
        sample.z, max(error, float(np.spacing(abs(sample.parameter)))), {"which": which}, problem=part.problem
    )
    return Found(begin + position * width, kind, located, sample)


def at_the_turn(segment: Segment, which: int) -> list[Found]:
    """The fold that the parameter's own turn tells, and the doubling that is not told apart from it.

    Multiplier `which` goes from beyond 1 to beyond -1 there, faster than anything is known: it passes both.
    """
    turning = next(iter(kinds_of_test(segment.problem, Test.TURN)), None)
    fold = None if turning is None else _turned(segment, turning)
    if fold is None:
        return []
    counted = replace(fold, before=segment.a.unstable, after=segment.b.unstable, counted=True)
    ends = (end for end in (segment.a, segment.b) if end.eigenvalues[which].real < 0.0)
    doubling = next((crossed(segment.problem, end, which) for end in ends), None)
    if doubling is None:
        return [counted]
    beside = Located(fold.located.z, fold.located.error, {"note": BESIDE_THE_FOLD}, refined=False)
    return [counted, replace(counted, type=doubling, located=beside, kind="unlocated")]


def _turned(segment: Segment, kind: PointType) -> Found | None:
    """The fold at which the parameter turns between the ends, and by more than it is known to.

    That is so whatever multipliers tell: where deviations grow beyond 1e16 they tell nothing near one. Errors
    of the steps shift a fold, but change along the branch as solutions do: over a step by its length, in the
    metric, of what they are. Beside that a turn is lost in rounding alone.
    """
    meshed = segment.problem.meshed
    if meshed is None or segment.vertical:
        return None
    theta = zero_of(lambda theta: segment.at(theta).share, 0.0, 1.0)
    if theta is None:
        return None
    sample = segment.at(theta)
    equations, row = segment.problem.linearize(sample.z), sample.tangent / sample.weights**2
    known = equations.parameter_error(row, sample.weights, meshed.errors_at(sample.z))
    rounding = equations.parameter_error(row, sample.weights, equations.levels[0])
    rises = [abs(sample.parameter - end.parameter) for end in (segment.a, segment.b)]
    if not min(rises) > KNOWN * (rounding + segment.length * known):
        return None
    error = max(known, float(np.spacing(abs(sample.parameter))))
    located = Located(sample.z, error, {TURNED: True}, problem=segment.problem)
    return Found(theta, kind, located, sample)


def _zero(segment: Segment, kind: PointType, low: float, high: float) -> float | None:
    """Where the function of a kind passes zero, to rounding."""
    return zero_of(lambda theta: kind.value(segment.problem, segment.at(theta)), low, high)


def _finest(segment: Segment, theta: float, low: float, high: float) -> tuple[Segment, float, float]:
    """The segment around a position on the finest steps, where it begins and how long it is; itself if there
    are none.
    """
    sides = max(theta - NEIGHBOURHOOD, low), min(theta + NEIGHBOURHOOD, high)
    try:
        there = finest(segment.problem, segment.at(theta).z, segment.weights)
        if there is None:
            return segment, 0.0, 1.0
        a, b = (segment.on(there, side) for side in sides)
    except (NotFinite, LostBranch):
        return segment, 0.0, 1.0
    return Segment(there, a, b), sides[0], sides[1] - sides[0]


def _blur(kind: PointType, segment: Segment, sample: Sample) -> float:
    """What the function is not known to, by what eigenvalues are not known to away from the point.

    These are off by that of the function over its root.
    """
    off = float(sample.errors.max(initial=0.0)) if sample.spectrum_error is None else sample.spectrum_error
    size = float(np.abs(sample.eigenvalues).max(initial=1e-300))
    return KNOWN * off / size * float(np.sqrt(abs(kind.value(segment.problem, sample))))
