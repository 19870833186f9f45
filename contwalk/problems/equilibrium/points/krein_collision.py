"""Krein collisions of equilibria (HB): the Hamiltonian Hopf bifurcation."""

from __future__ import annotations

from contwalk.branch import SpecialPoint
from contwalk.numerics import krein
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.problem import Located, Sample, Test

NOTE = (
    "Krein collision: two pairs of eigenvalues meet on the imaginary axis and leave it as a quadruple "
    "(Hamiltonian Hopf); Lyapunov coefficients of dissipative motions say nothing there, and the cycles "
    "beside it are not followed"
)


class KreinCollision(EquilibriumPoint):
    """Two pairs of imaginary eigenvalues meet and leave the axis."""

    label, test, changes, along, daughters = "HB", Test.STABILITY, (-2, 2), True, 0

    def tells(self, problem: EquilibriumEquations, sample: Sample, which: int) -> bool:
        """A quadruple, of eigenvalues that come as lambda and -lambda."""
        values = sample.eigenvalues
        return (
            bool(values[which].imag != 0.0)
            and krein.hamiltonian(values)
            and self.value(problem, sample) < 0.0
        )

    def value(self, problem: EquilibriumEquations, sample: Sample) -> float:
        """How far two pairs are apart: positive on the axis, negative of a quadruple."""
        return krein.parted(sample.eigenvalues, sample.eigenvalues**2)

    def form(self, problem: EquilibriumEquations, located: Located, sample: Sample) -> Form:
        """The frequency at which the pairs meet."""
        omega = abs(float(sample.eigenvalues[located.which].imag))
        return None, None, {"omega": omega, "pairs": 2}, NOTE

    def has(self, point: SpecialPoint) -> bool:
        """A stored point of two pairs."""
        return point.label == self.label and "pairs" in point.coefficients

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """i omega."""
        return 1j * float(point.coefficients["omega"])
