"""Double Hopf points (HH): two imaginary pairs, where two curves of Hopf points cross."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import pair_borders
from contwalk.problems.locus.conditions import Augmented, Pair
from contwalk.problems.locus.curves import HOPF_POINTS
from contwalk.problems.locus.normal_forms import double_hopf_coefficients
from contwalk.problems.locus.points.point import LocusPoint, born, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test


class DoubleHopf(LocusPoint):
    """A second pair passes the imaginary axis."""

    label, test, changes = "HH", Test.STABILITY, (-2, 2)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A complex pair, where the curve's own is imaginary."""
        return bool(sample.eigenvalues[which].imag != 0.0) and problem.kappa(sample.z) > 0.0

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double Hopf point near a sample."""
        plane = problem.plane
        kappas = [problem.kappa(sample.z), float(sample.eigenvalues[which].imag) ** 2]
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        pairs = tuple(Pair(pair_borders(matrix, plane.finite, kappa)) for kappa in kappas)
        return located_by(problem, Augmented(plane, pairs), sample, kappas, positive=True)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The other curve of Hopf points, and the curves of tori of the cycles of both."""
        births: Any = import_module("contwalk.problems.locus.births")  # compiled flows, where they are wanted
        z = np.array(point.unknowns)
        kappas = [float(point.coefficients[name]) ** 2 for name in ("omega_1", "omega_2")]
        second = max(kappas, key=lambda kappa: abs(kappa - problem.kappa(z)))
        both = [(problem, z), problem.other(HOPF_POINTS, z, second)]
        tori = [seed for own in both for seed in births.tori_of_cycles(*own)]
        return [*born(problem, point, HOPF_POINTS, second), *tori]

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega of the pair that the curve does not hold."""
        held = float(abs(sample.resting[0].imag)) if len(sample.resting) else 0.0
        both = [float(point.coefficients[name]) for name in ("omega_1", "omega_2")]
        return 1j * max(both, key=lambda omega: abs(omega - held))

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficients of both amplitudes."""
        kappas = tuple(float(kappa) for kappa in located.vectors["own"])
        return None, None, double_hopf_coefficients(problem.plane, problem.in_plane(located.z), kappas), None
