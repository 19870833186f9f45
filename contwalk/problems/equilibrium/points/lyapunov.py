"""The first Lyapunov coefficient of a Hopf point, along any of its critical vectors.

Where a symmetry makes several pairs of eigenvalues pass at once there is a space of critical vectors, and
each of them has a coefficient of its own: its left vector is zero on the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.numerics.linear import nearest_eigenpair
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.normal_forms import Forms
from contwalk.problems.kept_spaces import SAME

# Eigenvalues are one that differ by less than this part of the frequency.
ALIKE = 1e-7


@dataclass(frozen=True)
class CriticalSpace:
    """The eigenvectors of i omega: orthonormal columns, (n, k), and rows that are dual to them, (k, n).

    Of one vector alone the row is not scaled.
    """

    right: np.ndarray
    left: np.ndarray

    def dual(self, q: np.ndarray) -> np.ndarray:
        """The left vector p of a critical vector, both (n,): zero on what is at a right angle to it."""
        if len(self.left) == 1:
            return self.left[0]
        shares = self.right.conj().T @ q
        p: np.ndarray = shares.conj() @ self.left / float(np.vdot(shares, shares).real)
        return p


def critical_space(a: np.ndarray, omega: float) -> CriticalSpace:
    """The space of a pair i omega of a matrix, shape (n, n): one vector, but for symmetries."""
    values, vectors = np.linalg.eig(a)
    near = np.abs(values - 1j * omega) < ALIKE * abs(omega)
    several = np.count_nonzero(near)
    if several > 1:
        transposed, rows = np.linalg.eig(a.T)
        below = np.abs(transposed - 1j * omega) < ALIKE * abs(omega)
    if several > 1 and several == np.count_nonzero(below):
        space, sizes, _ = np.linalg.svd(vectors[:, near], full_matrices=False)
        right, left = space[:, sizes > SAME * sizes[0]], rows[:, below].T
        product = left @ right
        seen = np.linalg.svd(product, compute_uv=False)
        if product.shape[0] == product.shape[1] and seen[-1] > SAME * seen[0]:
            return CriticalSpace(right, np.linalg.solve(product, left))
    pair = nearest_eigenpair(a, 1j * omega)
    return CriticalSpace(pair.right[:, None], pair.left[None, :])


@dataclass(frozen=True)
class Lyapunov:
    """l1, the size of its terms, and its vectors q and p, shape (n,), <q, q> = 1, <p, q> = 1."""

    l1: float
    size: float
    right: np.ndarray
    left: np.ndarray


def lyapunov(problem: EquilibriumEquations, z: np.ndarray, omega: float, q: np.ndarray) -> Lyapunov:
    """The coefficient along a critical vector q of unit length (Kuznetsov 2004, eq. 5.34).

    l1 = Re[<p, C(q,q,q*)> - 2 <p, B(q, A^-1 B(q,q*))> + <p, B(q*, (2 i w - A)^-1 B(q,q))>] / (2 w).
    Where neutral directions are pinned, A is singular along the family and A^-1 is taken with the pin in
    place.
    """
    n = problem.states
    a = problem.jacobian(z)[:n, :n]
    p = critical_space(a, omega).dual(q)
    p = p / (p @ q)
    forms = Forms(problem, z)
    h11 = problem.solve_states(z, forms.second(q, np.conj(q))[:n])
    h20 = np.linalg.solve(2j * omega * np.eye(n) - a, forms.second(q, q)[:n])
    terms = [
        forms.third(q, q, np.conj(q))[:n],
        -2.0 * forms.second(q, h11)[:n],
        forms.second(np.conj(q), h20)[:n],
    ]
    total = sum(p @ term for term in terms)
    size = sum(float(np.abs(p) @ np.abs(term)) for term in terms)
    return Lyapunov(float(total.real) / (2.0 * omega), size / (2.0 * omega), q, p)
