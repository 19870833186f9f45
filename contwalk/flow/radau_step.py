"""One step of Radau IIA collocation, in loops that numba compiles.

The unknowns are the increments Z_i = x(t + c_i h) - x(t) at the s nodes, Z = h A f. Newton's method with the Jacobian
of the step's beginning decouples into one real and (s - 1) / 2 complex systems of the size of the state (Hairer &
Wanner II, IV.8). It is iterated until the residual Z - h A f is rounding and nothing else, so that the end of a
step is a smooth function of its beginning, and the same one whatever the matrix was.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contwalk.flow.calling import call_rhs, inlined
from contwalk.flow.dense_lu import factor, factor_complex, solve, solve_complex

EPSILON = 2.0**-52

# How a step's iteration ended.
CONVERGED, SLOW, NOT_FINITE, SINGULAR = 0, 1, 2, 3

# Corrections of so many units of rounding that no longer shrink are taken for rounding that the estimate of it
# missed (cancellation inside f); larger ones are taken for a failure.
NOISE = 1e5


class Equations(NamedTuple):
    """A field by addresses: right-hand side, the same with Jacobian, its pattern, and the constants."""

    rhs: int
    jac: int
    n: int
    rows: np.ndarray
    columns: np.ndarray
    c: np.ndarray


class Method(NamedTuple):
    """A tableau taken apart; `tableaus.radau` says what the parts are."""

    s: int
    nodes: np.ndarray
    matrix: np.ndarray
    error: np.ndarray
    mu: float
    right: np.ndarray
    left: np.ndarray
    pairs: np.ndarray


class Work(NamedTuple):
    """Scratch of a path."""

    out: np.ndarray  # f at the beginning of the step and the entries of its Jacobian
    z: np.ndarray  # increments of the step (s, n)
    old: np.ndarray  # increments of the step before (s, n)
    f: np.ndarray  # f at the nodes (s, n)
    residual: np.ndarray  # (s, n)
    delta: np.ndarray  # correction of the increments (s, n)
    lu: np.ndarray
    pivots: np.ndarray
    complex_lu: np.ndarray
    complex_pivots: np.ndarray
    weights: np.ndarray
    base: np.ndarray  # units of rounding, from the beginning of the step
    state: np.ndarray
    y: np.ndarray
    v: np.ndarray


@inlined
def method(tableau: np.ndarray, s: int) -> Method:
    """The parts of a packed tableau."""
    at = s + s * s + s
    return Method(
        s,
        tableau[:s],
        tableau[s : s + s * s],
        tableau[s + s * s : at],
        tableau[at],
        tableau[at + 1 : at + 1 + s],
        tableau[at + 1 + s : at + 1 + 2 * s],
        tableau[at + 1 + 2 * s :],
    )


@inlined
def work(doubles: np.ndarray, integers: np.ndarray, n: int, s: int, entries: int) -> Work:
    """Scratch cut into its parts."""
    sn, pairs = s * n, (s - 1) // 2
    a = n + entries
    b = a + 5 * sn
    d = b + n * n + pairs * 2 * n * n
    return Work(
        doubles[:a],
        doubles[a : a + sn],
        doubles[a + sn : a + 2 * sn],
        doubles[a + 2 * sn : a + 3 * sn],
        doubles[a + 3 * sn : a + 4 * sn],
        doubles[a + 4 * sn : b],
        doubles[b : b + n * n],
        integers[:n],
        doubles[b + n * n : d],
        integers[n : n + pairs * n],
        doubles[d : d + n],
        doubles[d + n : d + 2 * n],
        doubles[d + 2 * n : d + 3 * n],
        doubles[d + 3 * n : d + 4 * n],
        doubles[d + 4 * n : d + 5 * n],
    )


@inlined
def linearize(eq: Equations, w: Work, t: float, x: np.ndarray) -> bool:
    """f and its Jacobian at the beginning of a step; false if they are not finite."""
    call_rhs(eq.jac, t, x.ctypes.data, eq.c.ctypes.data, w.out.ctypes.data)
    total = 0.0
    for value in w.out:
        total += abs(value)
    return total < np.inf


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
    entries = w.out[n:]
    shifted(eq, entries, m.mu / h, w.lu)
    if not factor(w.lu, w.weights, w.pivots, n):
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
    """First increments: the polynomial of the step before, of length `before` (0: there is none), continued."""
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
def apply(eq: Equations, m: Method, w: Work) -> float:
    """Add the correction; its largest entry in units of rounding."""
    n, s = eq.n, m.s
    largest = 0.0
    for k in range(n):
        reach = move = 0.0
        for i in range(s):
            change = w.delta[i * n + k]
            w.z[i * n + k] += change
            reach = max(reach, abs(w.z[i * n + k]))
            if not abs(change) <= move:  # NaN too
                move = abs(change)
        if move > 0.0 or move != move:
            size = move / (w.base[k] + EPSILON * reach)
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
    if not factorise(eq, m, w, h):
        return SINGULAR, 0, 0.0
    roundings(eq, m, w, x)
    first = last = size = 0.0
    for number in range(1, most + 1):
        residuals(eq, m, w, t, h, x)
        correction(eq, m, w, h)
        last, size = size, apply(eq, m, w)
        if not size < np.inf:
            return NOT_FINITE, number, 1.0
        if number == 1:
            first = size
        if size <= 1.0:
            return CONVERGED, number, _mean_rate(first, size, number)
        if number > 1:
            rate = size / last
            if rate < 1.0 and size * rate <= 1.0 - rate:
                return CONVERGED, number, _mean_rate(first, size, number)
            if rate > 0.9 and size <= NOISE:
                return CONVERGED, number, _mean_rate(first, size, number)
            if (number > 2 and rate > 2.0) or size > 1e6 * first:
                return SLOW, number, 1.0
    return SLOW, most, min(1.0, _mean_rate(first, size, most))


@inlined
def _mean_rate(first: float, size: float, passes: int) -> float:
    """By how much a pass reduced the corrections in the geometric mean, down to the level of rounding."""
    if passes < 2 or first <= 1.0:
        return 0.0
    return (max(size, 1.0) / first) ** (1.0 / (passes - 1))


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
