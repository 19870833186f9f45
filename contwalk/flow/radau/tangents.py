"""Derivatives of Radau IIA steps, compiled by numba.

The stage equations A^-1 Z = h f(x + Z) are differentiated as they stand, with the Jacobian of each stage: the
derivative of a step is that of the discrete map, to rounding. Imported only where it is compiled.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined, integers
from contwalk.flow.radau.dense_lu import factor, solve
from contwalk.flow.radau.kernel import MOST_PASSES_FROZEN, accept
from contwalk.flow.radau.newton import CONVERGED, iterate, linearize, predict
from contwalk.flow.radau.parts import Equations, Method, Work, equations, method, work


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
    eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray, tangents: np.ndarray, q: int,
    sources: np.ndarray, matrix: np.ndarray, pivots: np.ndarray, row_weights: np.ndarray,
    jacobian: np.ndarray, moved: np.ndarray,
) -> bool:  # fmt: skip
    """Carry the tangents at x over the step whose increments are in w.z."""
    n, s = eq.n, m.s
    for j in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        call_rhs(eq.jac, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, jacobian.ctypes.data)
        stage_matrix(eq, m, h, j, jacobian[n:], matrix)
        driven(eq, h, jacobian[n:], tangents, q, sources, doubles(moved.ctypes.data + 8 * j * n * q, n * q))
    if not factor(matrix, row_weights, pivots, s * n):
        return False
    solve(matrix, pivots, s * n, moved, q)
    last = doubles(moved.ctypes.data + 8 * (s - 1) * n * q, n * q)
    for k in range(n * q):
        tangents[k] += last[k]
    return True


def radau_tangents(
    rhs: int, jac: int, n: int, rows: int, columns: int, entries: int, c: int, constants: int,
    tableau: int, numbers: int, s: int, times: int, steps: int, x: int, columns_in: int, q: int, sources: int,
    states: int, nodes: int, scratch: int, size: int, pivots: int, pivot_size: int,
) -> int:  # fmt: skip
    """The steps of a grid from x with q tangents, both overwritten; how many steps could be done.

    `states` (steps + 1, n) and `nodes` (steps + 1, n, q) are written unless their address is 0.
    """
    eq = equations(rhs, jac, n, rows, columns, entries, c, constants)
    m = method(doubles(tableau, numbers), s)
    room, slots = doubles(scratch, size), integers(pivots, pivot_size)
    w = work(room, slots, n, s, entries)
    sn, nq = s * n, n * q
    a = size - (sn * sn + sn + n + entries + sn * q)
    matrix, row_weights = room[a : a + sn * sn], room[a + sn * sn : a + sn * sn + sn]
    a += sn * sn + sn
    jacobian, moved = room[a : a + n + entries], room[size - sn * q :]
    grid, now, tangent = doubles(times, steps + 1), doubles(x, n), doubles(columns_in, nq)
    driving = integers(sources, q)
    before = 0.0
    keep(states, nodes, 0, now, tangent, n, nq)
    for step in range(steps):
        t = grid[step]
        h = grid[step + 1] - t
        if not linearize(eq, w, t, now):
            return step
        predict(eq, m, w, h, before)
        if iterate(eq, m, w, t, h, now, MOST_PASSES_FROZEN)[0] != CONVERGED:
            return step
        if not step_tangents(
            eq, m, w, t, h, now, tangent, q, driving, matrix, slots[pivot_size - sn :], row_weights,
            jacobian, moved,
        ):  # fmt: skip
            return step
        accept(m, w, n, now)
        keep(states, nodes, step + 1, now, tangent, n, nq)
        before = h
    return steps


@inlined
def keep(states: int, nodes: int, at: int, x: np.ndarray, tangent: np.ndarray, n: int, nq: int) -> None:
    """Write a node, where nodes are wanted."""
    if states != 0:
        node = doubles(states + 8 * at * n, n)
        for k in range(n):
            node[k] = x[k]
    if nodes != 0:
        node = doubles(nodes + 8 * at * nq, nq)
        for k in range(nq):
            node[k] = tangent[k]
