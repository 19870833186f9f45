"""Linear systems in any arithmetic: L U = P A by columns, and a solution from it.

Machine code (`elimination_code`) does the same operations in the same order: both agree to the last bit. A
pivot left over from numbers `1 / (MARGIN n eps)` times as large is rounding, and the matrix is singular
as far as can be told. The comparison does not depend on the units of rows or columns.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isqrt
from typing import Any

MARGIN = 8.0
# So few rows are exchanged by choices, without a branch: symmetry would save nothing.
FEW_ROWS = 4


class SingularMatrix(ArithmeticError):
    """A matrix without an inverse, as far as rounding lets one tell."""


@dataclass(frozen=True)
class Factored:
    """`columns[j][i]`: entry (i, j) of U, below the diagonal of L; row k changed places with `pivots[k]`."""

    columns: list[list[Any]]
    pivots: list[int]
    determinant: Any
    singular: bool


def eliminated(entries: Sequence[Any], eps: Any) -> Factored:
    """A matrix, given row by row, factored with the largest pivots of its columns."""
    n = isqrt(len(entries))
    a = [list(entries[j::n]) for j in range(n)]
    pivots: list[int] = []
    determinant, singular = 1.0, False
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(a[k][i]) > abs(a[k][p]):
                p = i
        pivots.append(p)
        if p != k:
            for column in a:
                column[k], column[p] = column[p], column[k]
        u = a[k][k]
        determinant = determinant * (u if p == k else -u)
        singular = singular or not abs(u) > _rounding(a, k, eps)
        if not abs(u) > 0.0:
            break
        below = a[k]
        for i in range(k + 1, n):
            below[i] = below[i] / u
        for column in a[k + 1 :]:
            above = column[k]
            for i in range(k + 1, n):
                column[i] = column[i] - below[i] * above
    return Factored(a, pivots, determinant, singular)


def eliminated_symmetric(entries: Sequence[Any], eps: Any) -> Factored:
    """A symmetric matrix: where it is positive definite by half the work, without exchanges (L D L^T)."""
    n = isqrt(len(entries))
    a = [list(entries[j::n]) for j in range(n)]
    determinant: Any = 1.0
    for k in range(n):
        d, own = a[k][k], a[k]
        if not d > _rounding(a, k, eps):
            return eliminated(entries, eps)
        determinant = determinant * d
        for j in range(k + 1, n):
            a[j][k] = own[j] / d
        for j in range(k + 1, n):
            column, share = a[j], a[j][k]
            for i in range(j, n):
                column[i] = column[i] - share * own[i]
        for j in range(k + 1, n):
            a[j][k], own[j] = own[j], a[j][k]
    return Factored(a, list(range(n)), determinant, False)


def _rounding(a: list[list[Any]], k: int, eps: Any) -> Any:
    """What of pivot k may be rounding: it is a difference of numbers that add up to this by their sizes."""
    total: Any = 0.0
    for j in range(k):
        total = total + abs(a[j][k] * a[k][j])
    return MARGIN * len(a) * eps * total


def solved(factor: Factored, right: Sequence[Any]) -> list[Any]:
    """The solution for a right-hand side.

    Raises
    ------
    SingularMatrix
    """
    if factor.singular:
        raise SingularMatrix("the matrix is singular")
    a, b = factor.columns, list(right)
    n = len(b)
    for k, p in enumerate(factor.pivots):
        b[k], b[p] = b[p], b[k]
    for j in range(n):
        for i in range(j + 1, n):
            b[i] = b[i] - a[j][i] * b[j]
    for j in reversed(range(n)):
        b[j] = b[j] / a[j][j]
        for i in range(j):
            b[i] = b[i] - a[j][i] * b[j]
    return b


def names(eps: Callable[[], Any] = lambda: sys.float_info.epsilon) -> dict[str, Callable[..., Any]]:
    """What generated Python calls: by the names of a graph's operations."""
    return {
        "factor": lambda *entries: eliminated(entries, eps()),
        "factor_symmetric": lambda *entries: eliminated_symmetric(entries, eps()),
        "solved": lambda factor, *right: solved(factor, right),
        "item": lambda solution, i: solution[int(i)],
        "determinant": lambda factor: factor.determinant,
    }
