"""Error estimates of a Radau IIA step, compiled by numba.

Two of them, because the error has two laws. The embedded formula (`embedded`) is of order s only. Where
nothing is stiff the error falls like h^(2 s), and is found from the estimate by that power
(`radau.measured`). Where the field is stiff, the order is that of the stages, and the error is as large as
the estimate times what the method makes of a defect with h J = z: K z^(s-1) / det(1 - z A), which is
negligible for small z and not for moderate ones (`propagated`).
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, inlined
from contwalk.flow.radau.dense_lu import solve, solve_complex
from contwalk.flow.radau.parts import Equations, Method, Work


@inlined
def estimated(eq: Equations, m: Method, w: Work, h: float, weights: np.ndarray) -> tuple[float, float]:
    """Norms of the embedded estimate and of what the method makes of it; the former is left in w.y."""
    embedded(eq, m, w, h)
    return norm(w.y, weights, eq.n), propagated(eq, m, w, h, weights)


@inlined
def estimated_again(
    eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray, weights: np.ndarray
) -> tuple[float, float]:
    """The same filtered once more, from x + error: for steps that begin off the smooth motion."""
    n = eq.n
    for k in range(n):
        w.state[k] = x[k] + w.y[k]
    call_rhs(eq.rhs, t, w.state.ctypes.data, eq.c.ctypes.data, w.y.ctypes.data)
    for k in range(n):
        w.y[k] += w.v[k]
    solve(w.lu, w.pivots, n, w.y, 1)
    return norm(w.y, weights, n), propagated(eq, m, w, h, weights)


@inlined
def embedded(eq: Equations, m: Method, w: Work, h: float) -> None:
    """w.y = difference to the embedded formula, filtered by (I - h J / mu)^-1."""
    n, s = eq.n, m.s
    for k in range(n):
        total = 0.0
        for i in range(s):
            total += m.error[i] * w.z[i * n + k]
        w.v[k] = total * (m.mu / h)
        w.y[k] = w.out[k] + w.v[k]
    solve(w.lu, w.pivots, n, w.y, 1)


@inlined
def propagated(eq: Equations, m: Method, w: Work, h: float, weights: np.ndarray) -> float:
    """Norm of K z^(s-1) / det(1 - z A) of a defect of which w.y is 1 / (1 - z / mu).

    Each pair mu of eigenvalues contributes z^2 / |mu - z|^2 = 1 - 2 Re(a / (mu - z)), a = mu^2 / (2 i Im mu).
    """
    n, size = eq.n, eq.n * eq.n
    for k in range(n):
        w.delta[k] = w.y[k]
    for p in range((m.s - 1) // 2):
        u, v = m.pairs[p * (2 + 4 * m.s)], m.pairs[p * (2 + 4 * m.s) + 1]
        for k in range(n):
            w.state[k], w.residual[k] = w.delta[k] / h, 0.0
        real = w.complex_lu[2 * p * size : (2 * p + 1) * size]
        imaginary = w.complex_lu[(2 * p + 1) * size : (2 * p + 2) * size]
        solve_complex(real, imaginary, w.complex_pivots[p * n : (p + 1) * n], n, w.state, w.residual)
        a, b = u, 0.5 * (v * v - u * u) / v
        for k in range(n):
            w.delta[k] -= 2.0 * (a * w.state[k] - b * w.residual[k])
    return m.linear * norm(w.delta, weights, n)


@inlined
def norm(y: np.ndarray, weights: np.ndarray, n: int) -> float:
    """Root mean square in units of the weights."""
    total = 0.0
    for k in range(n):
        total += (y[k] / weights[k]) ** 2
    return np.sqrt(total / n)
