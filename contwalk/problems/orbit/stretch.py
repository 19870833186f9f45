"""A leg of the whole motion of an orbit, as it is seen from the ground."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from contwalk.problems.orbit.extrema import Smooth
from contwalk.problems.orbit.view import LegView

Own = TypeVar("Own", bound=LegView, covariant=True)


@dataclass(frozen=True, eq=False)
class Stretch(Generic[Own]):
    """A leg of the whole motion: as integrated, or the image of an integrated one.

    Parameters
    ----------
    name : str
        What ends it.
    view : LegView
    later : float
        Seconds after the integrated one.
    seen : callable
        Times and integrated states, shapes (k,) and (k, n), as states of this leg seen from the ground: not
        by one who drifts along pinned directions.
    exists : tuple of int
        Which states exist in its mode.
    """

    name: str
    view: Own
    later: float
    seen: Callable[[np.ndarray, np.ndarray], np.ndarray]
    exists: tuple[int, ...]

    @property
    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Times in seconds and full states, both ends and the extremes of states included.

        Shapes (k,) and (k, n).
        """
        times, states = self.view.motion
        return times + self.later, self.seen(times, states)

    @property
    def smooth(self) -> Smooth:
        """The leg in 0..1 with full states as seen."""
        view = self.view
        return view.smooth.mapped(lambda share, x: self.seen(view.start + view.duration * share, x))

    @property
    def start(self) -> tuple[float, np.ndarray]:
        """Time and full state at which it starts. The state has the shape (n,)."""
        return self._seen_at(self.view.start, self.view.x)

    @property
    def end(self) -> tuple[float, np.ndarray]:
        """Time and full state before what ends it. The state has the shape (n,)."""
        return self._seen_at(self.view.start + self.view.duration, self.view.end)

    def _seen_at(self, time: float, x: np.ndarray) -> tuple[float, np.ndarray]:
        return time + self.later, self.seen(np.array([time]), self.view.full(x)[None])[0]

    def at(self, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Times and full states at instants in 0..1. Shapes (k,) and (k, n)."""
        times = self.view.start + self.view.duration * shares
        return times + self.later, self.seen(times, self.view.full(self.view.at(shares)))
