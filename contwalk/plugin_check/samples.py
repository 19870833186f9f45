"""States at which a plugin's functions are tried, the same in every run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random  # NumPy's takes five milliseconds to import
from typing import Any

import numpy as np

from contwalk.fields.blame import first_not_finite
from contwalk.plugin_check.findings import Place, place_of, split_place
from contwalk.plugin_check.traced import Traced
from contwalk.python_functions import plain
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

COUNT = 8
_SEED = 1  # any; fixed, so that two checks of one plugin say the same


@dataclass(frozen=True)
class Samples:
    """The default parameters, and states and times at which functions are tried.

    Parameters
    ----------
    parameters : dict
        Defaults by name; `values` in their order.
    states : ndarray, shape (k, n)
    times : ndarray, shape (k,)
    scales : ndarray, shape (n,)
        Declared magnitudes of the states, 1 where none is declared.
    """

    parameters: dict[str, float]
    values: list[float]
    states: np.ndarray
    times: np.ndarray
    scales: np.ndarray

    def evaluate(self, function: Traced, row: int) -> np.ndarray:
        """Values at one sample; NaN where there are none."""
        return function.values(self.times[row], self.states[row], self.values)


def samples_of(system: System, period: float | None) -> Samples:
    """Positive states, states of any sign, and, where the system names equilibria, states around them."""
    random = Random(_SEED)
    parameters = system.defaults()
    scales = np.array([1.0 if state.scale is None else float(state.scale) for state in system.states])
    states = scales * np.array([[random.gauss(0.0, 1.0) for _ in scales] for _ in range(COUNT)])
    states[: COUNT // 2] = np.abs(states[: COUNT // 2])
    centres = named_equilibria(system, parameters)
    for row, centre in zip(range(0, COUNT, 2), centres * COUNT, strict=False):
        states[row] = centre + 0.1 * states[row]
    times = np.array([random.uniform(0.0, period or 0.0) for _ in range(COUNT)])
    return Samples(parameters, list(parameters.values()), states, times, scales)


def named_equilibria(system: System, parameters: dict[str, float]) -> list[np.ndarray]:
    """Named equilibria that can be had; what is wrong with the others is found elsewhere."""
    found = []
    for start in system.starts:
        try:
            states = [np.asarray(x, dtype=float) for x in plain(start.states)(ParameterValues(**parameters))]
        except (Exception, SystemExit):
            continue
        found += [x for x in states if x.shape == (len(system.states),) and np.isfinite(x).all()]
    return found


def where_not_finite(
    function: Traced, t: float, x: np.ndarray, parameters: dict[str, float]
) -> tuple[Place, str]:
    """The line at which a NaN or infinity first arises, and what arises there."""
    original = function.function
    text = first_not_finite(as_field(function), t, function.given(x).tolist(), parameters, named=original)
    return split_place(text or "the result is not finite", place_of(original))


def as_field(function: Traced) -> Callable[..., Any]:
    """The function in the form of a field, also where it returns a number."""
    original = function.function

    def written(t: Any, x: Any, p: Any, out: Any) -> None:
        out[0] = original(t, x, p)

    return original if function.form.argument else written
