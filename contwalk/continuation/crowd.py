"""Special points that are not located and crowd within what solutions are known to: a walk over rounding.

Where the error of solutions is larger than what lies between them, as along canards of large growth, tests
change their signs for no reason, and the walk may go to and fro for as long as there are points.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

# So many in a row tell.
IN_A_ROW = 10


class Crowd:
    """The last special points of a walk that were not located, none of another kind between them.

    Parameters
    ----------
    known : iterable of (bool, float, float)
        What special points have told already, as `tell` is told.
    """

    def __init__(self, known: Iterable[tuple[bool, float, float]] = ()) -> None:
        self._last: deque[tuple[float, float]] = deque(maxlen=IN_A_ROW)
        for each in known:
            self.tell(*each)

    def tell(self, located: bool, s: float, error: float) -> None:
        """A special point, its arclength, and what the solution there is known to, in the metric."""
        if located:
            self._last.clear()
        else:
            self._last.append((s, error))

    @property
    def error(self) -> float:
        """What solutions there are known to, in the metric."""
        return max((error for _, error in self._last), default=0.0)

    @property
    def is_noise(self) -> bool:
        """Whether so many lie nearer to each other than solutions are known to."""
        places = [s for s, _ in self._last]
        return len(places) == IN_A_ROW and max(places) - min(places) < IN_A_ROW * self.error
