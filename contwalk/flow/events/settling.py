"""Whether a motion repeats itself: the extremes of its states stay as they are.

Over a window longer than its period an equilibrium, a periodic or an impacting motion has the same least
and greatest value of each state, wherever the window begins. Windows grow, so that a slow approach is not
taken for an arrival: it changes the extremes by more in a longer window.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

TOLERANCE = 1e-6  # of the magnitudes; sampled extremes are known to the fourth order of the sampling
FIRST_WINDOW = 100  # steps of the integrator
GROWTH = 1.5


class Settling:
    """Told of a motion part by part, says when two windows in succession have the same extremes.

    Parameters
    ----------
    periods : sequence of float or None
        Periods of the states that are angles. One that turns round and round has no extremes and is not
        looked at: its speed, a state too, tells.
    neutral : sequence of bool, optional
        States that are not looked at, since nothing depends on them: how far a walker has come.
    """

    def __init__(self, periods: Sequence[float | None], neutral: Sequence[bool] = ()) -> None:
        self._turn = np.array([np.inf if period is None else period for period in periods])
        self._neutral = np.array(neutral or [False] * len(self._turn))
        self._before: np.ndarray | None = None
        self._low = np.full(len(self._turn), np.inf)
        self._high = -self._low
        self._magnitude = np.zeros(len(self._turn))
        self._steps = 0
        self._window = float(FIRST_WINDOW)

    def add(self, samples: np.ndarray, steps: int) -> bool:
        """Go on with evenly spaced states (k, n) that these steps passed through; whether it has settled."""
        low, high = _extremes(samples)
        self._low, self._high = np.minimum(self._low, low), np.maximum(self._high, high)
        self._magnitude = np.maximum(self._magnitude, np.abs(samples).max(axis=0))
        self._steps += steps
        if self._steps < self._window:
            return False
        turning = self._high - self._low > self._turn
        now = np.where(turning | self._neutral, 0.0, np.stack([self._low, self._high]))
        same = False
        if self._before is not None:
            same = bool((np.abs(now - self._before) <= TOLERANCE * self._magnitude).all())
        self._before = now
        self._low, self._high = np.full_like(low, np.inf), np.full_like(low, -np.inf)
        self._steps, self._window = 0, self._window * GROWTH
        return same


def _extremes(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest value of each column, with the vertex of the parabola through three samples."""
    low, high = samples.min(axis=0), samples.max(axis=0)
    if len(samples) < 3:
        return low, high
    a, b, c = samples[:-2], samples[1:-1], samples[2:]
    bend, slope = a - 2.0 * b + c, 0.5 * (c - a)
    peak = (b - a) * (c - b) < 0.0
    vertex = np.where(peak, b - 0.5 * slope * (slope / np.where(peak, bend, 1.0)), b)
    return np.minimum(low, vertex.min(axis=0)), np.maximum(high, vertex.max(axis=0))
