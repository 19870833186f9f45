"""Newton's method on a problem's equations alone, for solutions beside known ones, and errors."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import StartError
from contwalk.problems.problem import equations_at

ITERATIONS = 12
# Corrections smaller than this, in the metric, that do not get smaller are rounding.
STAGNATES = 1e-8


def newton_on(
    problem: Any,
    guess: np.ndarray,
    weights: np.ndarray,
    normal: np.ndarray | None = None,
    stagnates: float = STAGNATES,
) -> np.ndarray:
    """The solution nearest to a guess, or in the hyperplane through it.

    Without a normal each correction is the shortest one in the metric: of a point that solves the equations
    nearly, only rounding is corrected, along no direction of solutions.

    All have the shape (N + 1,).

    Raises
    ------
    StartError
        If the iteration does not converge.
    """
    z, before = guess.copy(), np.inf
    for _ in range(ITERATIONS):
        problem, here = equations_at(problem, z)
        if not here.finite:
            break
        if normal is None:
            scaled = here.jacobian / problem.equation_scales[:, None] * weights
            step = weights * np.linalg.lstsq(scaled, here.residual / problem.equation_scales, rcond=1e-12)[0]
        else:
            right = np.append(here.residual, normal @ (z - guess))
            step = here.bordered(normal, weights).solve(right)
        with np.errstate(over="ignore", invalid="ignore"):  # of one that diverges
            size = float(np.linalg.norm(step / weights))
        if here.excess <= 2.0 or size < 1e-13 or (size > 0.5 * before and before < stagnates):
            return z
        if not np.isfinite(size):
            break
        z, before = z - step, size
    raise StartError("Newton's method does not converge.", "")


def error_holding(problem: Any, z: np.ndarray, weights: np.ndarray, held: np.ndarray) -> float:
    """What errors of the equations do to the free parameter of a solution of which something is held.

    `held` is its gradient. Equations that are exact are known to their rounding.

    z, weights and `held` have the shape (N + 1,).
    """
    linear = problem.linearize(z)
    errors = linear.levels[0] if problem.meshed is None else problem.meshed.errors_at(z)
    return float(linear.parameter_error(held, weights, errors))
