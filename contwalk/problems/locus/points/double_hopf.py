"""Double Hopf points (HH): two imaginary pairs, where two curves of Hopf points cross."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import pair_borders
from contwalk.problems.locus.conditions import Augmented, Pair
from contwalk.problems.locus.curves import HOPF_POINTS
from contwalk.problems.locus.normal_forms import double_hopf_coefficients
from contwalk.problems.locus.points.point import ConditionsMet, LocusPoint, born, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test

# Coefficients of one amplitude of which one is less than this part of the other stand for none.
UNTOLD = 1e-9


def _has_torus(point: SpecialPoint, omega: float) -> bool:
    """Whether the cycles of a frequency have a torus beside the point: their amplitude changes both growths.

    With r1' = r1 (mu1 + p11 r1^2 + ..), r2' = r2 (mu2 + p21 r1^2 + ..) it is at mu2 = p21 mu1 / p11
    (Kuznetsov 2004, section 8.6.2), where neither coefficient vanishes.
    """
    fast = omega == float(point.coefficients["omega_1"])
    own, other = (
        abs(float(point.coefficients[name])) for name in (("p11", "p21") if fast else ("p22", "p12"))
    )
    return min(own, other) > UNTOLD * max(own, other)


class DoubleHopf(LocusPoint):
    """A second pair passes the imaginary axis."""

    label, test, changes = "HH", Test.STABILITY, (-2, 2)

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A complex pair, where the curve's own is imaginary."""
        return bool(sample.eigenvalues[which].imag != 0.0) and problem.genuine(sample.z)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The double Hopf point near a sample."""
        plane = problem.plane
        kappas = [problem.kappa(sample.z), float(sample.eigenvalues[which].imag) ** 2]
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, : plane.size]
        pairs = tuple(Pair(pair_borders(matrix, plane.finite, kappa)) for kappa in kappas)
        return located_by(problem, Augmented(plane, pairs), sample, kappas, positive=True)

    def seeds(self, problem: Any, point: SpecialPoint) -> Iterator[Seed]:
        """The other curve of Hopf points, and the curves of tori of the cycles of both.

        Raises
        ------
        StartError
            After the last, if tori that the normal form has are not found.
        """
        births: Any = import_module("contwalk.problems.locus.births")  # compiled flows, where they are wanted
        z = np.array(point.unknowns)
        frequencies = [float(point.coefficients[name]) for name in ("omega_1", "omega_2")]
        second = max((own**2 for own in frequencies), key=lambda kappa: abs(kappa - problem.kappa(z)))
        yield from born(problem, point, HOPF_POINTS, second)
        missed = []
        for there, own in ((problem, z), problem.other(HOPF_POINTS, z, second)):
            tori = births.tori_of_cycles(there, own)
            yield from tori
            kappa = there.kappa(own)
            omega = min(frequencies, key=lambda each: abs(each**2 - kappa))
            if not tori and _has_torus(point, omega):
                missed.append(omega)
        if missed:
            raise births.tori_not_found(missed)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega of the pair that the curve does not hold."""
        held = float(abs(sample.resting[0].imag)) if len(sample.resting) else 0.0
        both = [float(point.coefficients[name]) for name in ("omega_1", "omega_2")]
        return 1j * max(both, key=lambda omega: abs(omega - held))

    def form(self, problem: Any, located: Located[ConditionsMet], sample: Sample) -> Form:
        """The cubic coefficients of both amplitudes."""
        z = problem.in_plane(located.z)
        return None, None, double_hopf_coefficients(problem.plane, z, located.data.own), None
