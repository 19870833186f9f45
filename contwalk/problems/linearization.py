"""The equations at one place: residual, exact derivatives, rounding levels, and linear systems with them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.memory import computed_once
from contwalk.numerics.linear import EPSILON, Factored, Factorization

# Magnitudes of unknowns are at most so many times their weights, where a residual is told from rounding
# without asking for them.
LARGEST_MAGNITUDE = 1e3

# Unknowns fitted for a corrector's hyperplane, given with its normal and the metric.
Fitted = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray | None]


class Linearization:
    """The equations at one z: F, shape (N,), and DF, shape (N, N + 1).

    What is only needed near a solution is computed when it is first asked for, by `levels`. `nearby()` begins
    a chain of points near z at which F alone is asked for, where that is far cheaper than DF; else it is
    None. `fitted(z, normal, weights)` tells z with those unknowns solved for that are hard to guess, None
    where there are none. Where the discretisation does not reach z nothing is finite, and `remeshed()` gives
    the problem on one that does as well.
    """

    # That part of the rounding levels, shape (N,), that is known without magnitudes of z, where these have a
    # price.
    evaluation: Callable[[], np.ndarray] | None = None
    # Whether DF costs as much as several F: a chain of these is worth one DF then.
    dear = False

    def __init__(
        self,
        residual: np.ndarray,
        jacobian: np.ndarray,
        levels: Callable[[], tuple[np.ndarray, np.ndarray | None]],
        magnitudes: Callable[[], np.ndarray] | None = None,
        factor: Callable[[np.ndarray, np.ndarray], Factorization] = Factored,
        nearby: Callable[[], Callable[[np.ndarray], np.ndarray]] | None = None,
        fitted: Fitted | None = None,
        remeshed: Callable[[], Any] | None = None,
    ) -> None:
        self.residual = residual
        self.jacobian = jacobian
        self.nearby, self.fitted, self.remeshed = nearby, fitted, remeshed
        self._factor = factor
        self._bordered: tuple[bytes, Factorization] | None = None
        self._levels = levels
        self._magnitudes = magnitudes

    @computed_once
    def levels(self) -> tuple[np.ndarray, np.ndarray | None]:
        """Rounding level of each residual, shape (N,), and what comes with it of typical magnitudes."""
        return self._levels()

    @computed_once
    def magnitudes(self) -> np.ndarray:
        """Typical magnitudes of z, shape (N + 1,), NaN where neither z nor the equations tell."""
        found = self.levels[1] if self._magnitudes is None else self._magnitudes()
        assert found is not None
        return found

    def with_row(self, value: float | np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The equations and one more: their values and derivatives, shapes (N + 1,) and (N + 1, N + 1)."""
        return np.append(self.residual, value), np.vstack([self.jacobian, row])

    def bordered(self, row: np.ndarray, weights: np.ndarray) -> Factorization:
        """[DF; row], factored; kept until another row is asked for.

        Raises
        ------
        numpy.linalg.LinAlgError
            If it is exactly singular, here or when it is used.
        """
        key = row.tobytes() + weights.tobytes()
        if self._bordered is None or self._bordered[0] != key:
            self._bordered = key, self._factor(np.concatenate([self.jacobian, row[None]]), weights)
        return self._bordered[1]

    def tangent(self, border: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """The null vector t of DF with border . t = 1.

        Raises
        ------
        numpy.linalg.LinAlgError
            Exactly at a branch point, where DF has more than one.
        """
        unit = np.zeros(len(border))
        unit[-1] = 1.0
        return self.bordered(border, weights).solve(unit)

    def orientation_and_error(
        self, tangent: np.ndarray, weights: np.ndarray, levels: np.ndarray
    ) -> tuple[float, float]:
        """Sign of det [DF; tangent], and what errors `levels` of the equations do to the solution at most."""
        try:
            bordered = self.bordered(tangent / weights**2, weights)
            return bordered.orientation(), bordered.error(levels, weights)
        except np.linalg.LinAlgError:
            return 0.0, float("inf")

    def parameter_error(self, row: np.ndarray, weights: np.ndarray, levels: np.ndarray) -> float:
        """What errors of the equations do to the last unknown; as `error_of`."""
        return self.error_of(-1, row, weights, levels)

    def error_of(self, which: int, row: np.ndarray, weights: np.ndarray, levels: np.ndarray) -> float:
        """What errors of the equations do to an unknown; what is held has the gradient `row`.

        The row and the weights have the shape (N + 1,), the levels of the errors (N,).
        """
        try:
            own = self.bordered(row, weights).solve_adjoint(np.eye(len(row))[which])[: len(levels)]
        except np.linalg.LinAlgError:
            return float("inf")
        return float(np.abs(own) @ levels)

    @property
    def finite(self) -> bool:
        """Whether residual and Jacobian are."""
        return bool(np.isfinite(self.residual).all() and np.isfinite(self.jacobian).all())

    def excess_in(self, weights: np.ndarray) -> float:
        """As `excess`, where unknowns too are only known to the rounding of their weights."""
        level = self.levels[0] + EPSILON * (np.abs(self.jacobian) @ weights)
        return float((np.abs(self.residual) / level).max())

    @computed_once
    def excess(self) -> float:
        """Largest residual in units of its rounding level; at most a few at a solution."""
        ratio = float((np.abs(self.residual) / self.levels[0]).max())
        return ratio if math.isfinite(ratio) else float("inf")

    def exceeds(self, most: float, weights: np.ndarray) -> bool:
        """Whether `excess` is more than `most`.

        Where that is plain from the metric, magnitudes are not asked for. Weights have the shape (N + 1,).
        """
        if self.evaluation is not None:
            level = self.evaluation() + EPSILON * (np.abs(self.jacobian) @ (LARGEST_MAGNITUDE * weights))
            if (np.abs(self.residual) > most * level).any():
                return True
        return self.excess > most
