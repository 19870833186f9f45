"""Where labels go: a search for positions that overlap nothing.

Each label chooses among positions around its point the one of least cost: leaving the axes is dearest, then
overlap with another label, then lying on a marker, a curve or a leader line, and distance. Labels with the
most neighbours choose first; then all choose again, a few times, knowing where the others are. Where some
still find no bearable place, all are placed anew, the first ones first, and those without a place are left
out. Pure geometry: lengths are in pixels unless said otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

SWEEPS = 4
SHORT_LIST = 20
# Gaps between a point and its label, and the directions tried, those of reading order first.
RADII_IN_POINTS = (4.5, 8.0, 13.0, 20.0, 29.0, 41.0, 56.0, 75.0, 98.0, 125.0)
DIRECTIONS = np.deg2rad([45, 90, 135, 0, 180, 315, 270, 225, 22, 67, 112, 157, 202, 247, 292, 337])
RANKS = 0.4 * np.tile(np.arange(len(DIRECTIONS)), len(RADII_IN_POINTS))  # cost of what is read less well
CELL = 2.0  # of the grid that holds the curves
FAR = 1e5  # pixels that no screen has

# Costs in points of distance; the curve's is for each point of its length under the label.
OUTSIDE, OVERLAP, MARKER, CURVE, LEADER_BOX, LEADER_CROSSING = 9000.0, 4000.0, 60.0, 2.5, 60.0, 45.0
BEARABLE = 150.0  # more than this a label must not cost


class Ink:
    """How much curve lies in a box, from a summed-area table of the curves' pixels."""

    def __init__(self, frame: np.ndarray, curves: Sequence[np.ndarray]) -> None:
        self.origin = frame[0]
        self.shape = np.maximum(np.ceil((frame[1] - frame[0]) / CELL).astype(int), 1)
        grid = np.zeros(self.shape)
        for curve in curves:
            cells = np.floor((_dense(curve) - self.origin) / CELL).astype(int)
            inside = np.all((cells >= 0) & (cells < self.shape), axis=1)
            grid[cells[inside, 0], cells[inside, 1]] = 1.0
        self.table = np.zeros(self.shape + 1)
        self.table[1:, 1:] = grid.cumsum(axis=0).cumsum(axis=1)

    def inside(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Length of curve in each of the boxes, whose corners have the shape (c, 2)."""
        a = np.clip(np.floor((low - self.origin) / CELL).astype(int), 0, self.shape)
        b = np.clip(np.ceil((high - self.origin) / CELL).astype(int), 0, self.shape)
        t = self.table
        return CELL * (t[b[:, 0], b[:, 1]] - t[a[:, 0], b[:, 1]] - t[b[:, 0], a[:, 1]] + t[a[:, 0], a[:, 1]])


def _dense(pixels: np.ndarray) -> np.ndarray:
    """Points of a polyline no farther apart than a cell; what is not finite or far away is left out."""
    parts = [pixels[(np.abs(pixels) < FAR).all(axis=1)]]
    for start, end in pairwise(pixels):
        if not (np.isfinite(start).all() and np.isfinite(end).all()):
            continue
        length = np.hypot(*(end - start))
        if CELL < length < FAR:
            steps = np.linspace(0.0, 1.0, int(length / CELL) + 2)[1:-1, None]
            parts.append(start + steps * (end - start))
    return np.concatenate(parts)


class Placement:
    """The search for the centres of the labels, of shape (n, 2).

    Parameters
    ----------
    anchors, sizes : arrays of shape (n, 2)
        Points that are labelled, widths and heights of the texts.
    frame : array of shape (2, 2)
        Lower left and upper right corner of the axes.
    ink : Ink
    scale : float
        Pixels in a point.
    """

    def __init__(
        self, anchors: np.ndarray, sizes: np.ndarray, frame: np.ndarray, ink: Ink, scale: float
    ) -> None:
        self.anchors, self.sizes, self.frame, self.ink, self.scale = anchors, sizes, frame, ink, scale
        self.half = sizes / 2 + 1.0 * scale  # one point of air around each text
        self.centres = np.full_like(anchors, np.nan)

    def solve(self) -> np.ndarray:
        """Centres of least cost found, shape (n, 2), in pixels; NaN where there is no room for a label."""
        distances = np.hypot(*(self.anchors[:, None] - self.anchors[None]).transpose(2, 0, 1))
        order = np.argsort(-(distances < 45 * self.scale).sum(axis=1), kind="stable")
        self._sweep(order)
        if max(self._cost(label) for label in order) > BEARABLE:
            self._choose()
        return self.centres

    def _sweep(self, order: Sequence[int] | np.ndarray) -> None:
        for _ in range(SWEEPS):
            previous = self.centres.copy()
            for label in order:
                self.centres[label] = self._best(label)[0]
            if np.array_equal(previous, self.centres, equal_nan=True):
                break

    def _choose(self) -> None:
        """Place labels in their order, as long as there is room; those that have a place choose again."""
        self.centres[:] = np.nan
        kept = []
        for label in range(len(self.anchors)):
            centre, cost = self._best(label)
            if cost <= BEARABLE:
                self.centres[label] = centre
                kept.append(label)
        self._sweep(kept)

    def _cost(self, label: int) -> float:
        """What a label costs where it is."""
        others = self._others(label)
        centre = self.centres[label][None]
        box, leaders = self._cost_of_box(label, centre, others), self._cost_of_leaders(label, centre, others)
        return float(box[0] + leaders[0])

    def _others(self, label: int) -> np.ndarray:
        return np.flatnonzero(np.isfinite(self.centres[:, 0]) & (np.arange(len(self.centres)) != label))

    def _candidates(self, label: int) -> np.ndarray:
        direction = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], axis=1)
        reach = np.sign(np.round(direction, 3)) * self.sizes[label] / 2
        gaps = np.array(RADII_IN_POINTS)[:, None, None] * self.scale
        return (self.anchors[label] + gaps * direction + reach).reshape(-1, 2)

    def _best(self, label: int) -> tuple[np.ndarray, float]:
        """The candidate of least cost; leader lines are looked at only for those that are good without."""
        centres, others = self._candidates(label), self._others(label)
        cost = self._cost_of_box(label, centres, others) + RANKS
        good = np.argsort(cost, kind="stable")[:SHORT_LIST]
        total = cost[good] + self._cost_of_leaders(label, centres[good], others)
        return centres[good[np.argmin(total)]], float(total.min())

    def _cost_of_box(self, label: int, centres: np.ndarray, others: np.ndarray) -> np.ndarray:
        half = self.half[label]
        low, high = centres - half, centres + half
        cost = np.hypot(*(centres - self.anchors[label]).T) / self.scale
        outside = np.maximum(self.frame[0] - low, 0) + np.maximum(high - self.frame[1], 0)
        cost += OUTSIDE * (outside.sum(axis=1) > 0)
        cost += CURVE * self.ink.inside(low, high) / self.scale
        markers = np.abs(self.anchors[None] - centres[:, None]) < half + 3.0 * self.scale
        cost += MARKER * markers.all(axis=2).sum(axis=1)
        over = half + self.half[others] - np.abs(centres[:, None] - self.centres[others][None])
        return cost + OVERLAP * (over > 0).all(axis=2).sum(axis=1)

    def _cost_of_leaders(self, label: int, centres: np.ndarray, others: np.ndarray) -> np.ndarray:
        anchor, half = self.anchors[label], self.half[label]
        placed, starts = self.centres[others], self.anchors[others]
        along = np.linspace(0.1, 0.9, 7)[None, :, None]
        mine = anchor + along * (centres - anchor)[:, None]
        hits = (np.abs(mine[:, :, None] - placed[None, None]) < self.half[others]).all(axis=3)
        theirs = starts[:, None] + along * (placed - starts)[:, None]
        covers = (np.abs(theirs[None] - centres[:, None, None]) < half).all(axis=3)
        crossing = _cross(anchor, centres, starts, placed)
        under = hits.any(axis=1).sum(axis=1) + covers.any(axis=2).sum(axis=1)
        return LEADER_BOX * under + LEADER_CROSSING * crossing.sum(axis=1)


def _cross(start: np.ndarray, ends: np.ndarray, starts: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Whether the segments start-ends (c) cross the segments starts-targets (n), of shape (c, n)."""

    def side(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
        u, v = b - a, c - a
        return np.sign(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    mine, theirs_a, theirs_b = ends[:, None], starts[None], targets[None]
    first = side(start, mine, theirs_a) * side(start, mine, theirs_b)
    second = side(theirs_a, theirs_b, start[None, None]) * side(theirs_a, theirs_b, mine)
    return (first < 0) & (second < 0)
