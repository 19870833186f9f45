"""Right-hand sides that orbits of one family have cost, and how many more they may: counted, not timed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from contwalk.errors import StartError

# A start may cost so many times what the equations at its first guess do: three to twelve times are usual.
START = 60


class Effort:
    """A tally that problems made from one another share."""

    def __init__(self) -> None:
        self.spent = 0
        self._allowed = np.inf
        self._remedy = ""

    def spend(self, evaluations: int) -> None:
        """Count some right-hand sides.

        Raises
        ------
        StartError
            If a start has used up what it may.
        """
        self.spent += evaluations
        if self.spent > self._allowed:
            raise StartError(
                "Newton's method has used as many right-hand sides as "
                f"{START} corrections of the first guess would take, and found no orbit: it tries motions "
                "that are far from the guess, and take very many steps.",
                f"{self._remedy} the state of a stored orbit at a parameter near by, or set engine.method if "
                "you know that the machine is not stiff.",
            )

    @contextmanager
    def of_start(self, guess: int, settled: bool = False) -> Iterator[None]:
        """Bound what is spent within.

        Parameters
        ----------
        guess : int
            Right-hand sides of the equations at the first guess.
        settled : bool
            Whether the guess is what a motion has settled on.
        """
        self._allowed = self.spent + START * guess
        self._remedy = "Start from" if settled else "Let the motion settle first (until: settled), start from"
        try:
            yield
        finally:
            self._allowed = np.inf
