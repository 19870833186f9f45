"""The equations of one step of collocation, solved by Newton's method, compiled by numba.

inverse Z = h f(x + Z) at the points: the unknowns inside a step are eliminated where they are, so that an
orbit is a matter of the ends of steps alone (condensation of parameters). The matrix has the Jacobian of each
point by itself. It is kept once the corrections are small; which ones are small depends on nothing but the
step's start, so that F is a function.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined
from contwalk.flow.gauss.parts import EPSILON, Points, Work
from contwalk.flow.radau.dense_lu import OWN, factor, solve
from contwalk.flow.radau.newton import apply
from contwalk.flow.radau.parts import Equations
from contwalk.flow.radau.tangents import driven, stage_matrix

CONVERGED, SLOW, NOT_FINITE, SINGULAR = 0, 1, 2, 3

MOST_PASSES = 40
# Corrections in units of rounding. Below the first, nothing is left to gain; below the second the matrix is
# kept (it is then wrong by as much, relatively); below the third, one that no longer shrinks is noise.
ROUNDED, KEPT, NOISE = 4.0, 1e11, 1e6
IDLE = 2


@inlined
def matrices(eq: Equations, m: Points, w: Work, t: float, h: float, x: np.ndarray) -> bool:
    """Factors of inverse x I - h J at x + Z; the right sides h f - inverse Z are left in `w.correction`."""
    n, s = eq.n, m.s
    total = 0.0
    for j in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        call_rhs(eq.jac, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, w.jacobian.ctypes.data)
        for value in w.jacobian:
            total += abs(value)
        stage_matrix(eq, m, h, j, w.jacobian[n:], w.matrix)
        for k in range(n):
            w.correction[j * n + k] = h * w.jacobian[k]
            unit = abs(w.jacobian[k])
            for e in range(eq.rows[k], eq.rows[k + 1]):
                if eq.columns[e] < n:
                    unit += abs(w.jacobian[n + e] * w.state[eq.columns[e]])
            w.base[k] = max(w.base[k], EPSILON * (abs(x[k]) + abs(h) * unit))
    if not total < np.inf:
        return False
    defects(m, w, n)
    return True


@inlined
def defects(m: Points, w: Work, n: int) -> None:
    """Subtract inverse Z from `w.correction`."""
    s = m.s
    for i in range(s):
        for j in range(s):
            a = m.inverse[i * s + j]
            for k in range(n):
                w.correction[i * n + k] -= a * w.z[j * n + k]


@inlined
def values(eq: Equations, m: Points, w: Work, t: float, h: float, x: np.ndarray) -> None:
    """As `matrices`, without these."""
    n = eq.n
    for j in range(m.s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        out = w.correction[j * n : (j + 1) * n]
        call_rhs(eq.rhs, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, out.ctypes.data)
        for k in range(n):
            out[k] *= h
    defects(m, w, n)


@inlined
def increments(eq: Equations, m: Points, w: Work, t: float, h: float, x: np.ndarray) -> tuple[int, int]:
    """Solve for the increments in `w.z`, from none; (how it ended, evaluations of the field)."""
    n, s = eq.n, m.s
    sn = s * n
    for i in range(sn):
        w.z[i] = 0.0
    for k in range(n):
        w.base[k] = 0.0
    size, best, spent = np.inf, np.inf, 0
    idle, spread = 0, False
    for _ in range(MOST_PASSES):
        if size > KEPT:
            spent += 2 * s
            if not matrices(eq, m, w, t, h, x):
                return NOT_FINITE, spent
            if not factor(w.matrix, w.row_weights, w.pivots, sn, OWN):
                return SINGULAR, spent
        else:
            spent += s
            values(eq, m, w, t, h, x)
        solve(w.matrix, w.pivots, sn, w.correction, 1)
        size = apply(w.z, w.correction, w.base, n, s)
        if not size < np.inf:
            return NOT_FINITE, spent
        if size <= ROUNDED:
            return CONVERGED, spent
        idle = idle + 1 if size > 0.5 * best else 0
        best = min(best, size)
        if idle < IDLE:
            continue
        if best <= NOISE:
            return CONVERGED, spent
        if not spread:
            spread_roundings(m, w, n)
            best, idle, spread = np.inf, 0, True
    return SLOW, spent


@inlined
def spread_roundings(m: Points, w: Work, n: int) -> None:
    """Add to the units of rounding what the step's matrix makes of those of the other states.

    A state that is zero and driven by others that are zero has no rounding by its own terms; what it gets is
    that of the terms that cancel in those others.
    """
    s = m.s
    for sign in (1.0, -1.0):
        for j in range(s):
            for k in range(n):
                w.correction[j * n + k] = w.base[k] if k % 2 == 0 else sign * w.base[k]
        solve(w.matrix, w.pivots, s * n, w.correction, 1)
        for k in range(n):
            w.state[k] = 0.0 if sign > 0.0 else w.state[k]
            for j in range(s):
                w.state[k] = max(w.state[k], abs(w.correction[j * n + k]))
    for k in range(n):
        w.base[k] = max(w.base[k], w.state[k])


@inlined
def end_of(m: Points, w: Work, n: int, x: np.ndarray) -> None:
    """Go to the end of the step whose increments are in `w.z`."""
    for j in range(m.s):
        a = m.end[j]
        for k in range(n):
            x[k] += a * w.z[j * n + k]


@inlined
def carry(
    eq: Equations, m: Points, w: Work, t: float, h: float, x: np.ndarray, q: int, sources: np.ndarray
) -> bool:
    """Carry the tangents at x, in `w.tangents`, over the step whose increments are in `w.z`."""
    n, s = eq.n, m.s
    for j in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[j * n + k]
        call_rhs(eq.jac, t + m.nodes[j] * h, w.state.ctypes.data, eq.c.ctypes.data, w.jacobian.ctypes.data)
        stage_matrix(eq, m, h, j, w.jacobian[n:], w.matrix)
        moved = doubles(w.moved.ctypes.data + 8 * j * n * q, n * q)
        driven(eq, h, w.jacobian[n:], w.tangents, q, sources, moved)
    if not factor(w.matrix, w.row_weights, w.pivots, s * n, OWN):
        return False
    solve(w.matrix, w.pivots, s * n, w.moved, q)
    for j in range(s):
        a, moved = m.end[j], doubles(w.moved.ctypes.data + 8 * j * n * q, n * q)
        for i in range(n * q):
            w.tangents[i] += a * moved[i]
    return True
