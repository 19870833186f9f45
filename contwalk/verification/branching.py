"""A branch point: equations that lose an independent one, with an unknown that keeps branches together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.finding import CannotTell
from contwalk.verification.passage import TIGHT
from contwalk.verification.solving import ROUGH, Condition


class Unfolded(Equations):
    """F(z) + e w = 0 with one unknown e more: regular where two branches cross, and e is zero on both.

    Parameters
    ----------
    equations : Equations
        At a branch point: their derivatives have a left null vector w there.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations, self.functions, self.unit = equations, equations.functions, equations.unit
        size = self.own = equations.size
        self.z = np.insert(equations.z, size, 0.0)
        self.sizes, self.size = np.insert(equations.sizes, size, 1.0), size + 1
        at = equations.at(equations.z, TIGHT)
        scaled = at.jacobian * equations.sizes
        _, values, right = np.linalg.svd(scaled)
        if values[size - 2] < ROUGH * values[0]:
            raise CannotTell("More than two branches meet there, or a whole family.")
        beside = equations.at(equations.z + 1e-3 * equations.sizes * right[-1], TIGHT)
        self.rows = np.linalg.svd(beside.jacobian * equations.sizes)[0][:, :size].T
        left, _, right = np.linalg.svd(self.rows @ scaled)
        self.null, self.kernel = left[:, -1], right[size - 1 :]

    @property
    def rank(self) -> int:
        """As many as of the equations themselves beside the point."""
        return self.own

    def at(self, z: np.ndarray, relative: float) -> Evaluation:
        """The equations at z, shape (N + 1 + k,), with e before the free parameters."""
        at = self.equations.at(np.delete(z, self.own), relative)
        jacobian = np.insert(self.rows @ at.jacobian, self.own, self.null, axis=1)
        return Evaluation(
            z,
            self.rows @ at.residual + z[self.own] * self.null,
            jacobian,
            at.matrix,
            relative,
            at.trivial,
            at.legs,
        )

    def inner(self, at: Evaluation) -> Evaluation:
        """The same place without e."""
        return replace(at, z=np.delete(at.z, self.own))

    def rounded(self, at: Evaluation) -> np.ndarray:
        """By how much rounding may change the residuals at a place, shape (m,)."""
        there = self.equations.at(np.delete(at.z, self.own), at.relative)
        return np.asarray(np.abs(self.rows) @ self.equations.rounded(there))

    def condition(self, number: int) -> Condition:
        """One of the numbers that all are zero where the derivatives lose a rank."""

        def value(at: Evaluation) -> float:
            moved = np.delete(at.jacobian, self.own, axis=1) * self.equations.sizes
            n, k = moved.shape[0], len(self.kernel)
            whole = np.block([[moved.T, self.kernel.T], [self.null[None], np.zeros((1, k))]])
            return float(np.linalg.solve(whole, np.append(np.zeros(moved.shape[1]), 1.0))[n + number])

        return value

    @property
    def conditions(self) -> list[Condition]:
        """As many as the derivatives have directions more than is usual."""
        return [self.condition(number) for number in range(len(self.kernel))]
