"""A plugin's map of the state at many states, all at once where it allows that."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.errors import called
from contwalk.system.declarations import ParameterValues


def mapped(
    what: str, function: Callable[..., None], states: np.ndarray, parameters: ParameterValues
) -> np.ndarray:
    """What `function(t, x, p, out)` writes for each of many states, (k, n); `what` names it in errors."""
    out = np.zeros(states.shape[::-1])
    try:
        function(0.0, states.T, parameters, out)
    except (TypeError, ValueError):  # it chooses by a state, or calls functions of one number
        out = np.zeros(states.shape)
        for x, image in zip(states, out, strict=True):
            called(what, function, 0.0, x, parameters, image)
        return out
    return out.T.copy()
