"""Folds (LP): F = 0, F_u v = 0, c.v = 1 (Moore & Spence 1980, SIAM J. Numer. Anal. 17, 567)."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.equilibrium.defining_systems import real_eigenvalue
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import Forms, critical_vectors
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.problem import Located, Sample, Test

# Said of a fold whose second eigenvalue has no sign: then nothing tells whether a pair crosses beside it.
SECOND = (
    "a second eigenvalue is zero to what it is known to, as at a Bogdanov-Takens point: "
    "a Hopf point this near to the fold is not told apart from it"
)


class Fold(EquilibriumPoint):
    """The branch turns back in the parameter."""

    label, test, changes = "LP", Test.TURN, (-1, 1)

    def locate(self, problem: EquilibriumEquations, sample: Sample, which: int) -> Located | None:
        """The fold near a sample."""
        return real_eigenvalue(problem, sample, shift=None)

    def form(self, problem: EquilibriumEquations, located: Located, sample: Sample) -> Form:
        """The coefficients of y' = b mu + a y^2."""
        zeros = np.abs(sample.eigenvalues - sample.critical) <= sample.errors
        note = SECOND if np.count_nonzero(zeros) > 1 else None
        return None, None, fold_coefficients(problem, located), note


def fold_coefficients(problem: EquilibriumEquations, located: Located) -> dict[str, Any]:
    """a = p.B(q, q) / 2 of the normal form y' = b mu + a y^2 (Kuznetsov 2004, eq. 5.20 and section 3.3).

    `b` = p.f_lambda, mu being the free parameter minus its value at the fold.
    """
    jacobian = problem.jacobian(located.z)
    q, p = critical_vectors(problem, located.z)
    forms = Forms(problem, located.z)
    return {
        "a": 0.5 * float(p @ forms.second(q, q)),
        "b": float(p @ jacobian[:, -1]),
        "convention": "y' = b mu + a y^2, a = p.B(q,q)/2, |q| = 1, p.q = 1 (Kuznetsov 2004, section 5.4)",
    }
