"""Triangles over the rows of a sweep, with holes where there is no data."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.tri import Triangulation

from contwalk.errors import ContwalkError
from contwalk.plotting.sweep import Row

# Two rows this much farther apart than usual have a row missing between them.
SLACK = 1.5
BORDER_POINTS = 9  # between two rows


def triangulate(rows: Sequence[Row]) -> tuple[Triangulation, np.ndarray]:
    """Triangles between neighbouring rows, and the value at their corners.

    Those that bridge a hole in the data, along a branch or between two, are masked.

    Raises
    ------
    ContwalkError
        If no triangle lies between data.
    """
    levels = np.array([row.level for row in rows])
    scale = _even(levels)
    gaps = np.diff(scale)
    missing = gaps > SLACK * np.median(gaps)
    # A point's height is the number of its row, a fraction for a point of the border between two.
    parts = [np.stack([row.x, np.full(len(row.x), float(i)), row.value]) for i, row in enumerate(rows)]
    parts += _borders(rows, missing)
    x, height, value = np.concatenate(parts, axis=1)
    number = np.arange(len(rows))
    scaled = np.interp(height, number, scale)
    try:
        flat = Triangulation(x / (np.ptp(x) or 1.0), scaled / np.ptp(scaled))
    except (RuntimeError, ValueError) as error:
        raise ContwalkError(
            "The points of the sweep do not span an area.", "Compute branches of two points or more each."
        ) from error
    corners = flat.triangles
    mask = _holes(rows, missing, x[corners], height[corners])
    if mask.all():
        raise ContwalkError(
            "The branches of the sweep do not lie next to each other.",
            "Compute them over the same range of the free parameter, at more values of the swept one.",
        )
    return Triangulation(x, np.interp(height, number, levels), corners, mask=mask), value


def _holes(rows: Sequence[Row], missing: np.ndarray, x: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Which of the triangles, whose corners have the shape (t, 3), lie over a hole at their centres."""
    centre = x.mean(axis=1)
    lower = np.clip(height.mean(axis=1).astype(int), 0, len(rows) - 2)
    hole = (np.ptp(height, axis=1) > 1.0) | missing[lower]
    for i in range(len(rows) - 1):
        strip = np.flatnonzero(lower == i)
        covered = rows[i].covers(centre[strip]) & rows[i + 1].covers(centre[strip])
        hole[strip] |= ~covered
    return hole


def _borders(rows: Sequence[Row], missing: np.ndarray) -> list[np.ndarray]:
    """Points of value zero on the straight lines between the zeros of neighbouring rows, as arrays (3, k).

    Without them the border would run in steps, since triangles know nothing of it. Rows whose zeros do not
    correspond one to one have none in between.
    """
    share = np.linspace(0.0, 1.0, BORDER_POINTS + 2)[1:-1]
    result = []
    for i, (lower, upper) in enumerate(pairwise(rows)):
        (starts, signs), (ends, signs_above) = lower.zeros(), upper.zeros()
        if missing[i] or not np.array_equal(signs, signs_above):
            continue
        for start, end in zip(starts, ends, strict=True):
            result.append(np.stack([start + share * (end - start), i + share, np.zeros_like(share)]))
    return result


def _even(levels: np.ndarray) -> np.ndarray:
    """The swept values, or their logarithms where those are spaced more evenly."""
    if levels[0] <= 0 or len(levels) < 3:
        return levels
    logs = np.log(levels)

    def unevenness(v: np.ndarray) -> float:
        return float(np.diff(v).max() / np.median(np.diff(v)))

    return logs if unevenness(logs) < unevenness(levels) else levels
