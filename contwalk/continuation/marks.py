"""User marks on a segment: given values of the parameter or of observables, and extrema of observables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contwalk import quantities
from contwalk.continuation.indicator import FINER, Indicator, between
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.locating import Disagreement, Found, around, on_finest_steps, same_point, sample_at
from contwalk.continuation.newton import correct
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Mark
from contwalk.numerics.bracketing import narrow, zero_of
from contwalk.numerics.linear import EPSILON, parameter_held
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.problem import Located, PointType, Problem, Sample, Test, refined

# How near to a turn of the branch, in parts of the segment, no extremum is looked for.
TURN = 1e-3
# A rate this small against those at the ends is zero to rounding.
FLAT = 4e-14
# A rate that is still half of what it is at the ends of a segment, and over a bracket changes so many times
# as steeply as between them, jumps from one sign to the other; of a smooth extremum it would be a thousandth.
STEEP = 1e3
# A rate in the metric this small against the value is none.
STILL = 1e-9
# How far beyond a place at which a rate is exactly zero its sign is looked at: in parts of a segment, or in
# the metric.
BEYOND = 1e-3


@dataclass(frozen=True)
class Observer:
    """What changes along a branch: the parameters of its line, and its observables, in the order of
    `Sample.observables`.
    """

    line: ParameterLine
    observables: tuple[str, ...]

    def value(self, name: str, sample: Sample) -> float:
        """Value of a mark's name at a sample; NaN where the problem lacks it, as an equilibrium `max_abs`."""
        along = self.line.value(name, sample.parameter)
        if along is not None:
            return along
        if name == self.line.second:
            return float(sample.z[-2])
        if name == quantities.PERIOD:
            return sample.period
        value = quantities.column(name, self.observables, sample.observables)
        return float("nan") if value is None else float(value)

    def place(self, name: str, level: float) -> float | None:
        """The free parameter at which `name` has the value `level`; None if it is none of a line's."""
        return self.line.coordinate(name, level)

    def kind(self, name: str) -> str:
        """Of a marked value: `parameter` or `observable`."""
        moves = name == self.line.free or name in self.line.moving_names
        return "parameter" if moves else "observable"


def observer_of(problem: Problem) -> Observer:
    """The observer of a problem's branches."""
    return Observer(problem.line, problem.observed.observable_names)


def marked(
    segment: Segment, marks: tuple[Mark, ...], observer: Observer, turns: Sequence[float] = ()
) -> list[Found]:
    """All marked points on a segment, in their order.

    `turns` are positions at which the branch itself turns: its folds and crossings, and its birth, at which
    what is on its two sides is alike.
    """
    found: list[Found] = []
    for mark in marks:
        if np.isnan(observer.value(mark.name, segment.a)):
            continue
        for level in mark.values:
            found += _levels(segment, mark.name, level, observer)
        if mark.extremum:
            # Where the branch turns, everything on it is extreme; it says nothing about the observable.
            for low, high in pairwise(sorted({0.0, *turns, 1.0})):
                margins = (TURN if low in turns else 0.0), (TURN if high in turns else 0.0)
                if high - low > sum(margins):
                    found += _extrema(segment, mark.name, low + margins[0], high - margins[1], observer)
    return sorted(found, key=lambda f: f.theta)


class Level(Indicator):
    """What a value is beyond one that is marked."""

    corner = True

    def __init__(self, segment: Segment, name: str, level: float, observer: Observer) -> None:
        super().__init__(segment)
        self._name, self._level, self._observer = name, level, observer

    def on(self, segment: Segment) -> Level:
        """The same along another segment."""
        return Level(segment, self._name, self._level, self._observer)

    def kind(self, sample: Sample) -> PointType:
        """A mark."""
        return kind_of_test(self.segment.problem, Test.MARK)

    def value(self, sample: Sample) -> float:
        """What it is beyond the level."""
        return self._observer.value(self._name, sample) - self._level

    def error(self, sample: Sample) -> float:
        """Rounding."""
        return EPSILON * (abs(self._observer.value(self._name, sample)) + abs(self._level))

    def rate(self, sample: Sample) -> float:
        """That of an observable; of a parameter, which is linear in the free one, too."""
        observer, name = self._observer, self._name
        if observer.line.second is not None or observer.place(name, 0.0) is None:
            return self.segment.problem.observed.rate(name, sample)
        ahead = observer.line.value(name, sample.parameter + float(sample.tangent[-1]))
        return float(ahead or 0.0) - observer.value(name, sample)

    def at_level(self, sample: Sample, level: float) -> Located | None:
        """Where it is another value."""
        return self._solved(self._level + level, sample)

    def crossing(self, low: float, high: float) -> Found | None:
        """The point between two positions at which the value is met."""
        # A value met exactly at the end of a segment belongs to that segment, not to the next one as well.
        va, vb = (self.value(self.segment.at(theta)) for theta in (low, high))
        if not (va * vb < 0.0 or (vb == 0.0 and va != 0.0)):
            return None
        try:
            return super().crossing(low, high)
        except LostBranch:
            return None

    def located(self, near: Sample, low: float, high: float) -> Found | None:
        """The point near a sample, if it lies between two positions."""
        located = self._solved(self._level, near)
        if located is None:
            return None
        position, slack = self.segment.position(located.z), 1e-3 * (high - low) + 1e-12
        outside = not low - slack <= position <= high + slack
        if outside or not same_point(self.segment, located, position):
            return None
        settled = located.settled()
        if settled is None:
            return None
        kind = self.kind(near)
        return Found(position, kind, settled, sample_at(self.segment, kind, settled, near))

    def _solved(self, level: float, near: Sample) -> Located | None:
        """The solution near a sample at which the value is a level."""
        place = self._observer.place(self._name, level)
        if place is not None and self._observer.line.second is None:
            return _parameter_at(self.segment, place, near)
        return self.segment.problem.observed.locate_mark(self._name, level, near)


def _levels(segment: Segment, name: str, level: float, observer: Observer) -> list[Found]:
    """Where a value is met on a segment: between its ends, or twice, before and behind an extremum."""
    own, mark = Level(segment, name, level, observer), (name, level)
    found, turn = list[Found](), list[float]()
    values = [own.value(end) for end in (segment.a, segment.b)]
    if values[0] * values[1] > 0.0 and all(map(own.known, (segment.a, segment.b))):
        with suppress(LostBranch, Disagreement):
            found, turn = between(own)
    found += [point for part in pairwise((0.0, *turn, 1.0)) if (point := own.crossing(*part)) is not None]
    kind = observer.kind(name)
    return [replace(point, kind=point.kind or kind, counted=False, mark=mark) for point in found]


def _parameter_at(segment: Segment, value: float, near: Sample) -> Located | None:
    """The solution at exactly this value of the free parameter."""
    guess = near.z + (value - near.z[-1]) / near.tangent[-1] * near.tangent if near.tangent[-1] else near.z
    guess = np.append(guess[:-1], value)

    def solved(problem: Problem, guess: np.ndarray) -> Located | None:
        correction = correct(problem, guess, parameter_held(segment.weights), segment.weights)
        if not correction.ok:
            return None
        z = np.append(correction.z[:-1], value)
        return Located(z, float(np.spacing(abs(value))), refined=True, problem=correction.problem)

    found = solved(segment.problem, guess)
    if found is None:
        return None
    z = found.z
    return replace(found, refine=lambda: solved(refined(segment.problem, z, segment.weights), z))


def _extrema(segment: Segment, name: str, low: float, high: float, observer: Observer) -> list[Found]:
    """Smooth extrema of an observable; kinks, where two eigenvalues change roles, are not special points."""

    def rate(theta: float) -> float:
        if theta not in rates:
            rates[theta] = segment.problem.observed.rate(name, segment.at(theta))
        return rates[theta]

    def found(theta: float, left: float, right: float) -> float | None:
        flat = abs(rates[theta]) <= FLAT * max(abs(rates[low]), abs(rates[high]))
        beside, ends = ([abs(rates[t]) for t in each] for each in ((left, right), (low, high)))
        steep = (high - low) * sum(beside) > STEEP * (right - left) * sum(ends)
        return theta if flat or (steep and min(beside) > 0.5 * min(ends)) else None

    rates: dict[float, float] = {}
    try:
        first, last = rate(low), rate(high)
        if not (np.isfinite(first) and np.isfinite(last)):
            return []
        if last == 0.0 and high == 1.0:  # exactly at a joint, of which the next segment does not tell
            last = rate(1.0 + BEYOND)
        value = max(abs(observer.value(name, end)) for end in (segment.a, segment.b))
        # What stands still, as the modulus of a pair does where the flow contracts evenly, has no extrema.
        if first * last >= 0.0 or max(abs(first), abs(last)) <= STILL * value:
            return []
        if rates[high] != 0.0:
            narrow(rate, low, high, first, last, found)
        theta = min(rates, key=lambda t: abs(rates[t]))
        if abs(rates[theta]) > 1e-5 * min(abs(first), abs(last)):
            return []  # the rate jumps: a kink
        error, certain = _extremum_error(segment, theta, lambda s: segment.problem.observed.rate(name, s))
    except LostBranch:
        return []
    sample = segment.at(theta)
    finer = _on_finest_steps(segment, name, theta)
    if finer is not None:
        error = max(error, FINER * abs(finer.parameter - sample.parameter))
        sample = finer
    point: Located = Located(sample.z, error, refined=certain)
    kind = kind_of_test(segment.problem, Test.MARK)
    return [Found(theta, kind, point, sample, kind="extremum", mark=(name, None))]


def _on_finest_steps(segment: Segment, name: str, theta: float) -> Sample | None:
    """The solution at the extremum of an observable on the finest steps, near theta.

    None where solutions are not discretised, or where it is not found.
    """
    try:
        kind = kind_of_test(segment.problem, Test.MARK)
        finer = on_finest_steps(segment, segment.at(theta), kind, around(theta))
        if finer is None:
            return None
        part = finer.part
        place = zero_of(lambda t: part.problem.observed.rate(name, part.at(t)), 0.0, 1.0)
    except (LostBranch, Disagreement):
        return None
    return None if place is None else part.at(place)


def _extremum_error(segment: Segment, theta: float, rate: Callable[[Sample], float]) -> tuple[float, bool]:
    """Estimated error of the parameter at an extremum: noise of the rate over its slope.

    The rate is sampled around the extremum; what a parabola through it does not explain is its noise, and
    so is what is left of it there.
    """
    offsets = np.linspace(-1.0, 1.0, 9) * min(1e-3, theta, 1.0 - theta)
    if offsets[-1] <= 0.0:
        offsets = np.linspace(-1.0, 1.0, 9) * 1e-3
    samples = [segment.at(theta + d) for d in offsets]
    rates = np.array([rate(s) for s in samples])
    fit = np.polynomial.Polynomial.fit(offsets, rates, 3)
    noise = max(float(np.max(np.abs(fit(offsets) - rates))), abs(float(rates[len(rates) // 2])))
    slope = abs(float(fit.deriv()(0.0)))
    per_theta = abs(float(segment.chord[-1]))
    middle = abs(samples[len(samples) // 2].parameter)
    return 4.0 * noise / max(slope, 1e-300) * per_theta + float(np.spacing(middle)), slope > 0.0
