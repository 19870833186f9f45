"""User marks on a segment: given values of the parameter or of observables, and extrema of observables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise

import numpy as np

from contwalk import quantities
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.locating import Found, same_point, sample_at
from contwalk.continuation.newton import correct
from contwalk.continuation.segment import LostBranch, Placed, Segment, dip_between, looked_for
from contwalk.continuation.settings import Mark
from contwalk.numerics.bracketing import narrow
from contwalk.numerics.linear import parameter_held
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.problem import Located, Problem, Sample, Test, refined

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
# What is left of the error of the steps on finer ones: a hundredth of the tolerance leaves less.
FINER = 0.05


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


def _levels(segment: Segment, name: str, level: float, observer: Observer) -> list[Found]:
    """Where a value is met on a segment: between its ends, or twice, before and behind an extremum."""
    sign = float(np.sign(observer.value(name, segment.a) - level))

    def value(sample: Sample) -> float:
        return sign * (observer.value(name, sample) - level)

    def rate(sample: Sample) -> float:
        return sign * _rate(segment, name, observer, sample)

    def nearest(low: Placed, high: Placed) -> float | None:
        return dip_between(segment, low, high, value, rate, corner=True)

    try:
        between = looked_for(segment, (0.0, segment.a), (1.0, segment.b), nearest, lambda s: value(s) < 0.0)
        knots = [0.0, *islice(between, 1), 1.0]
    except LostBranch:
        knots = [0.0, 1.0]
    met = (_met(segment, name, level, observer, *part) for part in pairwise(knots))
    return [point for point in met if point is not None]


def _rate(segment: Segment, name: str, observer: Observer, sample: Sample) -> float:
    """Derivative of an observable along the branch; of a parameter, which is linear in the free one, too."""
    if observer.line.second is not None or observer.place(name, 0.0) is None:
        return segment.problem.observed.rate(name, sample)
    ahead = observer.line.value(name, sample.parameter + float(sample.tangent[-1]))
    return float(ahead or 0.0) - observer.value(name, sample)


def _met(
    segment: Segment, name: str, level: float, observer: Observer, low: float, high: float
) -> Found | None:
    """The point between two positions at which a value is met."""

    def value(theta: float) -> float:
        return observer.value(name, segment.at(theta)) - level

    # A value met exactly at the end of a segment belongs to that segment, not to the next one as well.
    va, vb = value(low), value(high)
    if not (va * vb < 0.0 or (vb == 0.0 and va != 0.0)):
        return None

    def attempt(theta: float, left: float, right: float) -> Found | None:
        sample = segment.at(theta)
        place = observer.place(name, level)
        if place is not None and observer.line.second is None:
            located = _parameter_at(segment, place, sample)
        else:
            located = segment.problem.observed.locate_mark(name, level, sample)
        if located is None:
            return None
        position = segment.position(located.z)
        slack = 1e-3 * (right - left) + 1e-12
        if not left - slack <= position <= right + slack or not same_point(segment, located, position):
            return None
        settled = located.settled()
        if settled is None:
            return None
        marked = kind_of_test(segment.problem, Test.MARK)
        return Found(position, marked, settled, sample_at(segment, marked, settled, sample))

    try:
        found = narrow(value, low, high, va, vb, attempt) if vb != 0.0 else attempt(high, low, high)
    except LostBranch:
        return None
    return None if found is None else replace(found, kind=observer.kind(name), mark=(name, level))


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

    def decided(theta: float, left: float, right: float) -> float | None:
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
            narrow(rate, low, high, first, last, decided)
        theta = min(rates, key=lambda t: abs(rates[t]))
        if abs(rates[theta]) > 1e-5 * min(abs(first), abs(last)):
            return []  # the rate jumps: a kink
        error, certain = _extremum_error(segment, theta, lambda s: segment.problem.observed.rate(name, s))
    except LostBranch:
        return []
    sample = segment.at(theta)
    finer = _on_finer_steps(segment, name, theta)
    if finer is not None:
        error = max(error, FINER * abs(finer.parameter - sample.parameter))
        sample = finer
    point: Located = Located(sample.z, error, refined=certain)
    kind = kind_of_test(segment.problem, Test.MARK)
    return [Found(theta, kind, point, sample, kind="extremum", mark=(name, None))]


def _on_finer_steps(segment: Segment, name: str, theta: float) -> Sample | None:
    """The solution at the extremum of an observable on the finer steps of located points, near theta.

    None where solutions are not discretised, or where it is not found.
    """
    sample = segment.at(theta)
    problem = refined(segment.problem, sample.z, segment.weights)
    if problem is segment.problem:
        return None
    rates: dict[float, float] = {}
    part: Segment | None = None
    for width in (1e-3, 1e-2, 1e-1):
        sides = max(theta - width, 0.0), min(theta + width, 1.0)
        try:
            part = Segment(problem, *(segment.on(problem, side) for side in sides))
        except LostBranch:
            return None
        first, last = (problem.observed.rate(name, end) for end in (part.a, part.b))
        if first * last < 0.0:
            break
    else:
        return None

    def rate(position: float) -> float:
        rates[position] = problem.observed.rate(name, part.at(position))
        return rates[position]

    def flat(position: float, left: float, right: float) -> float | None:
        return position if abs(rates[position]) <= FLAT * max(abs(first), abs(last)) else None

    try:
        narrow(rate, 0.0, 1.0, first, last, flat, most=25)
    except LostBranch:
        return None
    return part.at(min(rates, key=lambda position: abs(rates[position])))


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
