"""Derivatives of Radau IIA steps, compiled by numba.

The stage equations Z = h A f(x + Z) are differentiated as they stand, with the Jacobian of each stage: the
derivative of a step is that of the discrete map, to rounding. Imported only where it is compiled.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.calling import call_rhs, doubles, inlined, integers
from contwalk.flow.dense_lu import factor, solve
from contwalk.flow.radau_kernel import MOST_PASSES_FROZEN, accept, equations
from contwalk.flow.radau_step import (
    CONVERGED,
    Equations,
    Method,
    Work,
    iterate,
    linearize,
    method,
    predict,
    work,
)


@inlined
def driven(
    eq: Equations, entries: np.ndarray, x: np.ndarray, q: int, sources: np.ndarray, out: np.ndarray
) -> None:
    """out = J x + the derivatives by the parameters that drive the columns."""
    for i in range(eq.n * q):
        out[i] = 0.0
    for i in range(eq.n):
        for e in range(eq.rows[i], eq.rows[i + 1]):
            column, value = eq.columns[e], entries[e]
            if column < eq.n:
                for j in range(q):
                    out[i * q + j] += value * x[column * q + j]
            else:
                for j in range(q):
                    if sources[j] == column - eq.n:
                        out[i * q + j] += value


@inlined
def stage_matrix(eq: Equations, m: Method, h: float, j: int, entries: np.ndarray, matrix: np.ndarray) -> None:
    """The columns of I - h A x J that belong to stage j."""
    n, s = eq.n, m.s
    for i in range(s):
        a = h * m.matrix[i * s + j]
        for k in range(n):
            row = matrix[(i * n + k) * s * n + j * n : (i * n + k) * s * n + (j + 1) * n]
            for column in range(n):
                row[column] = 0.0
            for e in range(eq.rows[k], eq.rows[k + 1]):
                if eq.columns[e] < n:
                    row[eq.columns[e]] = -a * entries[e]
            if i == j:
                row[k] += 1.0


@inlined
def step_tangents(
    eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray, tangents: np.ndarray, q: int,
    sources: np.ndarray, matrix: np.ndarray, pivots: np.ndarray, row_weights: np.ndarray,
    jacobian: np.ndarray, change: np.ndarray, moved: np.ndarray,
) -> bool:  # fmt: skip
    """Carry the tangents at x over the step whose increments are in w.z."""
    n, s = eq.n, m.s
    for i in range(s * n * q):
        moved[i] = 0.0
    for j in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        call_rhs(eq.jac, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, jacobian.ctypes.data)
        stage_matrix(eq, m, h, j, jacobian[n:], matrix)
        driven(eq, jacobian[n:], tangents, q, sources, change)
        for i in range(s):
            a = h * m.matrix[i * s + j]
            part = moved[i * n * q : (i + 1) * n * q]
            for k in range(n * q):
                part[k] += a * change[k]
    if not factor(matrix, row_weights, pivots, s * n):
        return False
    solve(matrix, pivots, s * n, moved, q)
    last = moved[(s - 1) * n * q :]
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
    a = size - (sn * sn + sn + n + entries + nq + sn * q)
    matrix, row_weights = room[a : a + sn * sn], room[a + sn * sn : a + sn * sn + sn]
    a += sn * sn + sn
    jacobian, change, moved = (
        room[a : a + n + entries],
        room[a + n + entries : size - sn * q],
        room[size - sn * q :],
    )
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
            jacobian, change, moved,
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
