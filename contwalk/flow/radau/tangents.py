"""Derivatives of Radau IIA steps, compiled by numba.

The stage equations A^-1 Z = h f(x + Z) are differentiated as they stand, with the Jacobian of each stage: the
derivative of a step is that of the discrete map, to rounding. Imported only where it is compiled.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined
from contwalk.flow.radau.dense_lu import LARGEST, factor, solve
from contwalk.flow.radau.kernel import MOST_PASSES_FROZEN, accept
from contwalk.flow.radau.newton import linearize, solved
from contwalk.flow.radau.parts import (
    Equations,
    Method,
    TangentWork,
    Work,
    equations,
    method,
    radau_call,
    tangent_work,
    work,
)
from contwalk.flow.radau.radau_call import RadauCall


@inlined
def driven(
    eq: Equations, h: float, entries: np.ndarray, x: np.ndarray, q: int, sources: np.ndarray, out: np.ndarray
) -> None:
    """out = h (J x + the derivatives by the parameters that drive the columns)."""
    for i in range(eq.n * q):
        out[i] = 0.0
    for i in range(eq.n):
        target = doubles(out.ctypes.data + 8 * i * q, q)
        for e in range(eq.rows[i], eq.rows[i + 1]):
            column, value = eq.columns[e], h * entries[e]
            if column < eq.n:
                source = doubles(x.ctypes.data + 8 * column * q, q)
                for j in range(q):
                    target[j] += value * source[j]
            else:
                for j in range(q):
                    if sources[j] == column - eq.n:
                        target[j] += value


@inlined
def stage_matrix(eq: Equations, m: Method, h: float, j: int, entries: np.ndarray, matrix: np.ndarray) -> None:
    """The rows of A^-1 x I - h J that belong to stage j: blocks beside the diagonal one are diagonal."""
    n, s = eq.n, m.s
    for k in range(n):
        row = matrix[(j * n + k) * s * n : (j * n + k + 1) * s * n]
        for column in range(s * n):
            row[column] = 0.0
        for i in range(s):
            row[i * n + k] = m.inverse[j * s + i]
        for e in range(eq.rows[k], eq.rows[k + 1]):
            if eq.columns[e] < n:
                row[j * n + eq.columns[e]] -= h * entries[e]


@inlined
def step_tangents(
    eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray, v: TangentWork
) -> bool:
    """Carry the tangents at x over the step whose increments are in w.z."""
    n, s, q = eq.n, m.s, v.q
    for j in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        call_rhs(eq.jac, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, v.jacobian.ctypes.data)
        stage_matrix(eq, m, h, j, v.jacobian[n:], v.matrix)
        moved = doubles(v.moved.ctypes.data + 8 * j * n * q, n * q)
        driven(eq, h, v.jacobian[n:], v.tangents, q, v.sources, moved)
    if not factor(v.matrix, v.row_weights, v.pivots, s * n, LARGEST):
        return False
    solve(v.matrix, v.pivots, s * n, v.moved, q)
    last = doubles(v.moved.ctypes.data + 8 * (s - 1) * n * q, n * q)
    for k in range(n * q):
        v.tangents[k] += last[k]
    return True


def radau_tangents(address: int) -> int:
    """The steps of the grid of a `RadauCall` from x with q tangents, both overwritten; how many were done."""
    call = radau_call(address)
    eq, m, w, v = equations(call), method(call), work(call), tangent_work(call)
    grid, now = doubles(call.times, call.steps + 1), doubles(call.x, call.n)
    before = 0.0
    keep(call, 0, now, v.tangents)
    for step in range(call.steps):
        t = grid[step]
        h = grid[step + 1] - t
        if not linearize(eq, w, t, now):
            return step
        if not solved(eq, m, w, t, h, before, now, MOST_PASSES_FROZEN):
            return step
        if not step_tangents(eq, m, w, t, h, now, v):
            return step
        accept(m, w, call.n, now)
        keep(call, step + 1, now, v.tangents)
        before = h
    return call.steps


@inlined
def keep(call: RadauCall, at: int, x: np.ndarray, tangents: np.ndarray) -> None:
    """Write a node, where nodes are wanted."""
    if call.states != 0:
        node = doubles(call.states + 8 * at * len(x), len(x))
        for k in range(len(x)):
            node[k] = x[k]
    if call.nodes != 0:
        node = doubles(call.nodes + 8 * at * len(tangents), len(tangents))
        for k in range(len(tangents)):
            node[k] = tangents[k]
