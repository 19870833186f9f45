"""Floquet multipliers: eigenvalues of the closure's derivative without the flow's own and the pinned ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.problems.orbit.schur import product_eigenvalues
from contwalk.problems.spectrum import complement

EPSILON = float(np.finfo(float).eps)
REAL = 1e-11
# How much of the local errors reaches the monodromy matrix, in units of the tolerance: a bound seen in practice.
GLOBAL = 30.0


@dataclass(frozen=True)
class Multipliers:
    """Multipliers by descending modulus, with their estimated absolute errors, both of shape (r,)."""

    values: np.ndarray
    errors: np.ndarray

    @property
    def measures(self) -> np.ndarray:
        """Modulus minus one: negative for stability."""
        return np.abs(self.values) - 1.0

    def unstable(self, before: int | None) -> int:
        """Number of multipliers outside the unit circle; doubtful ones count as at the neighbouring point."""
        measures = self.measures
        if before is None:
            return int(np.sum(measures > self.errors))
        known = np.abs(measures) > self.errors
        return int(np.sum(np.where(known, measures > 0.0, np.arange(len(measures)) < before)))


def multipliers(
    factors: Sequence[np.ndarray],
    neutral: Sequence[np.ndarray],
    magnitudes: np.ndarray,
    tolerance: float,
) -> Multipliers:
    """Multipliers of the product of the segments' derivatives.

    Parameters
    ----------
    factors : sequence of ndarray, shape (n, n)
        Derivative of each segment's end by its start, the closure applied to the last one.
    neutral : sequence of ndarray, shape (n, k)
        At the start of each segment, the directions that are carried into each other: the flow's own (of an
        autonomous system) and pinned generators. They are left out by going over to the quotient space.
    magnitudes : ndarray, shape (n,)
        Typical magnitudes of the states; the quotient is orthogonal in their units.
    tolerance : float
        Of the integration.
    """
    scaled = [factor / magnitudes[:, None] * magnitudes for factor in factors]
    if neutral[0].shape[1]:
        bases = [complement(directions / magnitudes[:, None]) for directions in neutral]
        m = len(factors)
        scaled = [bases[(i + 1) % m].T @ scaled[i] @ bases[i] for i in range(m)]
    if not len(scaled[0]):
        return Multipliers(np.zeros(0, dtype=complex), np.zeros(0))
    values, errors = _single(scaled[0], tolerance) if len(scaled) == 1 else _product(scaled, tolerance)
    order = np.lexsort((-values.imag, -np.abs(values)))
    return Multipliers(values[order], errors[order])


def _single(matrix: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of one matrix; their errors from its own error and their conditions."""
    values, right = np.linalg.eig(matrix)
    values = values.astype(complex)
    try:
        left = np.linalg.inv(right)
        condition = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
    except np.linalg.LinAlgError:
        condition = np.full(len(values), 1e8)
    noise = (GLOBAL * tolerance + 10.0 * EPSILON) * max(float(np.linalg.norm(matrix, 2)), 1e-300)
    # Where eigenvalues meet, first-order conditions are infinite; the square root of the noise bounds them.
    size = float(np.linalg.norm(matrix, 2))
    return values, np.minimum(condition * noise, np.sqrt(noise * max(size, 1e-300)))


def _product(factors: Sequence[np.ndarray], tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of an unformed product, with errors relative to their own size."""
    values = product_eigenvalues(factors)
    # The factors are real: what is left of an imaginary part by the complex arithmetic is rounding.
    values = np.where(np.abs(values.imag) <= REAL * np.abs(values), values.real, values).astype(complex)
    # A factor is wrong by the tolerance of its norm; what that does to an eigenvalue depends on how far its
    # own growth is from the largest, segment by segment.
    largest = float(np.prod([max(np.linalg.norm(factor, 2), 1e-300) ** (1.0 / len(factors)) for factor in factors]))
    own = np.maximum(np.abs(values), 1e-300) ** (1.0 / len(factors))
    relative = len(factors) * (GLOBAL * tolerance + 10.0 * EPSILON) * np.maximum(largest / own, 1.0)
    return values, np.abs(values) * relative
