"""What an explicit Runge-Kutta method consists of."""

from __future__ import annotations

from dataclasses import dataclass

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
