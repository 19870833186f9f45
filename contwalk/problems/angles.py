"""States that are angles: differences count modulo their periods."""

from __future__ import annotations

import numpy as np


def whole_turns(apart: np.ndarray, periods: np.ndarray) -> np.ndarray:
    """The whole turns in differences of states, (.., n): what is left without them is half a turn at most.

    Zero for states that are no angles, whose `periods` are 0.
    """
    return np.round(np.divide(apart, periods, out=np.zeros_like(apart), where=periods > 0.0)) * periods
