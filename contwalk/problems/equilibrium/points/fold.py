"""Folds (LP): F = 0, F_u v = 0, c.v = 1 (Moore & Spence 1980, SIAM J. Numer. Anal. 17, 567)."""

from __future__ import annotations

from typing import Any

from contwalk.problems.equilibrium.defining_systems import real_eigenvalue
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import Forms, critical_vectors
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.problem import Located, Sample, Test


class Fold(EquilibriumPoint):
    """The branch turns back in the parameter."""

    label, test, changes = "LP", Test.TURN, (-1, 1)

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The fold near a sample."""
        return real_eigenvalue(problem, sample, shift=None)

    def form(self, problem: EquilibriumEquations, located: Located, sample: Sample) -> Form:
        """The coefficients of y' = b mu + a y^2."""
        return None, None, fold_coefficients(problem, located), None


def fold_coefficients(problem: EquilibriumEquations, located: Located) -> dict[str, Any]:
    """a = p.B(q, q) / 2 of the normal form y' = b mu + a y^2 (Kuznetsov 2004, eq. 5.20 and section 3.3).

    `b` = p.f_lambda, mu being the free parameter minus its value at the fold.
    """
    jacobian = problem.jacobian(located.z)
    q, p = critical_vectors(jacobian[:, : problem.size])
    forms = Forms(problem, located.z)
    return {
        "a": 0.5 * float(p @ forms.second(q, q)),
        "b": float(p @ jacobian[:, -1]),
        "convention": "y' = b mu + a y^2, a = p.B(q,q)/2, |q| = 1, p.q = 1 (Kuznetsov 2004, section 5.4)",
    }
