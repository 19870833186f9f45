"""The regions into which curves divide a rectangle, on a raster of cells."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

# Cells along both sides, and how many samples of a line fall on each that it passes.
CELLS = (480, 360)
DENSE = 3
# A region of fewer cells is not told from the width of the lines around it.
LEAST_CELLS = 9


@dataclass(frozen=True)
class Raster:
    """Cells of a rectangle.

    Parameters
    ----------
    low, high : ndarray, shape (2,)
        Its corners.
    cells : tuple of int
        Along the first and the second axis.
    """

    low: np.ndarray
    high: np.ndarray
    cells: tuple[int, int] = CELLS

    def center(self, column: int, row: int) -> tuple[float, float]:
        """The middle of a cell."""
        part = (np.array([column, row]) + 0.5) / np.array(self.cells)
        x, y = self.low + part * (self.high - self.low)
        return float(x), float(y)

    def met(self, line: np.ndarray) -> np.ndarray:
        """The cells, shape (k, 2) as column and row, that a line through points, shape (m, 2), passes."""
        places = (line - self.low) / (self.high - self.low) * np.array(self.cells)
        parts = []
        for a, b in pairwise(places):
            count = int(DENSE * np.max(np.abs(b - a))) + 2
            parts.append(a + np.linspace(0.0, 1.0, count)[:, None] * (b - a))
        if not parts:
            return np.zeros((0, 2), dtype=int)
        found = np.floor(np.concatenate(parts)).astype(int)
        # What lies on the rim belongs to the cell inside it.
        rim = np.array(self.cells)
        found = np.where(found == rim, rim - 1, found)
        return found[np.all((found >= 0) & (found < rim), axis=1)]


@dataclass(frozen=True)
class Regions:
    """The regions of a raster.

    Parameters
    ----------
    labels : ndarray of int, shape (rows, columns)
        The number of each cell's region from 0, lines divided among their neighbours; -1 in too small ones.
    inside : tuple of (int, int)
        Of each region column and row of the cell farthest from all lines.
    too_small : int
        How many regions were left out.
    """

    labels: np.ndarray
    inside: tuple[tuple[int, int], ...]
    too_small: int


def regions(raster: Raster, lines: Iterable[np.ndarray]) -> Regions:
    """The regions between lines, each of shape (m, 2)."""
    columns, rows = raster.cells
    free = np.ones((rows, columns), dtype=bool)
    for line in lines:
        met = raster.met(line)
        free[met[:, 1], met[:, 0]] = False
    labels, depth = _connected(free), _depth(free)
    inside: list[tuple[int, int]] = []
    small = 0
    numbered = np.full_like(labels, -1)
    for label in range(int(labels.max(initial=-1)) + 1):
        own = labels == label
        if np.count_nonzero(own) < LEAST_CELLS:
            small += 1
            continue
        row, column = np.unravel_index(int(np.argmax(np.where(own, depth, -1))), own.shape)
        numbered[own] = len(inside)
        inside.append((int(column), int(row)))
    return Regions(_spread(numbered, ~free), tuple(inside), small)


def _connected(free: np.ndarray) -> np.ndarray:
    """Numbers of the connected parts of free cells, -1 of the others, by runs of cells in rows.

    Both have the shape (rows, columns).
    """
    parents: list[int] = []

    def root(k: int) -> int:
        while parents[k] != k:
            parents[k] = parents[parents[k]]
            k = parents[k]
        return k

    runs: list[list[tuple[int, int, int]]] = []
    for row in free:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(np.int8), [0]])))
        row_runs = []
        for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            own = len(parents)
            parents.append(own)
            for low, high, other in runs[-1] if runs else ():
                if low < stop and start < high:
                    parents[root(other)] = root(own)
            row_runs.append((start, stop, own))
        runs.append(row_runs)
    labels = np.full(free.shape, -1)
    names: dict[int, int] = {}
    for number, row_runs in enumerate(runs):
        for start, stop, own in row_runs:
            labels[number, start:stop] = names.setdefault(root(own), len(names))
    return labels


def _depth(free: np.ndarray) -> np.ndarray:
    """How many cells each is from the nearest line or the rim, shape (rows, columns)."""
    depth, left = np.zeros(free.shape, dtype=int), free
    while left.any():
        depth += left
        inner = np.zeros_like(left)
        inner[1:-1, 1:-1] = (
            left[1:-1, 1:-1] & left[:-2, 1:-1] & left[2:, 1:-1] & left[1:-1, :-2] & left[1:-1, 2:]
        )
        left = inner
    return depth


def _spread(labels: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Labels, shape (rows, columns), with cells of lines given to a region beside them."""
    found = labels.copy()
    for _ in range(4):
        padded = np.pad(found, 1, constant_values=-1)
        sides = (padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:])
        best = np.maximum.reduce(sides)
        found = np.where(lines & (found < 0), best, found)
    return found
