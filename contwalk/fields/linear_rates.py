"""Derivatives and rounding of solutions of linear systems: of the equations, not of the elimination.

A x = b gives A x' = b' - A' x with the same factor, whatever the pivots were; d det A = det A tr(A^-1 A').
"""

from __future__ import annotations

import math
from collections.abc import Callable

from contwalk.fields.graph import Graph

Of = Callable[[int], int]


def rows_of(graph: Graph, factor: int) -> list[tuple[int, ...]]:
    """Nodes of the entries of a matrix, row by row."""
    entries = graph.nodes[factor][1:]
    n = math.isqrt(len(entries))
    return [entries[i * n : (i + 1) * n] for i in range(n)]


def solution_rate(graph: Graph, node: int, rate: Of) -> int | None:
    """How a solution changes (another one) if its system's numbers change at `rate(node)`; None if not."""
    factor, *right = graph.nodes[node][1:]
    x = graph.items(node)
    changes = []
    for row, b in zip(rows_of(graph, factor), right, strict=True):
        change = rate(b)
        for entry, unknown in zip(row, x, strict=True):
            change = graph.sub(change, graph.mul(rate(entry), unknown))
        changes.append(change)
    if all(graph.value(change) == 0.0 for change in changes):
        return None
    return graph.solved(factor, changes)


def determinant_slopes(graph: Graph, node: int) -> list[tuple[int, int]]:
    """Pairs (entry, derivative of the determinant by it)."""
    factor = graph.nodes[node][1]
    inverse = inverse_columns(graph, factor)
    return [
        (entry, graph.mul(node, inverse[i][j]))
        for i, row in enumerate(rows_of(graph, factor))
        for j, entry in enumerate(row)
        if graph.value(entry) is None
    ]


def inverse_columns(graph: Graph, factor: int) -> list[list[int]]:
    """Nodes of the inverse of a matrix, column by column."""
    n = len(rows_of(graph, factor))
    units = [[graph.one if i == j else graph.zero for i in range(n)] for j in range(n)]
    return [graph.items(graph.solved(factor, unit)) for unit in units]


def solution_bounds(graph: Graph, node: int, bound: Of) -> list[int]:
    """Running error bounds of the numbers of a solution: |A^-1| times what the equations may miss by.

    These are the errors of A and b, and the backward error of elimination, n |A| |x| + |b| (N. J. Higham,
    Accuracy and Stability of Numerical Algorithms, 2nd ed., theorem 9.4, with pivots that do not grow).
    """
    factor, *right = graph.nodes[node][1:]
    x = [graph.call("abs", unknown) for unknown in graph.items(node)]
    rows = graph.constant(float(len(right)))
    missed = []
    for row, b in zip(rows_of(graph, factor), right, strict=True):
        total = graph.add(bound(b), graph.call("abs", b))
        for entry, size in zip(row, x, strict=True):
            share = graph.add(bound(entry), graph.mul(rows, graph.call("abs", entry)))
            total = graph.add(total, graph.mul(share, size))
        missed.append(total)
    found = [graph.zero] * len(right)
    for column, miss in zip(inverse_columns(graph, factor), missed, strict=True):
        for i, entry in enumerate(column):
            found[i] = graph.add(found[i], graph.mul(graph.call("abs", entry), miss))
    return found


def determinant_bound(graph: Graph, node: int, bound: Of) -> int:
    """Running error bound of a determinant."""
    rows = graph.constant(float(len(rows_of(graph, graph.nodes[node][1]))))
    total = graph.mul(rows, graph.call("abs", node))
    for entry, slope in determinant_slopes(graph, node):
        inherited = graph.add(bound(entry), graph.mul(rows, graph.call("abs", entry)))
        total = graph.add(total, graph.mul(graph.call("abs", slope), inherited))
    return total
