"""Normal forms by finite differences of the record's own equations."""

from __future__ import annotations

import numpy as np

from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.passage import EPSILON


def lyapunov(equations: EquilibriumEquations, z: np.ndarray, omega: float) -> tuple[float, float]:
    """The first Lyapunov coefficient of a Hopf point z, (N + k,), and how exactly differences tell it.

    Kuznetsov 2004, eq. 5.34, with <q, q> = <p, q> = 1. Derivatives of the Jacobian are central differences at
    two steps, the smaller of which loses as much to rounding as to its order.
    """
    values = [_lyapunov(equations, z, omega, times * EPSILON**0.25) for times in (1.0, 2.0)]
    return values[0], abs(values[1] - values[0])


def _lyapunov(equations: EquilibriumEquations, z: np.ndarray, omega: float, step: float) -> float:
    n, sizes = equations.size, equations.sizes[: equations.size]

    def jacobian(moved: np.ndarray) -> np.ndarray:
        return equations.at(np.concatenate([z[:n] + moved, z[n:]]), 0.0).jacobian[:n, :n]

    def unit(u: np.ndarray) -> float:
        return step / max(float(np.max(np.abs(u / sizes))), 1e-300)

    def first(u: np.ndarray) -> np.ndarray:
        """The Jacobian's derivative along a real direction."""
        if not u.any():
            return np.zeros((n, n))
        h = unit(u)
        return (jacobian(h * u) - jacobian(-h * u)) / (2.0 * h)

    def second(u: np.ndarray) -> np.ndarray:
        h = unit(u)
        return (jacobian(h * u) - 2.0 * matrix + jacobian(-h * u)) / (h * h)

    def along(u: np.ndarray) -> np.ndarray:
        return first(u.real) + 1j * first(u.imag)

    matrix = jacobian(np.zeros(n))
    q, p = _vector(matrix, 1j * omega), _vector(matrix.T, -1j * omega)
    q = q / np.linalg.norm(q)
    p = p / np.conj(np.vdot(p, q))
    a, b = q.real, q.imag
    cubic = second(a) - second(b) + 0.5j * (second(a + b) - second(a - b))
    by_q, bar = along(q), np.conj(q)
    mean = np.linalg.solve(matrix, by_q @ bar)
    twice = np.linalg.solve(2j * omega * np.eye(n) - matrix, by_q @ q)
    whole = cubic @ bar - 2.0 * by_q @ mean + np.conj(by_q) @ twice
    return float(np.vdot(p, whole).real) / (2.0 * omega)


def _vector(matrix: np.ndarray, value: complex) -> np.ndarray:
    """The eigenvector of the eigenvalue nearest to a value."""
    values, vectors = np.linalg.eig(matrix)
    return np.asarray(vectors[:, int(np.argmin(np.abs(values - value)))])
