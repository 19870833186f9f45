"""Defining systems: Newton's method in double precision, then refinement with exact residuals.

A point where a matrix is singular, or an eigenvalue imaginary, is the regular solution of a larger system
G(U) = 0. Newton's method in floats finds it up to the rounding of G. After that, G is evaluated in extended
precision and the corrections are computed with the same float Jacobian (iterative refinement); each pass
gains about as many digits as the Jacobian is well conditioned, until U is known to more digits than a float
holds. What is reported is U rounded to floats, so that its error is known and not believed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.linear import Factored, LeastSquares

DIGITS = 40
# A refined value this small against its typical magnitude is zero.
NOTHING = 1e-25
# At a root of multiplicity m a correction by Newton's method is an m-th part of the way: where refinement
# does not converge, errors are so many times the largest correction.
MULTIPLE = 5.0
EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class DefiningSystem:
    """G(U) = 0 with its Jacobian in floats, and G in extended precision.

    `exactly(U)` takes and returns lists of `mpmath` numbers; `scale` holds typical magnitudes of U. Where it
    is `deficient`, the first so many unknowns are judged; the others are a vector that may turn.
    """

    scale: np.ndarray
    residual: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray]
    exactly: Callable[[Sequence[Any]], list[Any]]
    deficient: int | None = None

    def factored(self, u: np.ndarray) -> Factored | LeastSquares:
        """The Jacobian at U, shape (n,), ready to be solved with; where `deficient`, by least squares."""
        return (Factored if self.deficient is None else LeastSquares)(self.jacobian(u))


@dataclass(frozen=True)
class Solution:
    """A solution of a defining system.

    Parameters
    ----------
    values : ndarray
        U rounded to floats.
    exact : list
        U in extended precision.
    errors : ndarray
        Estimated absolute error of each entry of `values`.
    refined : bool
        Whether refinement converged; if not, `values` are those of Newton's method in floats, and `errors`
        what the corrections that did not converge tell of them: infinite where there are none.
    """

    values: np.ndarray
    exact: list[Any]
    errors: np.ndarray
    refined: bool


def newton(system: DefiningSystem, start: np.ndarray, iterations: int = 25) -> np.ndarray | None:
    """Solution of G(U) = 0, shape (n,), to the rounding of G; None where Newton's method gets nowhere."""
    u = start.copy()
    best, stalled = np.inf, 0
    for _ in range(iterations):
        g = system.residual(u)
        if not np.all(np.isfinite(g)):
            return None
        try:
            correction = system.factored(u).solve(g)
        except np.linalg.LinAlgError:
            return None
        if not np.all(np.isfinite(correction)):
            return None
        u = u - correction
        judged = slice(system.deficient)
        size = _norm(np.abs(correction)[judged], np.maximum(np.abs(u), system.scale)[judged])
        if size < 1e-14:
            return u
        # Quadratic convergence ends in rounding noise: small corrections that no longer shrink are its end.
        stalled = stalled + 1 if size > 0.5 * best else 0
        best = min(best, size)
        if stalled >= 2 and best < 1e-5:
            return u
        if stalled >= 8:
            return None
    return u if best < 1e-7 else None


def refine(system: DefiningSystem, u: np.ndarray, passes: int = 12, slowest: float = 0.5) -> Solution:
    """Refine a float solution, shape (n,), with residuals in extended precision.

    Corrections that are more than the part `slowest` of the last one do not converge. Where that is over a
    half each is made with the Jacobian of its place: to a root that is nearly double they halve.
    """
    import mpmath

    judged, sizes = slice(system.deficient), list[np.ndarray]()

    def moved(k: int) -> float:
        return _norm(sizes[k][judged], scale[judged])

    with mpmath.workdps(DIGITS):
        exact = [mpmath.mpf(value) for value in u]
        try:
            inverse = system.factored(u)
            for _ in range(passes):
                if len(sizes) and slowest > 0.5:
                    inverse = system.factored(np.array([float(a) for a in exact]))
                residual = system.exactly(exact)
                correction = _solve_scaled(inverse, residual)
                exact = [a - b for a, b in zip(exact, correction, strict=True)]
                sizes.append(np.array([float(abs(c)) for c in correction]))
                scale = np.maximum(np.array([float(abs(a)) for a in exact]), 1e-16 * system.scale)
                if np.all(sizes[-1][judged] <= 1e-6 * EPSILON * scale[judged]):
                    break
                if len(sizes) > 3 and moved(-1) > slowest * moved(-2):
                    break
        except (np.linalg.LinAlgError, ArithmeticError, ValueError):
            return _unrefined(system, u, sizes)
        values = np.array([float(a) for a in exact])
        rounding = np.array([float(abs(a - b)) for a, b in zip(exact, values, strict=True)])
    # What remains of an exact zero is far below anything that the equations can tell from it.
    nothing = np.abs(values) <= NOTHING * system.scale
    rounding[nothing] += np.abs(values[nothing])
    values[nothing] = 0.0
    last = sizes[-1]
    converged = bool(np.all(last[judged] <= EPSILON * scale[judged])) or moved(-1) <= 1e-3 * moved(0)
    if not converged:
        return _unrefined(system, u, sizes)
    # A float cannot be nearer to the truth than half an ulp; the estimate never claims to be.
    floor = 10.0 ** (2 - DIGITS) * system.scale  # the working precision itself
    errors = np.maximum(rounding + 2.0 * last + floor, EPSILON * np.abs(values))
    return Solution(values, exact, errors, refined=True)


def _unrefined(system: DefiningSystem, u: np.ndarray, sizes: Sequence[np.ndarray]) -> Solution:
    """The float solution U, shape (n,), where corrections of these sizes, (n,) each, did not converge."""
    largest = np.max(sizes, axis=0) if len(sizes) else np.full(len(u), np.inf)
    nothing = np.abs(u) <= NOTHING * system.scale
    errors = np.maximum(MULTIPLE * largest, EPSILON * np.abs(u)) + np.where(nothing, np.abs(u), 0.0)
    return Solution(np.where(nothing, 0.0, u), [], errors, refined=False)


def _norm(sizes: np.ndarray, scale: np.ndarray) -> float:
    return float(np.max(sizes / np.maximum(scale, 1e-300))) if len(sizes) else 0.0


def _solve_scaled(inverse: Factored | LeastSquares, residual: list[Any]) -> list[Any]:
    """The float inverse applied to a residual far below the smallest float that matters."""
    import mpmath

    largest = max((abs(r) for r in residual), default=mpmath.mpf(0))
    if largest == 0:
        return [mpmath.mpf(0)] * len(residual)
    solved = inverse.solve(np.array([float(r / largest) for r in residual]))
    return [largest * mpmath.mpf(value) for value in solved]
