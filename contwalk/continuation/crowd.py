"""Points that crowd within what solutions are known to: a walk over rounding.

Where the error of solutions is larger than what lies between them, as along canards of large growth, tests
change their signs for no reason, and the walk may go to and fro for as long as there are points.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np

# So many special points in a row tell that are not located.
IN_A_ROW = 10
# So many points in a row tell where the way along all of them is this part of the longest step, or less:
# twice as many as lead across a resonance of 1e6, whose errors are large beside its steps.
CREEPING, SHORT = 300, 1e-3


class Crowd:
    """The last special points of a walk that were not located, none of another kind between them, and its
    last points.

    Parameters
    ----------
    known : iterable of (bool, float, float)
        What special points have told already, as `tell` is told.
    points : iterable of (float, float)
        What points have told already, as `pass_by` is told.
    """

    def __init__(
        self, known: Iterable[tuple[bool, float, float]] = (), points: Iterable[tuple[float, float]] = ()
    ) -> None:
        self._last: deque[tuple[float, float]] = deque(maxlen=IN_A_ROW)
        self._points: deque[tuple[float, float]] = deque(points, maxlen=CREEPING)
        for each in known:
            self.tell(*each)

    def pass_by(self, s: float, error: float) -> None:
        """A point that is not special, its arclength, and what it is known to, in the metric."""
        self._points.append((s, error))

    def tell(self, located: bool, s: float, error: float) -> None:
        """A special point, its arclength, and what the solution there is known to, in the metric."""
        if located:
            self._last.clear()
        else:
            self._last.append((s, error))

    def noise(self, longest: float) -> tuple[str, float] | None:
        """What lies nearer to each other than solutions are known to, and to what they are, in the metric.

        None where the walk gets on. `longest` is the longest step that is allowed.
        """
        if _within(self._last, IN_A_ROW) < IN_A_ROW * (error := max((e for _, e in self._last), default=0.0)):
            return f"the last {IN_A_ROW} special points were not located, and", error
        way = _way(self._points, CREEPING)
        if not way < SHORT * longest:
            return None
        error = float(np.nan_to_num([e for _, e in self._points]).min())
        return (f"the last {CREEPING} points", error) if way < error else None


def _way(points: deque[tuple[float, float]], count: int) -> float:
    """The way from the first of so many points to the last; infinite where there are fewer."""
    return abs(points[-1][0] - points[0][0]) if len(points) == count else np.inf


def _within(points: deque[tuple[float, float]], count: int) -> float:
    """The way along so many points; infinite where there are fewer."""
    places = [s for s, _ in points]
    return max(places) - min(places) if len(places) == count else np.inf
