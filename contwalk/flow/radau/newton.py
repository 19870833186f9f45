"""The equations of one Radau IIA step and their solution, in loops that numba compiles.

The unknowns are the increments Z_i = x(t + c_i h) - x(t) at the s nodes, Z = h A f. Newton's method with one
Jacobian for all nodes, that of the middle of the step, decouples into one real and (s - 1) / 2 complex
systems of the size of the state (Hairer & Wanner II, IV.8). It is iterated until the residual Z - h A f is
rounding and nothing else, so that the end of a step is a smooth function of its beginning, and the same one
whatever the matrix was.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, inlined
from contwalk.flow.radau.dense_lu import LARGEST, factor, factor_complex, solve, solve_complex
from contwalk.flow.radau.parts import EPSILON, Equations, Method, Work

# How a step's iteration ended.
CONVERGED, SLOW, NOT_FINITE, SINGULAR = 0, 1, 2, 3

# Corrections of so many units of rounding that no longer shrink are taken for rounding that the estimate of
# it missed (cancellation inside f); larger ones are taken for a failure.
NOISE = 1e5
# Passes without halving the smallest correction after which it is said to shrink no longer.
IDLE = 4

# Convergence slower than this is mended by a matrix from the increments known by then, so often at most and
# if corrections still are of so many units of rounding: the last passes are cheaper than a new matrix.
SLOWEST, MOST_MENDED, WORTH_MENDING = 0.3, 3, 1e3


@inlined
def linearize(eq: Equations, w: Work, t: float, x: np.ndarray) -> bool:
    """f and its Jacobian at the beginning of a step; false if they are not finite."""
    call_rhs(eq.jac, t, x.ctypes.data, eq.c.ctypes.data, w.out.ctypes.data)
    total = 0.0
    for value in w.out:
        total += abs(value)
    return total < np.inf


@inlined
def around(eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray) -> None:
    """The Jacobian for the matrices: at the middle node as far as it is known, or at the step's beginning."""
    n, i = eq.n, m.s // 2
    for k in range(n):
        w.state[k] = x[k] + w.z[i * n + k]
    call_rhs(eq.jac, t + m.nodes[i] * h, w.state.ctypes.data, eq.c.ctypes.data, w.near.ctypes.data)
    total = 0.0
    for value in w.near:
        total += abs(value)
    if not total < np.inf:
        for i in range(len(w.out)):
            w.near[i] = w.out[i]


@inlined
def shifted(eq: Equations, entries: np.ndarray, shift: float, a: np.ndarray) -> None:
    """a = shift I - J."""
    n = eq.n
    for i in range(n * n):
        a[i] = 0.0
    for i in range(n):
        for e in range(eq.rows[i], eq.rows[i + 1]):
            if eq.columns[e] < n:
                a[i * n + eq.columns[e]] = -entries[e]
        a[i * n + i] += shift


@inlined
def factorise(eq: Equations, m: Method, w: Work, h: float) -> bool:
    """Factors of the real and of the complex matrices of a step."""
    n = eq.n
    size = n * n
    entries = w.near[n:]
    shifted(eq, entries, m.mu / h, w.lu)
    if not factor(w.lu, w.weights, w.pivots, n, LARGEST):
        return False
    for p in range((m.s - 1) // 2):
        real = w.complex_lu[2 * p * size : (2 * p + 1) * size]
        imaginary = w.complex_lu[(2 * p + 1) * size : (2 * p + 2) * size]
        at = p * (2 + 4 * m.s)
        shifted(eq, entries, m.pairs[at] / h, real)
        for i in range(size):
            imaginary[i] = 0.0
        for i in range(n):
            imaginary[i * n + i] = m.pairs[at + 1] / h
        if not factor_complex(real, imaginary, w.weights, w.complex_pivots[p * n : (p + 1) * n], n):
            return False
    return True


@inlined
def roundings(eq: Equations, m: Method, w: Work, x: np.ndarray) -> None:
    """What rounding in x and in f moves the increments by, estimated for each state.

    Rounding of f is filtered by the step's matrix: where f is stiff it is large, and what it does is small.
    """
    n = eq.n
    for i in range(n):
        total = abs(w.out[i])
        for e in range(eq.rows[i], eq.rows[i + 1]):
            if eq.columns[e] < n:
                total += abs(w.out[n + e] * x[eq.columns[e]])
        w.y[i] = total
        w.v[i] = total if i % 2 == 0 else -total
    solve(w.lu, w.pivots, n, w.y, 1)
    solve(w.lu, w.pivots, n, w.v, 1)
    for i in range(n):
        w.base[i] = EPSILON * (abs(x[i]) + max(abs(w.y[i]), abs(w.v[i])))


@inlined
def predict(eq: Equations, m: Method, w: Work, h: float, before: float) -> None:
    """First increments: the polynomial of the step before (its length: `before`, 0 for none), continued."""
    n, s = eq.n, m.s
    for i in range(s * n):
        w.z[i] = 0.0
    ratio = h / before
    if before == 0.0 or not ratio <= 3.0:
        return
    for i in range(s):
        at = 1.0 + ratio * m.nodes[i]
        for j in range(s):
            weight = at / m.nodes[j]
            for k in range(s):
                if k != j:
                    weight *= (at - m.nodes[k]) / (m.nodes[j] - m.nodes[k])
            if j == s - 1:
                weight -= 1.0  # increments count from the end of the step before
            for k in range(n):
                w.z[i * n + k] += weight * w.old[j * n + k]


@inlined
def residuals(eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray) -> None:
    """Z - h A f."""
    n, s = eq.n, m.s
    for i in range(s):
        for k in range(n):
            w.state[k] = x[k] + w.z[i * n + k]
        call_rhs(
            eq.rhs,
            t + m.nodes[i] * h,
            w.state.ctypes.data,
            eq.c.ctypes.data,
            w.f[i * n : (i + 1) * n].ctypes.data,
        )
    for i in range(s):
        for k in range(n):
            w.residual[i * n + k] = w.z[i * n + k]
        for j in range(s):
            a = h * m.matrix[i * s + j]
            for k in range(n):
                w.residual[i * n + k] -= a * w.f[j * n + k]


@inlined
def correction(eq: Equations, m: Method, w: Work, h: float) -> None:
    """The correction of the increments by the factored matrices: delta = -(I - h A x J)^-1 residual."""
    n, s = eq.n, m.s
    size = n * n
    for k in range(n):
        total = 0.0
        for i in range(s):
            total += m.left[i] * w.residual[i * n + k]
        w.y[k] = -total * (m.mu / h)
    solve(w.lu, w.pivots, n, w.y, 1)
    for i in range(s):
        for k in range(n):
            w.delta[i * n + k] = m.right[i] * w.y[k]
    for p in range((s - 1) // 2):
        pair = m.pairs[p * (2 + 4 * s) : (p + 1) * (2 + 4 * s)]
        a, b = pair[0] / h, pair[1] / h
        for k in range(n):
            x = y = 0.0
            for i in range(s):
                x += pair[2 + 2 * s + i] * w.residual[i * n + k]
                y += pair[2 + 3 * s + i] * w.residual[i * n + k]
            w.y[k], w.v[k] = b * y - a * x, -a * y - b * x
        real = w.complex_lu[2 * p * size : (2 * p + 1) * size]
        imaginary = w.complex_lu[(2 * p + 1) * size : (2 * p + 2) * size]
        solve_complex(real, imaginary, w.complex_pivots[p * n : (p + 1) * n], n, w.y, w.v)
        for i in range(s):
            u, v = 2.0 * pair[2 + i], 2.0 * pair[2 + s + i]
            for k in range(n):
                w.delta[i * n + k] += u * w.y[k] - v * w.v[k]


@inlined
def apply(z: np.ndarray, correction: np.ndarray, base: np.ndarray, n: int, s: int) -> float:
    """Add a correction of the increments of s stages, both (s n,); its largest entry in units of rounding.

    What rounding leaves of each state is base (n,), beside that of its increments.
    """
    largest = 0.0
    for k in range(n):
        reach = move = 0.0
        for i in range(s):
            change = correction[i * n + k]
            z[i * n + k] += change
            reach = max(reach, abs(z[i * n + k]))
            if not abs(change) <= move:  # NaN too
                move = abs(change)
        if move > 0.0 or move != move:
            size = move / (base[k] + EPSILON * reach)
            if not size <= largest:
                largest = size
    return largest


@inlined
def iterate(
    eq: Equations, m: Method, w: Work, t: float, h: float, x: np.ndarray, most: int
) -> tuple[int, int, float]:
    """Newton's method for the increments, from those in w.z; (how it ended, passes, rate of convergence).

    Needs `linearize`. A step that is solved with few passes allowed is solved by the same ones if more are.
    """
    around(eq, m, w, t, h, x)
    if not factorise(eq, m, w, h):
        return SINGULAR, 0, 0.0
    roundings(eq, m, w, x)
    first = last = size = 0.0
    best = np.inf
    idle = mended = 0
    for number in range(1, most + 1):
        residuals(eq, m, w, t, h, x)
        correction(eq, m, w, h)
        last, size = size, apply(w.z, w.delta, w.base, eq.n, m.s)
        if not size < np.inf:
            return NOT_FINITE, number, 1.0
        if number == 1:
            first = size
        rate = size / last if number > 1 else 0.0
        if size <= 1.0 or (0.0 < rate < 1.0 and size * rate <= 1.0 - rate):
            return CONVERGED, number, _mean_rate(first, size, number)
        idle = idle + 1 if size > 0.5 * best else 0
        best = min(best, size)
        if idle >= IDLE and best <= NOISE:
            return CONVERGED, number, _mean_rate(first, size, number)
        if idle >= 3 * IDLE or size > 1e6 * first:
            return SLOW, number, 1.0
        if rate > SLOWEST and size > WORTH_MENDING and mended < MOST_MENDED:
            mended += 1
            around(eq, m, w, t, h, x)
            if not factorise(eq, m, w, h):
                return SINGULAR, number, 1.0
    return SLOW, most, min(1.0, _mean_rate(first, size, most))


@inlined
def solved(
    eq: Equations, m: Method, w: Work, t: float, h: float, before: float, x: np.ndarray, most: int
) -> bool:
    """The increments of a step that cannot be shortened; whether they are found.

    Where the polynomial of the step before, of length `before`, leads nowhere, they are begun from none.
    """
    predict(eq, m, w, h, before)
    if iterate(eq, m, w, t, h, x, most)[0] == CONVERGED:
        return True
    if before == 0.0:
        return False
    predict(eq, m, w, h, 0.0)
    return iterate(eq, m, w, t, h, x, most)[0] == CONVERGED


@inlined
def _mean_rate(first: float, size: float, passes: int) -> float:
    """By how much a pass reduced the corrections in the geometric mean, down to the level of rounding."""
    if passes < 2 or first <= 1.0:
        return 0.0
    return (max(size, 1.0) / first) ** (1.0 / (passes - 1))
