"""Factors of a closure between the quotients by what is left out of them, in loops that numba compiles.

See `multipliers`. Matrices are row-major; those of all segments stand one after the other.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import doubles, inlined, integers


@inlined
def _reflected(a: Any, n: int, width: int, column: int, v: Any) -> float:
    """The Householder vector of a column from its own row on; twice the inverse of its square, 0 of zeros."""
    largest = 0.0
    for i in range(column, n):
        largest = max(largest, abs(a[i * width + column]))
    if not largest > 0.0:
        return 0.0
    total = 0.0
    for i in range(column, n):
        v[i] = a[i * width + column] / largest
        total += v[i] * v[i]
    v[column] += math.copysign(math.sqrt(total), v[column])
    square = 0.0
    for i in range(column, n):
        square += v[i] * v[i]
    return 2.0 / square


@inlined
def _basis(given: int, n: int, k: int, q: int, work: int) -> None:
    """An orthonormal basis (n, n) whose first k vectors span given ones, (n, k), and the others the rest."""
    a, v, basis = doubles(work, n * k), doubles(work + 8 * n * k, n), doubles(q, n * n)
    source = doubles(given, n * k)
    for i in range(n * k):
        a[i] = source[i]
    for i in range(n * n):
        basis[i] = 1.0 if i % (n + 1) == 0 else 0.0
    for column in range(k):
        factor = _reflected(a, n, k, column, v)
        for j in range(column, k):
            dot = 0.0
            for i in range(column, n):
                dot += v[i] * a[i * k + j]
            for i in range(column, n):
                a[i * k + j] -= factor * dot * v[i]
        for row in range(n):
            dot = 0.0
            for i in range(column, n):
                dot += v[i] * basis[row * n + i]
            for i in range(column, n):
                basis[row * n + i] -= factor * dot * v[i]


@inlined
def _between(moved: int, left_out: int, there: int, n: int, k: int, out: int) -> None:
    """What is moved (n, r), without the first k vectors of a basis, in the others of the basis there."""
    r = n - k
    m, d, q = doubles(moved, n * r), doubles(left_out, n * n), doubles(there, n * n)
    found = doubles(out, r * r)
    for j in range(r):
        for i in range(r):
            found[i * r + j] = 0.0
        for row in range(n):
            rest = m[row * r + j]
            for c in range(k):
                dot = 0.0
                for i in range(n):
                    dot += d[i * n + c] * m[i * r + j]
                rest -= d[row * n + c] * dot
            for i in range(r):
                found[i * r + j] += q[row * n + k + i] * rest


@inlined
def _carried(factor: int, begin: int, end: int, n: int, k: int, own: int, out: int) -> bool:
    """The first directions carried along by a factor, and the others where it ends; whether none is zero."""
    f, a, b, found = doubles(factor, n * n), doubles(begin, n * k), doubles(end, n * k), doubles(out, n * k)
    fine = True
    for c in range(k):
        largest = 0.0
        for i in range(n):
            value = 0.0 if c < own else b[i * k + c]
            if c < own:
                for j in range(n):
                    value += f[i * n + j] * a[j * k + c]
            found[i * k + c] = value
            largest = max(largest, abs(value))
        fine = fine and largest > 0.0
    return fine


def quotients(factors: int, begin: int, end: int, sizes: int, found: int, others: int, work: int) -> int:
    """Each factor (n, n) between the quotient spaces at its ends, as `found` and `others`, (r, r) each.

    Left out are k directions where each segment begins, and where it ends, both (n, k); for `others` where it
    ends the first `own` of those where it begins, carried along. `sizes` are m, n, k and own. Whether no
    direction that is carried along is zero: where one is, `others` are as they come.
    """
    given = integers(sizes, 4)
    m, n, k, own = given[0], given[1], given[2], given[3]
    r, fine = n - k, True
    bases, left_out = work, work + 8 * m * n * n
    moved = left_out + 8 * n * n
    carried, rest = moved + 8 * n * r, moved + 8 * n * n
    for j in range(m):
        _basis(begin + 8 * j * n * k, n, k, bases + 8 * j * n * n, rest)
    for j in range(m):
        factor, there = factors + 8 * j * n * n, bases + 8 * ((j + 1) % m) * n * n
        f, q = doubles(factor, n * n), doubles(bases + 8 * j * n * n, n * n)
        product = doubles(moved, n * r)
        for i in range(n):
            for c in range(r):
                product[i * r + c] = 0.0
                for i2 in range(n):
                    product[i * r + c] += f[i * n + i2] * q[i2 * n + k + c]
        _basis(end + 8 * j * n * k, n, k, left_out, rest)
        _between(moved, left_out, there, n, k, found + 8 * j * r * r)
        nonzero = _carried(factor, begin + 8 * j * n * k, end + 8 * j * n * k, n, k, own, carried)
        fine = fine and nonzero
        _basis(carried, n, k, left_out, rest)
        _between(moved, left_out, there, n, k, others + 8 * j * r * r)
    return 1 if fine else 0
