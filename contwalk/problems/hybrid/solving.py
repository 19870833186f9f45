"""Newton's method on an orbit's equations alone, for orbits beside known ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contwalk.errors import StartError

if TYPE_CHECKING:
    from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit

ITERATIONS = 12


def newton_on(
    problem: HybridOrbit, guess: np.ndarray, weights: np.ndarray, normal: np.ndarray | None = None
) -> np.ndarray:
    """The solution nearest to a guess, or in the hyperplane through it.

    Without a normal each correction is the shortest one in the metric: of a point that solves the equations
    nearly, only rounding is corrected, along no direction of solutions.

    Raises
    ------
    StartError
        If the iteration does not converge.
    """
    z, before = guess.copy(), np.inf
    for _ in range(ITERATIONS):
        here = problem.linearize(z)
        if not here.finite:
            break
        if normal is None:
            scaled = here.jacobian / problem.equation_scales[:, None] * weights
            step = weights * np.linalg.lstsq(scaled, here.residual / problem.equation_scales, rcond=1e-12)[0]
        else:
            right = np.append(here.residual, normal @ (z - guess))
            step = here.bordered(normal, weights).solve(right)
        size = float(np.linalg.norm(step / weights))
        if here.excess <= 2.0 or size < 1e-13 or (size > 0.5 * before and before < 1e-8):
            return z
        z, before = z - step, size
    raise StartError("Newton's method does not converge.", "")
