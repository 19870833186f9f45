"""Gaussian elimination leg by leg, in loops that numba compiles; see `condensed`.

The matrix is row-major. Its first `chain` columns belong to the inner legs, in their order; a leg's columns
meet a known range of rows, and the last rows, which close the orbit. So each pivot is looked for in its leg's
rows, and a row operation touches that leg's columns, the next leg's, and the common ones.

A stage is three integers: where its columns end, where the rows that meet them end, and where the columns end
that its rows meet.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, integers


@partial(inlined, inline="always")
def _part(matrix: int, width: int, i: int, first: int, length: int) -> np.ndarray:
    """Part of a row, counted from 0: loops over it become vector instructions."""
    return doubles(matrix + 8 * (i * width + first), length)


@partial(inlined, inline="always")
def _row(matrix: int, width: int, i: int) -> np.ndarray:
    return _part(matrix, width, i, 0, width)


@inlined
def _scale(matrix: int, rows: int, width: int, weights: Any, scales: Any) -> None:
    """Columns in units of the unknowns; rows, but for those of zeros, to a largest entry of one."""
    for i in range(rows):
        row, largest = _row(matrix, width, i), 0.0
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
        _subtract(_part(matrix, width, i, k + 1, own), multiple, _part(matrix, width, k, k + 1, own), own)
        _subtract(
            _part(matrix, width, i, chain, common), multiple, _part(matrix, width, k, chain, common), common
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
                one, other = _part(matrix, width, k, k, rest), _part(matrix, width, best, k, rest)
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
            source, other = _row(right, columns, k), _row(right, columns, chosen[k])
            if chosen[k] != k:
                for j in range(columns):
                    source[j], other[j] = other[j], source[j]
            for i in range(k + 1, stage[3 * s + 1]):
                _subtract(_row(right, columns, i), a[i * width + k], source, columns)
            for i in range(last, rows):
                _subtract(_row(right, columns, i), a[i * width + k], source, columns)
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
            target = _row(right, columns, k)
            for i in range(k + 1, stage[3 * s + 1]):
                _subtract(target, a[i * width + k], _row(right, columns, i), columns)
            for i in range(last, rows):
                _subtract(target, a[i * width + k], _row(right, columns, i), columns)
            if chosen[k] != k:
                other = _row(right, columns, chosen[k])
                for j in range(columns):
                    target[j], other[j] = other[j], target[j]
    return 0


def backward(matrix: int, width: int, count: int, stages: int, right: int, columns: int) -> int:
    """Solve with the triangle of the inner legs, shape (chain, columns)."""
    stage = integers(stages, 3 * count)
    for s in range(count - 1, -1, -1):
        first, met = stage[3 * s - 3] if s > 0 else 0, stage[3 * s + 2]
        for k in range(stage[3 * s] - 1, first - 1, -1):
            target, row = _row(right, columns, k), _row(matrix, width, k)
            for j in range(k + 1, met):
                _subtract(target, row[j], _row(right, columns, j), columns)
            for c in range(columns):
                target[c] /= row[k]
    return 0


def backward_transposed(matrix: int, width: int, count: int, stages: int, right: int, columns: int) -> int:
    """Solve with the transpose of the triangle of the inner legs."""
    stage, k = integers(stages, 3 * count), 0
    for s in range(count):
        met = stage[3 * s + 2]
        while k < stage[3 * s]:
            source, row = _row(right, columns, k), _row(matrix, width, k)
            for c in range(columns):
                source[c] /= row[k]
            for j in range(k + 1, met):
                _subtract(_row(right, columns, j), row[j], source, columns)
            k += 1
    return 0
