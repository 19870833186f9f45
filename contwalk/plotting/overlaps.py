"""Which parts of a curve lie on what is drawn already.

Mirror images of a motion lie over one another in most diagrams. Dashes drawn twice fill each other's gaps,
and what is unstable then looks stable; so what would be drawn again is left out. Pure geometry, on a grid
of small cells, each of which knows in which directions curves pass through it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

# The plane as it is printed, in points; a larger figure is not sharper than this.
PRINTED = np.array([400.0, 240.0])
CELL = 0.35  # points: a curve lies on another one in the same cell or the next one
SPACING = 0.25  # points between samples of a curve
DIRECTIONS = 12  # that are told apart, half a turn around
CHUNK = 16  # samples; a curve may lie on itself, but not on what it has only just left
SHORTEST = 12.0  # points: shorter parts are crossings
FARTHEST = 8  # widths of the plane beyond which nothing is looked at


@dataclass(frozen=True)
class _Samples:
    """Samples along a curve: places in points, directions as numbers, and where they are in the curve."""

    places: np.ndarray
    directions: np.ndarray
    at: np.ndarray


class Cover:
    """What is drawn in a part of the plane, from the corner `low` to the corner `high`."""

    def __init__(self, low: np.ndarray, high: np.ndarray) -> None:
        self._low = np.asarray(low, dtype=float)
        size = np.asarray(high, dtype=float) - self._low
        self._scale = PRINTED / np.where(size > 0.0, size, 1.0)
        shape = np.ceil(PRINTED / CELL).astype(int) + 3
        self._grid = np.zeros(shape, dtype=np.int32)

    def bare(self, points: np.ndarray) -> list[np.ndarray]:
        """The parts of a curve, shape (k, 2), that lie on nothing yet; they are covered from now on."""
        samples = self._sampled(points)
        return _parts(points, samples, self._found(samples, add=True), covered=False)

    def shared(self, points: np.ndarray, shortest: float = SHORTEST) -> list[np.ndarray]:
        """The parts, shape (j, 2) each, of a curve, shape (k, 2), that lie on what is drawn already."""
        samples = self._sampled(points)
        return _parts(points, samples, self._found(samples, add=False), covered=True, shortest=shortest)

    def _sampled(self, points: np.ndarray) -> _Samples:
        printed = (points - self._low) * self._scale
        steps = np.diff(printed, axis=0)
        lengths = np.hypot(*steps.T)
        near = np.abs(printed) < FARTHEST * PRINTED.max()
        usable = np.isfinite(lengths) & (lengths > 0.0) & near[:-1].all(axis=1) & near[1:].all(axis=1)
        counts = np.where(usable, np.ceil(np.where(usable, lengths, 0.0) / SPACING), 0).astype(int)
        segment = np.repeat(np.arange(len(counts)), counts)
        first = np.repeat(np.cumsum(counts) - counts, counts)
        share = (np.arange(len(segment)) - first + 0.5) / np.maximum(counts[segment], 1)
        places = printed[segment] + share[:, None] * steps[segment]
        angle = np.arctan2(steps[segment, 1], steps[segment, 0]) / np.pi * DIRECTIONS
        return _Samples(places, np.round(angle).astype(int) % DIRECTIONS, segment + share)

    def _found(self, samples: _Samples, *, add: bool) -> np.ndarray:
        """Whether each sample lies on what is drawn; `add` draws them, with a delay of a chunk."""
        cells = np.floor(samples.places / CELL).astype(int) + 1
        inside = np.all((cells >= 1) & (cells < np.array(self._grid.shape) - 1), axis=1)
        found = np.zeros(len(cells), dtype=bool)
        if not add:
            found[inside] = self._crossed(cells[inside], samples.directions[inside])
            return found
        late: list[slice] = []
        for start in range(0, len(cells), CHUNK):
            part = slice(start, start + CHUNK)
            own = inside[part]
            found[part][own] = self._crossed(cells[part][own], samples.directions[part][own])
            late.append(part)
            if len(late) > 2:
                self._add(cells, samples.directions, inside, late.pop(0))
        for part in late:
            self._add(cells, samples.directions, inside, part)
        return found

    def _add(self, cells: np.ndarray, directions: np.ndarray, inside: np.ndarray, part: slice) -> None:
        x, y = cells[part][inside[part]].T
        np.bitwise_or.at(self._grid, (x, y), 1 << directions[part][inside[part]])

    def _crossed(self, cells: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Whether a line of nearly these directions passes through these cells or their neighbours."""
        around = np.zeros(len(cells), dtype=np.int32)
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                around |= self._grid[cells[:, 0] + dx, cells[:, 1] + dy]
        turns = [(directions + turn) % DIRECTIONS for turn in (-1, 0, 1)]
        return np.any([around & (1 << turn) for turn in turns], axis=0)


def _parts(
    points: np.ndarray, samples: _Samples, found: np.ndarray, *, covered: bool, shortest: float = SHORTEST
) -> list[np.ndarray]:
    """The covered parts of a curve, or the others; the whole curve as it is where no part is covered."""
    found = _without_gaps(found)
    found = _without_short(found, shortest)
    if not found.any():
        return [] if covered else [points]
    edges = np.flatnonzero(np.diff(found)) + 1
    borders = [0.0, *(0.5 * (samples.at[edges - 1] + samples.at[edges])), len(points) - 1.0]
    flags = found[[0, *edges]]
    return [
        _between(points, start, end)
        for (start, end), flag in zip(pairwise(borders), flags, strict=True)
        if flag == covered
    ]


def _without_gaps(found: np.ndarray) -> np.ndarray:
    """The flags, with short interruptions filled."""
    filled = found.copy()
    for start, end in _runs(~found):
        if start > 0 and end < len(found) and (end - start) * SPACING < 0.5 * SHORTEST:
            filled[start:end] = True
    return filled


def _without_short(found: np.ndarray, shortest: float) -> np.ndarray:
    """The flags, without parts that are shorter than this."""
    kept = found.copy()
    for start, end in _runs(found):
        if (end - start) * SPACING < shortest:
            kept[start:end] = False
    return kept


def _runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """Where flags are set without interruption."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _between(points: np.ndarray, start: float, end: float) -> np.ndarray:
    """The part of a curve between two places, each the number of a point and a share of what follows."""
    inner = points[int(np.floor(start)) + 1 : int(np.ceil(end))]
    return np.vstack([_at(points, start), inner, _at(points, end)])


def _at(points: np.ndarray, place: float) -> np.ndarray:
    row = min(int(place), len(points) - 2)
    share = place - row
    return points[row + 1] if share == 1.0 else points[row] + share * (points[row + 1] - points[row])
