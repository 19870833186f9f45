"""`numpy.linalg` for arrays with stand-ins for numbers: elimination whose pivots are chosen when it is done.

Which pivot is the largest depends on the state. Rows are exchanged by choices (`where`), not by branches: a
system of equations makes no paths, and derivatives are those of the solution, whatever the pivots are.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.dispatch import dispatch, symbolic, where

# A determinant of n rows by minors is n 2^(n - 1) products.
MOST_ROWS_OF_MINORS = 8


def solve(a: Any, b: Any) -> np.ndarray:
    """`numpy.linalg.solve` of one square matrix, and a vector or the columns of a matrix."""
    if not symbolic(a, b):
        return np.linalg.solve(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    matrix, right = _square("solve", a), np.array(b, dtype=object)
    if right.ndim not in (1, 2) or len(right) != len(matrix):
        raise UnsupportedOperation(
            f"numpy.linalg.solve gets a matrix of shape {matrix.shape} and a side of shape {right.shape}.",
            "Give as many rows on both sides.",
        )
    n, rows = len(matrix), np.column_stack([matrix, right])
    for k in range(n):
        for i in range(k + 1, n):
            larger = dispatch("abs", (rows[i, k],)) > dispatch("abs", (rows[k, k],))
            upper, lower = where(larger, rows[i, k:], rows[k, k:]), where(larger, rows[k, k:], rows[i, k:])
            rows[k, k:], rows[i, k:] = upper, lower
        for i in range(k + 1, n):
            rows[i, k + 1 :] = rows[i, k + 1 :] - (rows[i, k] / rows[k, k]) * rows[k, k + 1 :]
    solution = rows[:, n:]
    for k in reversed(range(n)):
        known = rows[k, k + 1 : n] @ solution[k + 1 :] if k + 1 < n else 0.0
        solution[k] = (solution[k] - known) / rows[k, k]
    return solution[:, 0] if right.ndim == 1 else solution


def inv(a: Any) -> np.ndarray:
    """`numpy.linalg.inv` of one matrix."""
    if not symbolic(a):
        return np.linalg.inv(np.asarray(a, dtype=float))
    return solve(a, np.eye(len(_square("inv", a))))


def det(a: Any) -> Any:
    """`numpy.linalg.det` of one matrix, by minors: without a division, so that it exists where it is zero."""
    if not symbolic(a):
        return float(np.linalg.det(np.asarray(a, dtype=float)))
    matrix = _square("det", a)
    if len(matrix) > MOST_ROWS_OF_MINORS:
        raise UnsupportedOperation(
            f"numpy.linalg.det gets a matrix with {len(matrix)} rows that depends on the state.",
            f"At most {MOST_ROWS_OF_MINORS} rows are possible.",
        )
    minors: dict[tuple[int, ...], Any] = {(): 1.0}  # of the last rows, by their columns
    for row in reversed(range(len(matrix))):
        found: dict[tuple[int, ...], Any] = {}
        for columns, minor in minors.items():
            for column in set(range(len(matrix))) - set(columns):
                chosen = tuple(sorted((*columns, column)))
                signed = matrix[row, column] * minor * (-1.0 if chosen.index(column) % 2 else 1.0)
                found[chosen] = found[chosen] + signed if chosen in found else signed
        minors = found
    return minors[tuple(range(len(matrix)))]


def _square(name: str, a: Any) -> np.ndarray:
    matrix = np.array(a, dtype=object)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise UnsupportedOperation(
            f"numpy.linalg.{name} gets an array of shape {matrix.shape}.", "Give one square matrix."
        )
    return matrix
