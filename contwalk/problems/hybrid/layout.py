"""Where what stands in the vector of unknowns of a hybrid orbit, and in its equations.

Unknowns: the states at the starts of the legs, each as long as its mode has states; the legs' durations; of a
forced system the time at which the first leg starts; a drift for each pinned direction; the free parameter.
Equations: each leg's end is the next one's start; each leg ends where its guard is zero; of a forced system
the durations add up to whole periods; each pinned direction is held.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np


class Layout:
    """Positions of unknowns and equations.

    Parameters
    ----------
    sizes : sequence of int
        Number of states of each leg.
    forced : bool
    pins : int
    """

    def __init__(self, sizes: Sequence[int], forced: bool, pins: int) -> None:
        self.sizes, self.forced, self.pins = tuple(sizes), forced, pins
        self.legs = m = len(sizes)
        ends = np.cumsum([0, *sizes])
        total = int(ends[-1])
        self.states = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self.durations = slice(total, total + m)
        self.start = total + m if forced else None
        first = total + m + int(forced)
        self.drifts = slice(first, first + pins)
        self.size = first + pins
        # Equations: a leg's end has as many as the next leg has states.
        following = [sizes[(i + 1) % m] for i in range(m)]
        rows = np.cumsum([0, *following])
        self.matches = [slice(int(a), int(b)) for a, b in pairwise(rows)]
        self.guards = total
        self.sum = total + m if forced else None
        self.held = first

        self._local = [self._positions(i) for i in range(m)]

    def _positions(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        own = np.concatenate(
            [
                np.arange(self.states[i].start, self.states[i].stop),
                [self.durations.start + i],
                np.arange(self.drifts.start, self.drifts.stop),
                [self.size],
            ]
        ).astype(int)
        before = np.arange(self.durations.start, self.durations.start + i)
        return own, np.append(before, self.start).astype(int) if self.start is not None else before[:0]

    def local(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Positions in z of leg i's own inputs (states, T, drifts, parameter), and of the summands of s."""
        return self._local[i]

    def spread(self, i: int, rows: np.ndarray) -> np.ndarray:
        """Derivatives by a leg's inputs, (r, n_i + k), as derivatives by z, (r, N + 1)."""
        own, before = self.local(i)
        n, result = self.sizes[i], np.zeros((len(rows), self.size + 1))
        kept = np.delete(rows, n + 1, axis=1) if self.forced else rows
        result[:, own] = kept
        if self.forced:
            result[:, before] = rows[:, n + 1, None]
        return result

    def inputs(self, i: int, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A leg's state and scalars (T, s, drifts, parameter), of z or of a direction like it."""
        own, before = self.local(i)
        n, values = self.sizes[i], z[own]
        if not self.forced:
            return values[:n], values[n:]
        return values[:n], np.concatenate([values[n : n + 1], [z[before].sum()], values[n + 1 :]])
