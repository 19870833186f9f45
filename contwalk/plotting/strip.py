"""What belongs together on two neighbouring rows of a sweep: the ends of their data, zeros and extrema."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from contwalk.plotting.sweep import Row

# Intervals that belong together, on the lower row and on the upper.
Interval = tuple[float, float]
Cell = tuple[Interval, Interval]
# Places and signs.
Features = list[tuple[float, bool]]

# Of an extremum: its depth relative to the range of the values on its row, and how far it moves in its cell.
PROMINENCE, NEAR = 0.02, 0.15


def cells(lower: Row, upper: Row) -> Iterator[Cell]:
    """The cells of the strip between two rows, by growing x."""
    below, above = _intervals(lower), _intervals(upper)
    for a in below:
        for b in above:
            if min(a[1], b[1]) <= max(a[0], b[0]):
                continue
            # Two pieces that overlap no other belong together with their ends; else what they share does.
            partners = sum(_overlap(a, other) for other in above) + sum(_overlap(b, other) for other in below)
            common = max(a[0], b[0]), min(a[1], b[1])
            ends = (a, b) if partners == 2 else (common, common)
            for cell in _split(ends, lower, upper, _zeros):
                yield from _split(cell, lower, upper, _extrema)


def _split(
    cell: Cell, lower: Row, upper: Row, features: Callable[[Row, Interval], Features]
) -> Iterator[Cell]:
    """The cell cut at those features of the two rows that correspond."""
    inner = _matched(features(lower, cell[0]), features(upper, cell[1]))
    if features is _extrema:  # one that jumps is another
        reach = NEAR * max(b - a for a, b in cell)
        inner = [pair for pair in inner if abs(pair[0] - pair[1]) <= reach]
    corners = [(cell[0][0], cell[1][0]), *inner, (cell[0][1], cell[1][1])]
    yield from (((p[0], q[0]), (p[1], q[1])) for p, q in pairwise(corners))


def _intervals(row: Row) -> list[Interval]:
    """The intervals of x that have data throughout."""
    breaks = np.flatnonzero(~row.covered)
    starts, ends = [0, *(breaks + 1)], [*breaks, len(row.x) - 1]
    return [(float(row.x[a]), float(row.x[b])) for a, b in zip(starts, ends, strict=True) if b > a]


def _overlap(a: Interval, b: Interval) -> bool:
    return min(a[1], b[1]) > max(a[0], b[0])


def _zeros(row: Row, ends: Interval) -> Features:
    """Changes of sign strictly between the ends: where, and whether the value is positive after."""
    inside = np.flatnonzero((row.x >= ends[0]) & (row.x <= ends[1]))
    found = []
    side = None  # of the last value that was not zero
    zero = None
    for i in inside:
        if row.value[i] == 0.0:
            zero = float(row.x[i])
            continue
        now = bool(row.value[i] > 0)
        if side is not None and now != side and zero is not None and zero > ends[0]:
            found.append((zero, now))
        side, zero = now, None
    return found


def _extrema(row: Row, ends: Interval) -> Features:
    """Extrema strictly between the ends, kinks above all: where, and whether it is a minimum.

    Those less than `PROMINENCE` deep are none: along a flat part rounding makes them.
    """
    inside = (row.x >= ends[0]) & (row.x <= ends[1])
    x, value = row.x[inside], row.value[inside]
    turns = [0, *(np.flatnonzero(np.diff(value[:-1]) * np.diff(value[1:]) < 0) + 1), len(x) - 1]
    least = PROMINENCE * np.ptp(row.value)
    while len(turns) > 2:
        depth = np.abs(np.diff(value[turns]))
        shallow = int(np.argmin(depth))
        if depth[shallow] > least:
            break
        # A shallow turn goes with its partner; next to an end alone, for the ends stay.
        last = len(turns) - 2
        drop = {k for k in (shallow, shallow + 1) if 1 <= k <= last}
        turns = [turn for k, turn in enumerate(turns) if k not in drop]
    return [(float(x[b]), bool(value[b] < value[a])) for a, b in pairwise(turns[:-1])]


def _matched(lower: Features, upper: Features) -> list[tuple[float, float]]:
    """Features that correspond, as pairs of x.

    Where one row has more, a block of neighbours is left out: the one that leaves the others nearest.
    """
    swap = len(lower) > len(upper)
    few, many = (upper, lower) if swap else (lower, upper)
    extra = len(many) - len(few)
    best: list[tuple[float, float]] = []
    least = np.inf
    for at in range(len(few) + 1):
        kept = many[:at] + many[at + extra :]
        distance = sum(abs(p[0] - q[0]) for p, q in zip(few, kept, strict=True))
        if [sign for _, sign in kept] == [sign for _, sign in few] and distance < least:
            least, best = distance, [(p[0], q[0]) for p, q in zip(few, kept, strict=True)]
    return [(q, p) for p, q in best] if swap else best
