"""Zero-Hopf points (ZH): a zero eigenvalue and an imaginary pair, on curves of folds and of Hopf points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import pair_borders, zero_borders
from contwalk.problems.locus.conditions import Augmented, Pair, Zero
from contwalk.problems.locus.curves import FOLDS, HOPF_POINTS
from contwalk.problems.locus.normal_forms import zero_hopf_coefficients
from contwalk.problems.locus.points.crossing import NO_DOUBLE_ZERO, Crossing, at_zero, located_by_units
from contwalk.problems.locus.points.persisting import KIND, NOTE, better, branch_point, persists
from contwalk.problems.locus.points.point import ConditionsMet, LocusPoint, born, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test


class ZeroHopf(LocusPoint):
    """A fold at which a pair passes the imaginary axis, or a Hopf point at which a real one passes zero."""

    label, test = "ZH", Test.STABILITY

    def frequency_squared(self, problem: Any, sample: Sample, which: int) -> float:
        """Of the pair, near a sample."""
        raise NotImplementedError

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The zero-Hopf point near a sample."""
        plane, kappa = problem.plane, self.frequency_squared(problem, sample, which)
        if not kappa > 0.0:
            return None
        z = problem.in_plane(sample.z)
        matrix = plane.jacobian(z)[:, : plane.size]
        pair = Pair(pair_borders(matrix, plane.finite, kappa))
        both = Augmented(plane, (pair, Zero(zero_borders(matrix))))
        found = located_by(problem, both, sample, [kappa], positive=True)
        return better(sample, found, _where_curves_cross(problem, sample, kappa))

    def form(self, problem: Any, located: Located[ConditionsMet], sample: Sample) -> Form:
        """s, theta and the sign of E."""
        kappa = located.data.own[0]
        numbers = zero_hopf_coefficients(problem.plane, problem.in_plane(located.z), kappa)
        return (KIND, None, numbers, NOTE) if persists(located) else (None, None, numbers, None)


def _tori(problem: Any, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of tori that is born at a zero-Hopf point, of the curve of Hopf points that z is on.

    There is one where f011 and the real part of g110 have opposite signs (Kuznetsov 2004, section 8.5), not
    at branch points. z has the shape (N + 1,).

    Raises
    ------
    StartError
        If it is not found where there is one.
    """
    form = point.coefficients
    if point.kind == KIND or "theta" not in form or not form["f011"] * form["g110_real"] < 0.0:
        return ()
    births: Any = import_module("contwalk.problems.locus.births")  # compiled flows, where they are wanted
    found: Sequence[Seed] = births.tori_of_cycles(problem, z, (1.0, -1.0))
    if not found:
        raise births.tori_not_found([float(form["omega"])])
    return found


def _where_curves_cross(problem: Any, sample: Sample, kappa: float) -> Located | None:
    """The point near a sample at which a branch point that persists has a pair."""
    plane = problem.plane
    matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
    pair = Pair(pair_borders(matrix, plane.finite, kappa))
    crossing = Augmented(plane, (pair, branch_point(problem, sample)))
    return located_by(problem, crossing, sample, [kappa, 0.0], positive=True)


class PairOnFold(ZeroHopf):
    """On a curve of folds."""

    changes = (-2, 2)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A complex pair."""
        return bool(sample.eigenvalues[which].imag != 0.0)

    def seeds(self, problem: Any, point: SpecialPoint) -> Iterator[Seed]:
        """The curve of Hopf points, and that of tori of its cycles; raises what `_tori` does, at last."""
        kappa = float(point.coefficients["omega"]) ** 2
        there, z = problem.other(HOPF_POINTS, np.array(point.unknowns), kappa)
        yield from born(problem, point, HOPF_POINTS, kappa)
        yield from _tori(there, z, point)

    def frequency_squared(self, problem: Any, sample: Sample, which: int) -> float:
        """Of the pair that passes."""
        return float(sample.eigenvalues[which].imag) ** 2

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega."""
        return 1j * float(point.coefficients["omega"])


class PairOnBranchPoint(PairOnFold):
    """On a curve of branch points."""

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample, where the branch point is one still."""
        plane, kappa = problem.plane, self.frequency_squared(problem, sample, which)
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        conditions = (*problem.augmented.conditions, Pair(pair_borders(matrix, plane.finite, kappa)))
        own = [problem.own(sample.z), kappa]
        return located_by(problem, Augmented(plane, conditions), sample, own, positive=True)

    def form(self, problem: Any, located: Located[ConditionsMet], sample: Sample) -> Form:
        """The frequency: the normal form is that of the symmetry."""
        omega = located.data.own[-1] ** 0.5
        note = "no normal form: that of zero-Hopf points is not the one at branch points"
        return None, None, {"omega": omega}, note


class ZeroOnHopf(ZeroHopf):
    """On a curve of Hopf points."""

    changes = (-1, 1)

    def has(self, point: SpecialPoint) -> bool:
        """A zero-Hopf point that a curve of folds passes."""
        return point.label == self.label and point.kind != KIND

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real eigenvalue, where the curve's own pair is imaginary."""
        return bool(sample.eigenvalues[which].imag == 0.0) and problem.genuine(sample.z)

    def seeds(self, problem: Any, point: SpecialPoint) -> Iterator[Seed]:
        """The curve of folds, and that of tori of the cycles; raises what `_tori` does, at last."""
        yield from born(problem, point, FOLDS)
        yield from _tori(problem, np.array(point.unknowns), point)

    def frequency_squared(self, problem: Any, sample: Sample, which: int) -> float:
        """Of the curve's own pair."""
        return float(problem.kappa(sample.z))


class ZeroWhereCurvesCross(Crossing):
    """On a curve of Hopf points: at a branch point that persists, that of the other branch crosses."""

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The zero-Hopf point near a sample, or a crossing of neutral saddles."""
        kappa = float(problem.kappa(sample.z))
        found = _where_curves_cross(problem, sample, kappa) if kappa > 0.0 else None
        return found or super().locate(problem, sample, which) or located_by_units(problem, sample)

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a zero-Hopf point; of neutral saddles that of a crossing.

        Where the curve of the branch beside comes to the double zero, its pair is zero there and on no side
        of it a saddle's.
        """
        kappa = float(problem.kappa(located.z))
        if at_zero(problem, located, sample):
            record = super().describe(problem, located, sample, s)
            return replace(record, label="BT", kind=KIND, note=NO_DOUBLE_ZERO)
        if not kappa > 0.0:
            return super().describe(problem, located, sample, s)
        met = ConditionsMet(problem.augmented, [kappa])
        record = ZeroOnHopf().describe(problem, replace(located, data=met), sample, s)
        return replace(record, kind=KIND, note=NOTE)

    def has(self, point: SpecialPoint) -> bool:
        """A crossing, told as one or as the zero-Hopf point that it is."""
        return super().has(point) or (point.label == "ZH" and point.kind == KIND)
