"""A plugin's map of the state at many states, all at once where it allows that."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.errors import called
from contwalk.python_functions import plain
from contwalk.system.declarations import ParameterValues


def mapped(
    what: str, function: Callable[..., None], states: np.ndarray, parameters: ParameterValues
) -> np.ndarray:
    """What `function(t, x, p, out)` writes for each of many states, (k, n); `what` names it in errors.

    All at once only if the last state's image is the same then: a map may add up its states.
    """
    out = np.zeros(states.shape[::-1])
    try:
        plain(function)(0.0, states.T.copy(), parameters, out)
        if len(states) == 0 or np.array_equal(out[:, -1], _image(what, function, states[-1], parameters)):
            return out.T.copy()
    except (TypeError, ValueError):  # it chooses by a state, or calls functions of one number
        pass
    return np.array([_image(what, function, x, parameters) for x in states])


def _image(
    what: str, function: Callable[..., None], x: np.ndarray, parameters: ParameterValues
) -> np.ndarray:
    out = np.zeros(len(x))
    called(what, function, 0.0, x.copy(), parameters, out)
    return out
