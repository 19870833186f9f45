"""Bogdanov-Takens points (BT): a double zero eigenvalue with one vector, on LP and on HB curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.bordered import pair_borders
from contwalk.problems.locus.conditions import Augmented, DoubleZero
from contwalk.problems.locus.normal_forms import bogdanov_takens_coefficients
from contwalk.problems.locus.points.point import Form, LocusPoint, born, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test


class BogdanovTakens(LocusPoint):
    """A fold at which a second eigenvalue vanishes, or a Hopf point at which the frequency does."""

    label = "BT"

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double zero near a sample."""
        plane = problem.plane
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        borders = pair_borders(matrix, plane.finite, 0.0)
        return located_by(problem, Augmented(plane, (DoubleZero(borders),)), sample, [])

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The coefficients a and b."""
        return None, bogdanov_takens_coefficients(problem.plane, problem.in_plane(located.z)), None


class SecondZero(BogdanovTakens):
    """On a curve of folds: a second real eigenvalue passes zero."""

    test, changes = Test.STABILITY, (-1, 1)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of Hopf points that ends there, and of the neutral saddles that it becomes."""
        return born(problem, point, "HB")

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real eigenvalue."""
        return bool(sample.eigenvalues[which].imag == 0.0)


class VanishingFrequency(BogdanovTakens):
    """On a curve of Hopf points: the frequency vanishes, and the curve goes on as neutral saddles."""

    test = Test.VALUE

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of folds."""
        return born(problem, point, "LP")

    def value(self, problem: Any, sample: Sample) -> float:
        """The square of the frequency."""
        return problem.kappa(sample.z)
