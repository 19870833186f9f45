"""Crossings that come in pairs: extrema of stability measures between two solutions that reach past zero.

A multiplier that goes from beyond 1 to beyond -1 passes both, and the count is the same again: near
homoclinic orbits of saddle-foci each fold has its period doubling that near. Between both the count differs.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from contwalk.continuation.eigenvalues_between import peaks
from contwalk.continuation.indicator import Indicator, decided, extremum
from contwalk.continuation.kinds import crossed, kind_of_test, turning_or_pair
from contwalk.continuation.locating import Disagreement, Found, locate_multiple
from contwalk.continuation.segment import LostBranch, Placed, Segment
from contwalk.numerics.bracketing import narrow
from contwalk.problems.problem import PointType, Sample, Test

# How narrow a bracket says where a multiplier changes its sign, in parts of the segment.
NARROW = 1e-6


class Measure(Indicator):
    """A stability measure of a number, in their order: it has corners where eigenvalues change roles."""

    corner = True

    def __init__(self, segment: Segment, which: int = 0) -> None:
        super().__init__(segment, which)
        self._flat = self.flat(segment.a)

    def kind(self, sample: Sample) -> PointType:
        """What a pair crosses, or a real eigenvalue where there is no fold."""
        problem = self.segment.problem
        return crossed(problem, sample, self.which) or kind_of_test(problem, Test.ORIENTATION)

    def value(self, sample: Sample) -> float:
        """How far it is beyond zero; where a real part is zero and turns a motion looks conservative."""
        own = sample.measures if self._flat else sample.beyond(sample.eigenvalues)
        return float(own[self.which])

    def error(self, sample: Sample) -> float:
        """That of the eigenvalue."""
        return float(sample.errors[self.which])

    def doubt(self, sample: Sample) -> float:
        """That of the spectrum."""
        return sample.spectrum_error or 0.0

    def rate(self, sample: Sample) -> float:
        """That of the measure."""
        return sample.rates[self.which]

    def flat(self, sample: Sample) -> bool:
        """Whether an eigenvalue stays on the border, of a conservative motion: its measure is another one."""
        own = sample.beyond(sample.eigenvalues)[self.which]
        return bool(abs(own) < 0.5 * abs(sample.measures[self.which]))

    def beyond(self) -> int:
        """Those at the ends, and one or two more or fewer."""
        a = self.segment.a
        passing = 1 if a.eigenvalues[self.which].imag == 0.0 else 2
        return a.unstable + (passing if a.measures[self.which] < 0.0 else -passing)


def knots_of(segment: Segment, branch_points: list[Found]) -> tuple[list[float], list[Found]]:
    """Ends of the segment and positions between which every change shows, and points that only touch zero.

    The positions are extrema of stability measures at which a sign changes unseen by the ends. A branch point
    splits the search: there a measure may touch zero without passing it. Elsewhere one that touches zero
    belongs to a point where several eigenvalues vanish, some passing up and as many down.
    """
    ends: list[Placed] = [(0.0, segment.a), *[(f.theta, f.sample) for f in branch_points], (1.0, segment.b)]
    knots, touching = [0.0, 1.0], list[Found]()
    for measure, theta, passes in _extrema(segment, ends, knots):
        if any(abs(theta - f.theta) < 1e-3 for f in touching):
            continue  # both of a pair have one extremum
        touches = not passes and _touches(segment, measure.which, theta)
        together = locate_multiple(segment, theta) if touches else None
        pair = [together] if together is not None else decided(measure, theta)
        if pair is not None:
            touching += pair
        elif passes:
            knots.append(theta)
    if (between := _between_one_and_minus_one(segment)) is not None:
        knots.append(between)
    return sorted(set(knots)), touching


def _extrema(
    segment: Segment, ends: list[Placed], knots: list[float]
) -> Iterator[tuple[Measure, float, bool]]:
    """Measures, where they come nearest to zero, and whether they are beyond it there; `knots` gets peaks.

    Where two eigenvalues meet, their measures are smooth from there on: what is looked at there is as well.
    What is not known from zero there is nearest to it as far as can be told.
    """
    for begin, end in pairwise(ends):
        known = set(segment.places)
        knots += peaks(segment, begin, end)
        inside = [(theta, segment.at(theta)) for theta in segment.places if theta not in known]
        for theta, there in inside:
            for which in _same_side(begin[1], end[1], there):
                yield Measure(segment, which), theta, False
        for low, high in pairwise((begin, *(place for place in inside if not place[1].undecided), end)):
            for which in _same_side(low[1], high[1]):
                yield from _nearest(segment, which, low, high)
    for _, there in ends[1:-1]:  # a pair that is not known from zero there tells nothing on either side
        for which in _same_side(segment.a, segment.b, there):
            if there.eigenvalues[which].imag != 0.0:
                yield from _nearest(segment, which, ends[0], ends[-1])


def _nearest(
    segment: Segment, which: int, low: Placed, high: Placed
) -> Iterator[tuple[Measure, float, bool]]:
    """A measure, where it comes nearest to zero between two solutions, and whether it is beyond by then."""
    measure = Measure(segment, which)
    if (found := extremum(measure, low, high)) is not None:
        yield measure, *found


def _between_one_and_minus_one(segment: Segment) -> float | None:
    """Where a multiplier that goes from beyond 1 to beyond -1, or back, is between: the count differs there.

    Raises
    ------
    Disagreement
        If it goes by zero, and the count is that of the ends all the way: with where it is zero.
    """
    a, b = segment.a, segment.b
    which = None if segment.problem.meshed is None else _changes_sides(a, b)
    if which is None:
        return None
    ends = float(a.eigenvalues[which].real), float(b.eigenvalues[which].real)
    largest = place = 0.0

    def value(theta: float) -> float:
        return float(segment.at(theta).eigenvalues[which].real)

    def attempt(theta: float, left: float, right: float) -> float | None:
        nonlocal largest, place
        largest, place = max(largest, abs(value(theta))), theta
        return theta if segment.at(theta).unstable != a.unstable else None

    try:
        found = narrow(value, 0.0, 1.0, *ends, attempt, width=NARROW)
    except LostBranch:
        if segment.problem.limited is None:
            raise
        return None  # a limit may lie there, which is looked for by itself
    # Of an orbit with events it changes sides by a pole as well, where one is grazed: it passes neither then.
    by_a_pole = segment.problem.limited is not None and largest > max(abs(end) for end in ends)
    if found is None and not by_a_pole:
        sentence = "A multiplier goes from beyond 1 to beyond -1, and neither is seen."
        raise Disagreement(turning_or_pair(segment.problem), sentence, (place, which))
    return found


def _changes_sides(a: Sample, b: Sample) -> int | None:
    """The real multiplier that is beyond 1 at one end and beyond -1 at the other; as many are unstable.

    Two that meet may go round zero together: then as many of them are beyond 1 as before, or two more.
    """
    if a.unstable != b.unstable or (_beyond_one(a) - _beyond_one(b)) % 2 == 0:
        return None
    for which in range(a.unstable):
        values = [s.eigenvalues[which] for s in (a, b)]
        known = all(abs(s.eigenvalues[which]) > max(s.errors[which], s.spectrum_error or 0.0) for s in (a, b))
        if known and values[0].imag == values[1].imag == 0.0 and values[0].real * values[1].real < 0.0:
            return which
    return None


def _beyond_one(sample: Sample) -> int:
    """How many of the real multipliers that are counted as unstable are larger than one."""
    counted = sample.eigenvalues[: sample.unstable]
    return int(np.count_nonzero((counted.imag == 0.0) & (counted.real > 1.0)))


def _touches(segment: Segment, which: int, theta: float) -> bool:
    """Whether a real eigenvalue is zero at its extremum, against what it is at the ends."""
    at, *ends = (abs(sample.measures[which]) for sample in (segment.at(theta), segment.a, segment.b))
    return segment.at(theta).eigenvalues[which].imag == 0.0 and bool(at < 1e-5 * min(ends))


def _same_side(a: Sample, b: Sample, between: Sample | None = None) -> Iterator[int]:
    """Measures that are known to have the same sign at both ends, and may turn between.

    With a solution between: those that are not known from zero there.
    """
    ma, mb = a.measures, b.measures
    certain = (np.abs(ma) > a.errors) & (np.abs(mb) > b.errors)
    suspects = certain & (np.sign(ma) == np.sign(mb))
    if between is not None:
        suspects &= np.abs(between.measures) <= between.errors
    elif a.rates.values is not None and b.rates.values is not None:
        # By signs alone: a rate that is infinite has no product with zero, and small ones have none.
        ways = np.copysign(1.0, ma) * a.rates.values, np.copysign(1.0, mb) * b.rates.values
        suspects &= (ways[0] < 0.0) & (ways[1] > 0.0)
    for which in np.flatnonzero(suspects).tolist():
        ends = a.eigenvalues[which], b.eigenvalues[which]
        # One that passes both 1 and -1, or zero, is told by `_between_one_and_minus_one`.
        if not ends[0].imag == ends[1].imag == 0.0 or np.sign(ends[0].real) == np.sign(ends[1].real):
            yield which
