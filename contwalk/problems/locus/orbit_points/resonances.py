"""Strong resonances: R1 on curves of folds and tori, R2 on those of doublings and tori, R3, R4 of tori."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any, ClassVar

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.condensed import of_any_orbit
from contwalk.problems.locus.orbit_conditions import At, pair_system
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.point import (
    Form,
    OrbitLocusPoint,
    alone,
    known_to,
    near_of,
    together,
)
from contwalk.problems.locus.orbit_points.switching import born, ones_born
from contwalk.problems.locus.orbit_points.turning_angle import SEMISIMPLE, TURNS_BACK, turning_angle
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample, Seed, Test

# Where a function is as near to an extremum of zero as it is known, its rate is of the root of that.
TURNS = 10.0
# A place that is farther away than this, in the metric, is on no step: those of a walk are a fraction of it.
FAR = 1.0


class OnTori(OrbitLocusPoint):
    """The angle of a pair of multipliers on the unit circle is a whole part of a turn."""

    test, of_place = Test.VALUE, True
    cosine: ClassVar[float]

    def value(self, problem: Any, sample: Sample) -> float:
        """How far the cosine of the angle is from its own."""
        return float(problem.further(sample.z)[0]) - self.cosine

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The curve's equations, and the cosine."""
        place = problem.plane.size

        def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return there.linearize(y).with_row(y[place] - self.cosine, np.eye(1, len(y), place))

        return Augmented(evaluate, sample.z, sample.weights)


class R1OnTori(OnTori):
    """Both multipliers are one: the curve goes on as neutral saddles."""

    label, cosine = "R1", 1.0

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of folds, or of branch points."""
        return ones_born(problem, point)


class R2OnTori(OnTori):
    """Both multipliers are minus one: the curve goes on as neutral saddles.

    Or the angle turns back there, as where half an orbit of a symmetric system has a pair i, -i: the whole
    has a double multiplier with two directions then, and no doublings begin.
    """

    label, cosine = "R2", -1.0

    def value(self, problem: Any, sample: Sample) -> float:
        """How far the cosine of the angle is from minus one, over its rate along the curve.

        Its sign changes where the cosine passes minus one, and also where it comes there and turns back. An
        extremum elsewhere is a pole: the value is about how far away the place is, and nothing is told of
        one that no step comes to. Right at one, nearer than is known, the rate alone tells. Of an angle that
        stands still along the curve the sign of the rate is noise, and nothing is told.
        """
        beyond, rate = super().value(problem, sample), float(sample.tangent[problem.plane.size])
        known = known_to(problem)
        if abs(beyond) <= known and abs(rate) <= TURNS * known**0.5:
            return rate
        near = abs(rate) > known and abs(beyond) <= FAR * abs(rate)
        return beyond / rate if near else float("nan")

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point at which the angle passes half a turn, or turns back."""
        return turning_angle(problem, sample, self.cosine) or super().locate(problem, sample, which)

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """That of the curve beside a point at which the angle turns back, where nothing else tells it.

        Shape (N + k + 2,).
        """
        return near.tangent if located.data == SEMISIMPLE else None

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The coefficients, or what is special of one at which the angle turns back."""
        if located.data == SEMISIMPLE:
            return SEMISIMPLE, {}, TURNS_BACK
        return super().form(problem, located, sample)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of doublings, where there is one."""
        return () if point.kind == SEMISIMPLE else born(problem, point, "PD")


class R3(OnTori):
    """A third of a turn."""

    label, cosine = "R3", -0.5


class R4(OnTori):
    """A quarter of a turn."""

    label, cosine = "R4", 0.0


class SecondMultiplier(OrbitLocusPoint):
    """A second multiplier arrives where the curve holds one."""

    test, changes = Test.STABILITY, (-1, 1)
    multiplier: ClassVar[float]

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real multiplier of the same sign, which may have met the curve's own."""
        value = sample.eigenvalues[which]
        real = value.imag == 0.0 or alone(sample, which)
        return bool(real and value.real * self.multiplier > 0.0)

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """A pair of multipliers whose mean is there, in place of the curve's own condition."""
        there, own = problem.plane.first(sample.z)
        near = near_of(problem, sample, own)
        pair = of_any_orbit(there, near, np.zeros(0), self._pair)
        return together(problem, sample, [Held(pair, np.zeros(0, dtype=int))], np.zeros(0))

    def _pair(self, orbit: Any, near: At, further: np.ndarray) -> Augmented:
        """Both multipliers there, of an orbit near a place; `further` has the shape (0,)."""
        return pair_system(orbit, near, self.multiplier, held=True)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """The multiplier that arrives."""
        return complex(self.multiplier)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of tori, and of the neutral saddles that they become."""
        return born(problem, point, "NS", self.multiplier)


class R1OnFolds(SecondMultiplier):
    """A second multiplier is one."""

    label, multiplier = "R1", 1.0


class R2OnDoublings(SecondMultiplier):
    """A second multiplier is minus one."""

    label, multiplier = "R2", -1.0

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of tori, and that of the tori of doubled orbits where these have any."""
        births: Any = import_module("contwalk.problems.locus.doubled_births")  # it knows curves of orbits
        return [*super().seeds(problem, point), *births.tori_of_doubled_orbits(problem, point)]
