"""The embedded error estimate of a Radau IIA step, compiled by numba."""

from __future__ import annotations

import numpy as np

from contwalk.flow.calling import call_rhs, inlined
from contwalk.flow.dense_lu import solve
from contwalk.flow.radau_parts import Equations, Method, Work


@inlined
def embedded(eq: Equations, m: Method, w: Work, h: float, x: np.ndarray, weights: np.ndarray) -> float:
    """Norm of the difference to the embedded formula, filtered by (I - h J / mu)^-1; left in w.y."""
    n, s = eq.n, m.s
    for k in range(n):
        total = 0.0
        for i in range(s):
            total += m.error[i] * w.z[i * n + k]
        w.v[k] = total * (m.mu / h)
        w.y[k] = w.out[k] + w.v[k]
    solve(w.lu, w.pivots, n, w.y, 1)
    return norm(w.y, weights, n)


@inlined
def embedded_again(eq: Equations, m: Method, w: Work, t: float, x: np.ndarray, weights: np.ndarray) -> float:
    """The same filtered once more, from x + error: for steps that begin off a stiff solution's smooth part."""
    n = eq.n
    for k in range(n):
        w.state[k] = x[k] + w.y[k]
    call_rhs(eq.rhs, t, w.state.ctypes.data, eq.c.ctypes.data, w.y.ctypes.data)
    for k in range(n):
        w.y[k] += w.v[k]
    solve(w.lu, w.pivots, n, w.y, 1)
    return norm(w.y, weights, n)


@inlined
def norm(y: np.ndarray, weights: np.ndarray, n: int) -> float:
    """Root mean square in units of the weights."""
    total = 0.0
    for k in range(n):
        total += (y[k] / weights[k]) ** 2
    return np.sqrt(total / n)
