"""Triangles over the rows of a sweep, with holes where there is no data.

Neighbouring rows are joined strip by strip. Before that `contwalk.plotting.strip` settles what belongs
together: the ends of the data, and the zeros of the value in between. From one such point to the next a strip
is a cell, a quadrilateral with its corners on the rows. So the border of stability and the edge of the data,
at a fold for instance, run straight from row to row; a triangulation that knows nothing of them makes steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.tri import Triangulation

from contwalk.errors import ContwalkError
from contwalk.plotting.strip import Cell, cells
from contwalk.plotting.sweep import Row

# Two rows this much farther apart than usual have a row missing between them.
SLACK = 1.5
# A zero nearer than this to a row's own point, relative to the interval, is that point: a located one.
SAME_POINT = 1e-6


def triangulate(rows: Sequence[Row]) -> tuple[Triangulation, np.ndarray]:
    """Triangles between neighbouring rows, and the value at their k corners, shape (k,).

    No triangle bridges a hole in the data, along a branch or between two.

    Raises
    ------
    ContwalkError
        If no triangle lies between data.
    """
    rows = [_with_zeros(row) for row in rows]
    strips = [
        [] if gap else list(cells(*pair)) for gap, pair in zip(_missing(rows), pairwise(rows), strict=True)
    ]
    rows = [_with_points(row, _corners(strips, i)) for i, row in enumerate(rows)]
    first = np.cumsum([0, *(len(row.x) for row in rows)])
    triangles = [
        triangle
        for i, strip in enumerate(strips)
        for cell in strip
        for triangle in _zip(_part(rows[i], cell[0], first[i]), _part(rows[i + 1], cell[1], first[i + 1]))
    ]
    x = np.concatenate([row.x for row in rows])
    y = np.concatenate([np.full(len(row.x), row.level) for row in rows])
    if not triangles:
        raise ContwalkError(
            "The branches of the sweep do not lie next to each other.",
            "Compute branches of two points or more each, over the same range of the free parameter, at more "
            "values of the swept one.",
        )
    return Triangulation(x, y, np.array(triangles)), np.concatenate([row.value for row in rows])


def _with_zeros(row: Row) -> Row:
    """The row with its zeros as points: inserted, or a point that lies on one set to zero."""
    value, zeros = row.value.copy(), []
    positive = value > 0
    for i in np.flatnonzero((positive[1:] != positive[:-1]) & row.covered):
        share = value[i] / (value[i] - value[i + 1])
        zeros.append((i, share))
    for i, share in zeros:
        if min(share, 1.0 - share) < SAME_POINT:
            value[i + round(share)] = 0.0
    inside = [row.x[i] + t * (row.x[i + 1] - row.x[i]) for i, t in zeros if SAME_POINT <= t <= 1 - SAME_POINT]
    made = _with_points(Row(row.level, row.x, value, row.covered), inside)
    made.value[np.isin(made.x, inside)] = 0.0
    return made


def _with_points(row: Row, x: Sequence[float]) -> Row:
    """The row with points of interpolation at these x, which lie within its data."""
    joined = np.union1d(row.x, x)
    interval = np.clip(np.searchsorted(row.x, joined[:-1], side="right") - 1, 0, max(len(row.covered) - 1, 0))
    return Row(row.level, joined, np.interp(joined, row.x, row.value), row.covered[interval])


def _missing(rows: Sequence[Row]) -> np.ndarray:
    """Whether a row is missing between each and the next."""
    gaps = np.diff(_even(np.array([row.level for row in rows])))
    return np.asarray(gaps > SLACK * np.median(gaps))


def _even(levels: np.ndarray) -> np.ndarray:
    """The swept values, or their logarithms where those are spaced more evenly."""
    if levels[0] <= 0 or len(levels) < 3:
        return levels
    logs = np.log(levels)

    def unevenness(v: np.ndarray) -> float:
        return float(np.diff(v).max() / np.median(np.diff(v)))

    return logs if unevenness(logs) < unevenness(levels) else levels


def _corners(strips: Sequence[Sequence[Cell]], row: int) -> list[float]:
    """All x at which cells have corners on this row."""
    above = [x for cell in strips[row] for x in cell[0]] if row < len(strips) else []
    below = [x for cell in strips[row - 1] for x in cell[1]] if row else []
    return above + below


def _part(row: Row, ends: tuple[float, float], first: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the row's points between the ends of a cell, and their positions in it, 0 to 1."""
    a, b = np.searchsorted(row.x, ends)
    width = ends[1] - ends[0]
    position = (row.x[a : b + 1] - ends[0]) / width if width else np.zeros(b + 1 - a)
    return first + np.arange(a, b + 1), position


def _zip(lower: tuple[np.ndarray, np.ndarray], upper: tuple[np.ndarray, np.ndarray]) -> Iterator[list[int]]:
    """Triangles of a cell: the row whose next point comes first goes on by one."""
    (low, s), (up, t) = lower, upper
    i = j = 0
    while i + 1 < len(low) or j + 1 < len(up):
        if j + 1 == len(up) or (i + 1 < len(low) and s[i + 1] <= t[j + 1]):
            yield [low[i], low[i + 1], up[j]]
            i += 1
        else:
            yield [low[i], up[j + 1], up[j]]
            j += 1
