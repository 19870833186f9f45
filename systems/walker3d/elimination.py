"""Symmetric positive definite equations with many zeros, solved without filling them.

The matrix is a mapping of its nonzero entries (i, j), each pair once. In the order of the limbs from the
outside to the inside an elimination makes no new entries between limbs: the shanks first, then their thighs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Entries = dict[tuple[int, int], Any]


def add(entries: Entries, i: int, j: int, value: Any) -> None:
    """Add to an entry of a symmetric matrix."""
    place = (i, j) if i <= j else (j, i)
    entries[place] = entries[place] + value if place in entries else value


def solved(matrix: Mapping[tuple[int, int], Any], right: Sequence[Any], order: Sequence[int]) -> list[Any]:
    """Solution of the equations, eliminated in this order.

    Parameters
    ----------
    matrix : mapping of (i, j) with i <= j to entries
    right : sequence of length n
    order : sequence of int
        The unknowns that exist; those of the others are 0.
    """
    matrix, right = dict(matrix), list(right)
    left = list(order)
    steps = []
    while left:
        k = left.pop(0)
        inverse = 1.0 / matrix[k, k]
        column = {i: matrix[min(i, k), max(i, k)] for i in left if (min(i, k), max(i, k)) in matrix}
        factors = {i: entry * inverse for i, entry in column.items()}
        for i, factor in factors.items():
            right[i] = right[i] - factor * right[k]
            for j, entry in column.items():
                if i <= j:
                    add(matrix, i, j, -(factor * entry))
        steps.append((k, inverse, factors))
    solution = [0.0] * len(right)
    for k, inverse, factors in reversed(steps):
        value = right[k] * inverse
        for i, factor in factors.items():
            value = value - factor * solution[i]
        solution[k] = value
    return solution
