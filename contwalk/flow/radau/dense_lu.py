"""LU factors of small dense matrices, real and complex, in loops that numba compiles.

Matrices are flat and row-major. Rows are weighed by their largest entry when a pivot is chosen: equations of
a machine have the units that its author chose, and the choice must not depend on them. Parts of rows are
counted from 0: loops over them become vector instructions, which they do not if an index may be negative for
all that the compiler knows.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined


@inlined
def _subtract(target: np.ndarray, multiple: float, source: np.ndarray, length: int) -> None:
    """target -= multiple source."""
    for j in range(length):
        target[j] -= multiple * source[j]


@inlined
def _exchange(first: np.ndarray, second: np.ndarray, length: int) -> None:
    for j in range(length):
        first[j], second[j] = second[j], first[j]


# The largest pivot in a column, or the diagonal's entry as long as it is no smaller than this part of that:
# what is not coupled then stays apart. With rows of other states as pivots, a state that is zero but for
# 1e-30 gets the rounding of all others.
LARGEST, OWN = 1.0, 0.05


@inlined
def factor(a: np.ndarray, weights: np.ndarray, pivots: np.ndarray, n: int, own: float) -> bool:
    """Replace a by its factors; false if it is singular or not finite.

    `weights` is scratch of length n, and `own` is `LARGEST` or `OWN`.
    """
    for i in range(n):
        row, largest = doubles(a.ctypes.data + 8 * (i * n), n), 0.0
        for j in range(n):
            largest = max(largest, abs(row[j]))
        weights[i] = 1.0 / largest
    for k in range(n):
        chosen, best = k, -1.0
        for i in range(k, n):
            size = abs(a[i * n + k]) * weights[i]
            if size > best:
                chosen, best = i, size
        if not (0.0 < best < np.inf):
            return False
        if abs(a[k * n + k]) * weights[k] >= own * best:
            chosen = k
        pivots[k] = chosen
        if chosen != k:
            weights[chosen] = weights[k]
            _exchange(
                doubles(a.ctypes.data + 8 * (k * n), n), doubles(a.ctypes.data + 8 * (chosen * n), n), n
            )
        inverse = 1.0 / a[k * n + k]
        rest = n - k - 1
        source = doubles(a.ctypes.data + 8 * (k * n + k + 1), rest)
        for i in range(k + 1, n):
            multiple = a[i * n + k] * inverse
            if multiple != 0.0:
                a[i * n + k] = multiple
                _subtract(doubles(a.ctypes.data + 8 * (i * n + k + 1), rest), multiple, source, rest)
    return True


@inlined
def solve(a: np.ndarray, pivots: np.ndarray, n: int, b: np.ndarray, columns: int) -> None:
    """Replace b, n rows of `columns` entries, by the solution."""
    for k in range(n):
        other = pivots[k]
        if other != k:
            _exchange(
                doubles(b.ctypes.data + 8 * (k * columns), columns),
                doubles(b.ctypes.data + 8 * (other * columns), columns),
                columns,
            )
    for i in range(1, n):
        target = doubles(b.ctypes.data + 8 * (i * columns), columns)
        for k in range(i):
            multiple = a[i * n + k]
            if multiple != 0.0:
                _subtract(target, multiple, doubles(b.ctypes.data + 8 * (k * columns), columns), columns)
    for i in range(n - 1, -1, -1):
        target = doubles(b.ctypes.data + 8 * (i * columns), columns)
        for k in range(i + 1, n):
            multiple = a[i * n + k]
            if multiple != 0.0:
                _subtract(target, multiple, doubles(b.ctypes.data + 8 * (k * columns), columns), columns)
        inverse = 1.0 / a[i * n + i]
        for j in range(columns):
            target[j] *= inverse


@inlined
def factor_complex(
    real: np.ndarray, imaginary: np.ndarray, weights: np.ndarray, pivots: np.ndarray, n: int
) -> bool:
    """The same for a complex matrix; the diagonal of the factors holds the inverses of the pivots."""
    for i in range(n):
        x, y, largest = (
            doubles(real.ctypes.data + 8 * (i * n), n),
            doubles(imaginary.ctypes.data + 8 * (i * n), n),
            0.0,
        )
        for j in range(n):
            largest = max(largest, abs(x[j]) + abs(y[j]))
        weights[i] = 1.0 / largest
    for k in range(n):
        chosen, best = k, -1.0
        for i in range(k, n):
            size = (abs(real[i * n + k]) + abs(imaginary[i * n + k])) * weights[i]
            if size > best:
                chosen, best = i, size
        if not (0.0 < best < np.inf):
            return False
        pivots[k] = chosen
        if chosen != k:
            weights[chosen] = weights[k]
            _exchange(
                doubles(real.ctypes.data + 8 * (k * n), n), doubles(real.ctypes.data + 8 * (chosen * n), n), n
            )
            _exchange(
                doubles(imaginary.ctypes.data + 8 * (k * n), n),
                doubles(imaginary.ctypes.data + 8 * (chosen * n), n),
                n,
            )
        x, y = _inverse(real[k * n + k], imaginary[k * n + k])
        real[k * n + k], imaginary[k * n + k] = x, y
        rest = n - k - 1
        c, d = (
            doubles(real.ctypes.data + 8 * (k * n + k + 1), rest),
            doubles(imaginary.ctypes.data + 8 * (k * n + k + 1), rest),
        )
        for i in range(k + 1, n):
            p, q = real[i * n + k], imaginary[i * n + k]
            if p != 0.0 or q != 0.0:
                u, v = p * x - q * y, p * y + q * x
                real[i * n + k], imaginary[i * n + k] = u, v
                e, f = (
                    doubles(real.ctypes.data + 8 * (i * n + k + 1), rest),
                    doubles(imaginary.ctypes.data + 8 * (i * n + k + 1), rest),
                )
                for j in range(rest):
                    e[j] -= u * c[j] - v * d[j]
                    f[j] -= u * d[j] + v * c[j]
    return True


@inlined
def _inverse(x: float, y: float) -> tuple[float, float]:
    """1 / (x + i y), without overflow on the way."""
    size = max(abs(x), abs(y))
    x, y = x / size, y / size
    square = (x * x + y * y) * size
    return x / square, -y / square


@inlined
def solve_complex(
    real: np.ndarray, imaginary: np.ndarray, pivots: np.ndarray, n: int, b: np.ndarray, c: np.ndarray
) -> None:
    """Replace b + i c, of length n, by the solution."""
    for k in range(n):
        other = pivots[k]
        if other != k:
            b[k], b[other] = b[other], b[k]
            c[k], c[other] = c[other], c[k]
    for i in range(1, n):
        x, y = b[i], c[i]
        for k in range(i):
            p, q = real[i * n + k], imaginary[i * n + k]
            x -= p * b[k] - q * c[k]
            y -= p * c[k] + q * b[k]
        b[i], c[i] = x, y
    for i in range(n - 1, -1, -1):
        x, y = b[i], c[i]
        for k in range(i + 1, n):
            p, q = real[i * n + k], imaginary[i * n + k]
            x -= p * b[k] - q * c[k]
            y -= p * c[k] + q * b[k]
        p, q = real[i * n + i], imaginary[i * n + i]
        b[i], c[i] = x * p - y * q, x * q + y * p
