"""Normal forms of equilibria by finite differences of the record's own equations.

Notation and formulas of Yu. A. Kuznetsov, Elements of Applied Bifurcation Theory, 2004, section 5.4;
derivatives of the Jacobian are central differences at two steps, the smaller of which loses as much to
rounding as to its order.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.normal_forms import NODES, Told, bordered, critical, shares, widest

Form = Callable[["Bent"], float]


class Bent:
    """The field across what is pinned, with derivatives of its Jacobian.

    Parameters
    ----------
    equations : EquilibriumEquations
    z : ndarray, shape (N + k,)
    step : float
        Of differences, in sizes of the states.

    Raises
    ------
    CannotTell
        If pinned directions are not straight.
    """

    def __init__(self, equations: EquilibriumEquations, z: np.ndarray, step: float) -> None:
        self.equations, self.z, self.step, self.n = equations, z, step, equations.size
        self.sizes = equations.sizes[: self.n]
        self.across = equations.across(z)
        self.fixed = equations.fixed(z, self.across)
        self.matrix = self.at(np.zeros(self.across.shape[1]))
        self.by_free = self.across.T @ equations.at(z, 0.0).jacobian[: self.n, self.n :]

    def at(self, moved: np.ndarray) -> np.ndarray:
        """The Jacobian at a place beside, both in coordinates across: shapes (r,) and (r, r)."""
        z = self.z.copy()
        z[: self.n] += self.across @ moved
        matrix = self.equations.at(z, 0.0).jacobian[: self.n, : self.n]
        return np.asarray(self.across.T @ matrix @ self.across)

    def unit(self, q: np.ndarray) -> np.ndarray:
        """q, (r,), so long that the states that it moves, those along what is pinned as well, are."""
        return np.asarray(q / np.linalg.norm(self.fixed @ q))

    def _length(self, u: np.ndarray) -> float:
        return self.step / max(float(np.max(np.abs(self.across @ u) / self.sizes)), 1e-300)

    def first(self, u: np.ndarray) -> np.ndarray:
        """B(u, .) of a real or complex direction, shape (r, r)."""
        if np.iscomplexobj(u):
            return self.first(u.real) + 1j * self.first(u.imag)
        if not u.any():
            return np.zeros_like(self.matrix)
        return self._differences(u, 1)

    def second(self, u: np.ndarray) -> np.ndarray:
        """C(u, u, .) of a real direction, shape (r, r)."""
        return self._differences(u, 2)

    def _differences(self, u: np.ndarray, order: int) -> np.ndarray:
        """A derivative of the Jacobian along a direction, shape (r, r)."""
        h = self._length(u)
        values = [self.at(k * h * u) if k else self.matrix for k in NODES]
        return np.asarray(np.tensordot(shares(order), np.array(values), 1)) / h**order


def told(equations: EquilibriumEquations, z: np.ndarray, form: Form) -> Told:
    """A coefficient at z, shape (N + k,), and how exactly differences tell it."""
    values = [form(Bent(equations, z, times * widest())) for times in (1.0, 0.5)]
    return Told(values[1], abs(values[1] - values[0]))


def lyapunov(omega: float) -> Form:
    """The first Lyapunov coefficient of a Hopf point (eq. 5.34, with <q, q> = <p, q> = 1)."""

    def form(bent: Bent) -> float:
        matrix = bent.matrix
        q, p = _vector(matrix, 1j * omega), _vector(matrix.T, -1j * omega)
        q = bent.unit(q)
        p = p / np.conj(np.vdot(p, q))
        a, b = q.real, q.imag
        cubic = bent.second(a) - bent.second(b) + 0.5j * (bent.second(a + b) - bent.second(a - b))
        by_q, bar = bent.first(q), np.conj(q)
        mean = np.linalg.solve(matrix, by_q @ bar)
        twice = np.linalg.solve(2j * omega * np.eye(len(matrix)) - matrix, by_q @ q)
        whole = cubic @ bar - 2.0 * by_q @ mean + np.conj(by_q) @ twice
        return float(np.vdot(p, whole).real) / (2.0 * omega)

    return form


def pitchfork(bent: Bent) -> float:
    """c of y' = c y^3 along the critical vector, |q| = 1, p.q = 1."""
    q, p = critical(bent.matrix, 0j)
    q, p = (unit := bent.unit(q)), p / (p @ unit)
    by_q = bent.first(q)
    h = bordered(bent.matrix, q, p, by_q @ q)
    return float(p @ (bent.second(q) @ q - 3.0 * by_q @ h)) / 6.0


def fold(bent: Bent) -> float:
    """a b of y' = b mu + a y^2, which no length of q changes."""
    q, p = critical(bent.matrix, 0j)
    return 0.5 * float(p @ bent.first(q) @ q) * float(p @ bent.by_free[:, 0])


def _vector(matrix: np.ndarray, value: complex) -> np.ndarray:
    """The eigenvector of the eigenvalue nearest to a value."""
    values, vectors = np.linalg.eig(matrix)
    return np.asarray(vectors[:, int(np.argmin(np.abs(values - value)))])
