"""What belongs together on two neighbouring rows of a sweep: the ends of their data, and zeros in between."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from contwalk.plotting.sweep import Row

# Intervals that belong together, on the lower row and on the upper.
Interval = tuple[float, float]
Cell = tuple[Interval, Interval]


def cells(lower: Row, upper: Row) -> Iterator[Cell]:
    """The cells of the strip between two rows, by growing x."""
    below, above = _pieces(lower), _pieces(upper)
    for a in below:
        for b in above:
            if min(a[1], b[1]) <= max(a[0], b[0]):
                continue
            # Two pieces that overlap no other belong together with their ends; else what they share does.
            partners = sum(_overlap(a, other) for other in above) + sum(_overlap(b, other) for other in below)
            common = max(a[0], b[0]), min(a[1], b[1])
            ends = (a, b) if partners == 2 else (common, common)
            inner = _matched(_zeros(lower, ends[0]), _zeros(upper, ends[1]))
            corners = [(ends[0][0], ends[1][0]), *inner, (ends[0][1], ends[1][1])]
            yield from (((p[0], q[0]), (p[1], q[1])) for p, q in pairwise(corners))


def _pieces(row: Row) -> list[Interval]:
    """The intervals of x that have data throughout."""
    breaks = np.flatnonzero(~row.covered)
    starts, ends = [0, *(breaks + 1)], [*breaks, len(row.x) - 1]
    return [(float(row.x[a]), float(row.x[b])) for a, b in zip(starts, ends, strict=True) if b > a]


def _overlap(a: Interval, b: Interval) -> bool:
    return min(a[1], b[1]) > max(a[0], b[0])


def _zeros(row: Row, ends: Interval) -> list[tuple[float, bool]]:
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


def _matched(lower: list[tuple[float, bool]], upper: list[tuple[float, bool]]) -> list[tuple[float, float]]:
    """Zeros that correspond, as pairs of x: all but a block that exists on one row only, the one nearest to it."""
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
