"""LU factors of small dense matrices, real and complex, in loops that numba compiles.

Matrices are flat and row-major. Rows are weighed by their largest entry when a pivot is chosen: equations of
a machine have the units that its author chose, and the choice must not depend on them.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.calling import inlined


@inlined
def factor(a: np.ndarray, weights: np.ndarray, pivots: np.ndarray, n: int) -> bool:
    """Replace a by its factors; false if it is singular or not finite. `weights` is scratch of length n."""
    for i in range(n):
        largest = 0.0
        for j in range(n):
            largest = max(largest, abs(a[i * n + j]))
        weights[i] = 1.0 / largest
    for k in range(n):
        chosen, best = k, -1.0
        for i in range(k, n):
            size = abs(a[i * n + k]) * weights[i]
            if size > best:
                chosen, best = i, size
        if not (0.0 < best < np.inf):
            return False
        pivots[k] = chosen
        if chosen != k:
            weights[chosen] = weights[k]
            for j in range(n):
                a[k * n + j], a[chosen * n + j] = a[chosen * n + j], a[k * n + j]
        inverse = 1.0 / a[k * n + k]
        for i in range(k + 1, n):
            multiple = a[i * n + k] * inverse
            a[i * n + k] = multiple
            if multiple != 0.0:
                for j in range(k + 1, n):
                    a[i * n + j] -= multiple * a[k * n + j]
    return True


@inlined
def solve(a: np.ndarray, pivots: np.ndarray, n: int, b: np.ndarray, columns: int) -> None:
    """Replace b, n rows of `columns` entries, by the solution."""
    for k in range(n):
        other = pivots[k]
        if other != k:
            for j in range(columns):
                b[k * columns + j], b[other * columns + j] = b[other * columns + j], b[k * columns + j]
    for i in range(1, n):
        for k in range(i):
            multiple = a[i * n + k]
            if multiple != 0.0:
                for j in range(columns):
                    b[i * columns + j] -= multiple * b[k * columns + j]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            multiple = a[i * n + k]
            if multiple != 0.0:
                for j in range(columns):
                    b[i * columns + j] -= multiple * b[k * columns + j]
        pivot = a[i * n + i]
        for j in range(columns):
            b[i * columns + j] /= pivot


@inlined
def factor_complex(
    real: np.ndarray, imaginary: np.ndarray, weights: np.ndarray, pivots: np.ndarray, n: int
) -> bool:
    """The same for a complex matrix; the diagonal of the factors holds the inverses of the pivots."""
    for i in range(n):
        largest = 0.0
        for j in range(n):
            largest = max(largest, abs(real[i * n + j]) + abs(imaginary[i * n + j]))
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
            for j in range(n):
                real[k * n + j], real[chosen * n + j] = real[chosen * n + j], real[k * n + j]
                imaginary[k * n + j], imaginary[chosen * n + j] = (
                    imaginary[chosen * n + j],
                    imaginary[k * n + j],
                )
        x, y = real[k * n + k], imaginary[k * n + k]
        x, y = _inverse(x, y)
        real[k * n + k], imaginary[k * n + k] = x, y
        for i in range(k + 1, n):
            p, q = real[i * n + k], imaginary[i * n + k]
            if p != 0.0 or q != 0.0:
                u, v = p * x - q * y, p * y + q * x
                real[i * n + k], imaginary[i * n + k] = u, v
                for j in range(k + 1, n):
                    p, q = real[k * n + j], imaginary[k * n + j]
                    real[i * n + j] -= u * p - v * q
                    imaginary[i * n + j] -= u * q + v * p
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
