"""Bogdanov-Takens points (BT): a double zero eigenvalue with one vector, on LP, BP and HB curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import pair_borders
from contwalk.problems.locus.conditions import Augmented, DoubleZero
from contwalk.problems.locus.curves import HOPF_POINTS
from contwalk.problems.locus.normal_forms import bogdanov_takens_coefficients
from contwalk.problems.locus.points.crossing import (
    NO_DOUBLE_ZERO,
    Crossing,
    at_zero,
    both_born,
    located_by_units,
)
from contwalk.problems.locus.points.persisting import KIND, better, zeros_born
from contwalk.problems.locus.points.point import LocusPoint, born, located_by
from contwalk.problems.locus.points.second_zero import second_zero, two_vectors
from contwalk.problems.problem import Located, Sample, Seed, Test

TWO = "double zero"


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
        return None, None, bogdanov_takens_coefficients(problem.plane, problem.in_plane(located.z)), None


class SecondZero(BogdanovTakens):
    """On a curve of folds: a second real eigenvalue passes zero.

    With a symmetry it may have a vector of its own, and then a curve of branch points crosses there: BP.
    """

    test, changes = Test.STABILITY, (-1, 1)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of Hopf points that ends there, and of the neutral saddles that it becomes."""
        return born(problem, point, HOPF_POINTS)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real eigenvalue."""
        return bool(sample.eigenvalues[which].imag == 0.0)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double zero near a sample, with one vector or with two."""
        return super().locate(problem, sample, which) or second_zero(problem, sample)

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point; with two vectors another curve crosses there."""
        if not two_vectors(problem, located.z):
            return super().describe(problem, located, sample, s)
        record = LocusPoint.describe(_Bare(), problem, located, sample, s)
        note = "two eigenvalues vanish together, each with a vector of its own: another curve crosses here"
        return replace(record, label="BP", kind=TWO, note=note)


class SecondZeroOnBranchPoints(SecondZero):
    """On a curve of branch points."""

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double zero near a sample."""
        return second_zero(problem, sample)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """None: the normal form is that of the symmetry."""
        return None, None, {}, NO_DOUBLE_ZERO

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curves of Hopf points that end there, of each of the branches."""
        return both_born(problem, point, HOPF_POINTS)


def _where_curves_cross(problem: Any, sample: Sample) -> Located | None:
    """The double zero near a sample of a curve of Hopf points at which that of another branch crosses."""
    try:
        found = located_by_units(problem, sample)
    except np.linalg.LinAlgError:
        return None
    return _told(found) if found is not None and at_zero(problem, found, sample) else None


def _told(found: Located | None) -> Located | None:
    """A crossing at which a pair is zero, marked as such, whether refined or not."""
    if found is None:
        return None
    refine = None if found.refine is None else lambda: _told(found.settled())
    return replace(found, crossing=(), refine=refine)


class _Bare(LocusPoint):
    """A point of which nothing more is told."""

    label, test = "BP", Test.STABILITY


class VanishingFrequency(BogdanovTakens):
    """On a curve of Hopf points: the frequency vanishes, and the curve goes on as neutral saddles."""

    test, of_place, saddles = Test.VALUE, True, True

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of folds; or that of branch points, and that of the other branch's Hopf points."""
        crossing = Crossing().seeds(problem, point) if point.kind == KIND else ()
        return [*crossing, *zeros_born(problem, point)]

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double zero near a sample; where branches cross for good, as a crossing of curves.

        There the conditions of a double zero are singular, for [F_u F_first F_second] is.
        """
        return better(sample, super().locate(problem, sample, which), _where_curves_cross(problem, sample))

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """Where branches cross for good, of both tangents there that of the curve itself, shape (N + 1,)."""
        bare = located.crossing is None
        return None if bare else Crossing().tangent(problem, located, near)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The coefficients a and b, where branches do not cross for good."""
        bare = located.crossing is None
        return super().form(problem, located, sample) if bare else (KIND, None, {}, NO_DOUBLE_ZERO)

    def value(self, problem: Any, sample: Sample) -> float:
        """The square of the frequency, zero where it is less than what the solution is known to."""
        kappa = float(problem.kappa(sample.z))
        return 0.0 if abs(kappa) <= sample.error * float(sample.weights[problem.plane.size]) else kappa

    def held_beside(self, problem: Any, sample: Sample) -> tuple[int, int]:
        """On the side of the neutral saddles one of both eigenvalues is positive."""
        return (1, 0) if sample.tangent[problem.plane.size] > 0.0 else (0, 1)
