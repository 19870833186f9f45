"""Where a motion first passes a value of a state, as sampled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.system import System


@dataclass(frozen=True)
class Place:
    """A value of a state that is passed in a direction.

    Parameters
    ----------
    index : int
        Number of the state.
    value : float
    direction : float
        1 where the state rises, -1 where it falls.
    period : float
        A whole turn of an angle, which passes the value in each of its turns; else 0.
    """

    index: int
    value: float
    direction: float
    period: float

    @staticmethod
    def of(system: System, index: int, value: float, direction: float) -> Place:
        """The place in the states of a system."""
        return Place(index, value, direction, system.states[index].period or 0.0)

    def beyond(self, states: np.ndarray) -> np.ndarray:
        """How far states, shape (.., n), are beyond the value in the direction, shape (..)."""
        apart: np.ndarray = (states[..., self.index] - self.value) * self.direction
        return apart

    def passed(self, states: np.ndarray) -> tuple[int, float] | None:
        """The number of the last state before it is passed, and what `beyond` is there: whole turns.

        Shape (k, n).
        """
        beyond = self.beyond(states)
        turns = np.floor(beyond / self.period) if self.period else np.where(beyond < 0.0, -1.0, 0.0)
        passes = np.flatnonzero(turns[1:] > turns[:-1])
        if not len(passes):
            return None
        k = int(passes[0])
        return k, self.period * float(turns[k] + 1.0)

    def begun_at(self, states: np.ndarray) -> np.ndarray | None:
        """The state at which a motion that comes back to its first one passes the value, if it begins there:
        as nearly as it comes back, so that nothing tells whether it passes at its beginning or at its end.

        States have the shape (k, n), the one that is told (n,).
        """
        first, last, second = (float(b) for b in self.beyond(states[[0, -1, 1]]))
        turn = self._turns(first)
        gap = abs(last - first - self._turns(last - first))
        gap += 4.0 * EPSILON * float(np.abs(states[:, self.index]).max())
        if abs(first - turn) > gap or not second > first:
            return None
        # On the line to the second state, which is that little longer at its beginning.
        share = float(np.clip((turn - first) / (second - first), -1.0, 1.0))
        return self.told(states[0] + share * (states[1] - states[0]), turn)

    def told(self, state: np.ndarray, turn: float) -> np.ndarray:
        """A state with the angle in the turn that the value is of, not so far beyond it. Shape (n,)."""
        told = state.copy()
        told[self.index] -= turn * self.direction
        return told

    def _turns(self, apart: float) -> float:
        return self.period * round(apart / self.period) if self.period else 0.0
