"""Folds (LP) and Hopf points (HB) on curves of marked values: where stability changes along them."""

from __future__ import annotations

from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import pair_borders, zero_borders
from contwalk.problems.locus.conditions import Augmented, Pair, Zero
from contwalk.problems.locus.normal_forms import hopf_coefficients
from contwalk.problems.locus.points.point import ConditionsMet, LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Test


class FoldOnIt(LocusPoint):
    """A real eigenvalue passes zero: the curve crosses one of folds."""

    label, test, changes = "LP", Test.STABILITY, (-1, 1)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real eigenvalue."""
        return bool(sample.eigenvalues[which].imag == 0.0)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The fold on the curve near a sample."""
        plane = problem.plane
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        conditions = (*problem.augmented.conditions, Zero(zero_borders(matrix)))
        own = [problem.own(sample.z)] * problem.curve.own
        return located_by(problem, Augmented(plane, conditions), sample, own)


class HopfOnIt(LocusPoint):
    """A complex pair passes the imaginary axis: the curve crosses one of Hopf points."""

    label, test, changes = "HB", Test.STABILITY, (-2, 2)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A complex pair."""
        return bool(sample.eigenvalues[which].imag != 0.0)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The Hopf point on the curve near a sample."""
        plane, kappa = problem.plane, float(sample.eigenvalues[which].imag) ** 2
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        conditions = (*problem.augmented.conditions, Pair(pair_borders(matrix, plane.finite, kappa)))
        own = [problem.own(sample.z)] * problem.curve.own
        return located_by(problem, Augmented(plane, conditions), sample, [*own, kappa], positive=True)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega."""
        return 1j * float(point.coefficients["omega"])

    def form(self, problem: Any, located: Located[ConditionsMet], sample: Sample) -> Form:
        """The first Lyapunov coefficient, and the side to which cycles are born."""
        numbers = hopf_coefficients(problem.plane, problem.in_plane(located.z), located.data.own[-1])
        criticality = (
            "supercritical" if numbers["l1"] < 0.0 else "subcritical" if numbers["l1"] > 0.0 else None
        )
        return None, criticality, numbers, None
