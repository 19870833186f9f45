"""Gaussian elimination leg by leg, in loops that numba compiles; see `condensed`.

The matrix is row-major. Its first `chain` columns belong to the inner legs, in their order; a leg's columns
meet a known range of rows, and the last rows, which close the orbit. So each pivot is looked for in its leg's
rows, and a row operation touches that leg's columns, the next leg's, and the common ones.

A stage is three integers: where its columns end, where the rows that meet them end, and where the columns end
that its rows meet.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, integers


@inlined
def _at(matrix: int, width: int, i: int, first: int) -> int:
    """Address of an entry. Parts of rows are counted from 0: loops over them become vector instructions."""
    return matrix + 8 * (i * width + first)


@inlined
def _scale(matrix: int, rows: int, width: int, weights: Any, scales: Any) -> None:
    """Columns in units of the unknowns; rows, but for those of zeros, to a largest entry of one."""
    for i in range(rows):
        row, largest = doubles(_at(matrix, width, i, 0), width), 0.0
        for j in range(width):
            row[j] *= weights[j]
        for j in range(width):
            largest = max(largest, abs(row[j]))
        scales[i] = 1.0 / largest if largest > 0.0 else 1.0
        for j in range(width):
            row[j] *= scales[i]


@inlined
def _subtract(target: np.ndarray, multiple: float, source: np.ndarray, length: int) -> None:
    for j in range(length):
        target[j] -= multiple * source[j]


@inlined
def _reduce(matrix: int, width: int, k: int, i: int, met: int, chain: int) -> None:
    """Take a multiple of pivot row k from row i; the multiple is kept in its place."""
    a = doubles(matrix, (i + 1) * width if i > k else (k + 1) * width)
    multiple = a[i * width + k] / a[k * width + k]
    if multiple != 0.0:
        a[i * width + k] = multiple
        own, common = met - k - 1, width - chain
        _subtract(
            doubles(_at(matrix, width, i, k + 1), own),
            multiple,
            doubles(_at(matrix, width, k, k + 1), own),
            own,
        )
        _subtract(
            doubles(_at(matrix, width, i, chain), common),
            multiple,
            doubles(_at(matrix, width, k, chain), common),
            common,
        )


def eliminate(
    matrix: int, rows: int, width: int, count: int, stages: int, weights: int, scales: int, pivots: int
) -> float:
    """Scale, and eliminate the inner legs; the sign of their part of the determinant, 0 if it is singular."""
    stage, chosen = integers(stages, 3 * count), integers(pivots, rows)
    a, sign, k = doubles(matrix, rows * width), 1.0, 0
    _scale(matrix, rows, width, doubles(weights, width), doubles(scales, rows))
    chain, last = stage[3 * count - 3], stage[3 * count - 2]
    for s in range(count):
        end, met = stage[3 * s + 1], stage[3 * s + 2]
        while k < stage[3 * s]:
            best, size = k, abs(a[k * width + k])
            for i in range(k + 1, end):
                if abs(a[i * width + k]) > size:
                    best, size = i, abs(a[i * width + k])
            if not (0.0 < size < np.inf):
                return 0.0
            chosen[k] = best
            if best != k:
                rest = width - k  # multiples stay where they are: they are applied between exchanges
                one, other = (
                    doubles(_at(matrix, width, k, k), rest),
                    doubles(_at(matrix, width, best, k), rest),
                )
                for j in range(rest):
                    one[j], other[j] = other[j], one[j]
                sign = -sign
            if a[k * width + k] < 0.0:
                sign = -sign
            for i in range(k + 1, end):
                _reduce(matrix, width, k, i, met, chain)
            for i in range(last, rows):
                _reduce(matrix, width, k, i, met, chain)
            k += 1
    return sign


def forward(
    matrix: int, rows: int, width: int, count: int, stages: int, pivots: int, right: int, columns: int
) -> int:
    """The row operations of `eliminate` on right-hand sides, shape (rows, columns)."""
    stage, chosen, a = integers(stages, 3 * count), integers(pivots, rows), doubles(matrix, rows * width)
    last, k = stage[3 * count - 2], 0
    for s in range(count):
        while k < stage[3 * s]:
            source, other = (
                doubles(_at(right, columns, k, 0), columns),
                doubles(_at(right, columns, chosen[k], 0), columns),
            )
            if chosen[k] != k:
                for j in range(columns):
                    source[j], other[j] = other[j], source[j]
            for i in range(k + 1, stage[3 * s + 1]):
                _subtract(doubles(_at(right, columns, i, 0), columns), a[i * width + k], source, columns)
            for i in range(last, rows):
                _subtract(doubles(_at(right, columns, i, 0), columns), a[i * width + k], source, columns)
            k += 1
    return 0


def forward_transposed(
    matrix: int, rows: int, width: int, count: int, stages: int, pivots: int, right: int, columns: int
) -> int:
    """The transpose of `forward`."""
    stage, chosen, a = integers(stages, 3 * count), integers(pivots, rows), doubles(matrix, rows * width)
    last = stage[3 * count - 2]
    for s in range(count - 1, -1, -1):
        first = stage[3 * s - 3] if s > 0 else 0
        for k in range(stage[3 * s] - 1, first - 1, -1):
            target = doubles(_at(right, columns, k, 0), columns)
            for i in range(k + 1, stage[3 * s + 1]):
                _subtract(target, a[i * width + k], doubles(_at(right, columns, i, 0), columns), columns)
            for i in range(last, rows):
                _subtract(target, a[i * width + k], doubles(_at(right, columns, i, 0), columns), columns)
            if chosen[k] != k:
                other = doubles(_at(right, columns, chosen[k], 0), columns)
                for j in range(columns):
                    target[j], other[j] = other[j], target[j]
    return 0


def backward(matrix: int, width: int, count: int, stages: int, right: int, columns: int) -> int:
    """Solve with the triangle of the inner legs, shape (chain, columns)."""
    stage = integers(stages, 3 * count)
    for s in range(count - 1, -1, -1):
        first, met = stage[3 * s - 3] if s > 0 else 0, stage[3 * s + 2]
        for k in range(stage[3 * s] - 1, first - 1, -1):
            target, row = (
                doubles(_at(right, columns, k, 0), columns),
                doubles(_at(matrix, width, k, 0), width),
            )
            for j in range(k + 1, met):
                _subtract(target, row[j], doubles(_at(right, columns, j, 0), columns), columns)
            for c in range(columns):
                target[c] /= row[k]
    return 0


def backward_transposed(matrix: int, width: int, count: int, stages: int, right: int, columns: int) -> int:
    """Solve with the transpose of the triangle of the inner legs."""
    stage, k = integers(stages, 3 * count), 0
    for s in range(count):
        met = stage[3 * s + 2]
        while k < stage[3 * s]:
            source, row = (
                doubles(_at(right, columns, k, 0), columns),
                doubles(_at(matrix, width, k, 0), width),
            )
            for c in range(columns):
                source[c] /= row[k]
            for j in range(k + 1, met):
                _subtract(doubles(_at(right, columns, j, 0), columns), row[j], source, columns)
            k += 1
    return 0
