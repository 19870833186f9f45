"""What an explicit Runge-Kutta method consists of, and those that there are.

Their coefficients are files of numbers, with their sources.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

Combination = dict[int, float]
"""A sum of stages: stage -> coefficient; those that are missing are zero."""


@dataclass(frozen=True)
class RungeKutta:
    """An explicit method with embedded error estimates.

    Parameters
    ----------
    name : str
    order : int
    nodes : tuple of float
        Fractions of the step at which the stages are evaluated; the first is 0.
    rows : tuple of combinations
        For each stage the combination of earlier ones that leads to its state.
    weights : combination
        The step itself.
    errors : tuple of combinations
        Estimates of its error. Of two, e and a cruder one c, the error is e^2 / sqrt(e^2 + c^2 / 100).
    error_order : int
        The error estimate is of the order of this power of the step.
    stable : float
        Steps h in which exp(-z t) decays are limited by stability, not by accuracy, from about this h z on:
        somewhat less than where the method becomes unstable, as the error estimate grows before.
    dense_nodes, dense_rows : optional
        Further stages for interpolation. The first of them is the derivative at the end of the step.
    dense : tuple of combinations
        Coefficients of the interpolating polynomial beyond those that the ends of the step determine.
    """

    name: str
    order: int
    nodes: tuple[float, ...]
    rows: tuple[Combination, ...]
    weights: Combination
    errors: tuple[Combination, ...]
    error_order: int
    stable: float
    dense_nodes: tuple[float, ...] = ()
    dense_rows: tuple[Combination, ...] = ()
    dense: tuple[Combination, ...] = ()

    @property
    def stages(self) -> int:
        """How many stages there are, those of the error estimate included."""
        return len(self.nodes)

    @property
    def stages_of_step(self) -> int:
        """How many stages come up to the last one that the step itself needs."""
        return max(self.weights) + 1


def _read(name: str) -> RungeKutta:
    """A method from the file of its coefficients."""

    def numbers(entry: Any) -> Any:
        if isinstance(entry, dict):
            return {int(stage): value for stage, value in entry.items()}
        return tuple(map(numbers, entry)) if isinstance(entry, list) else entry

    given = json.loads(files(__package__).joinpath(f"{name}.json").read_text(encoding="utf-8"))
    return RungeKutta(**{key: numbers(entry) for key, entry in given.items() if key != "source"})


# Order 8, with error estimates of orders 5 and 3 and an interpolant of order 7; orders 9 and 8.
DOP853, VERNER98 = _read("dop853"), _read("verner98")
