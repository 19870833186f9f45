"""Eigenvalues of an equilibrium, how sure they are, and how fast they move along the branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.numerics import krein
from contwalk.numerics.linear import balanced

EPSILON = float(np.finfo(float).eps)
# A sum that is no more than this part of its terms is rounding of zero.
ROUNDED = 1e-12


@dataclass(frozen=True)
class Spectrum:
    """Eigenvalues sorted by descending real part.

    Parameters
    ----------
    values : ndarray of complex, shape (m,)
    errors : ndarray, shape (m,)
        Estimated absolute error of each.
    rates : ndarray, shape (m,)
        Derivative of each real part along the branch; NaN where eigenvalues coincide.
    still : bool
        Whether the last one, out of order, is zero all along the branch: that of its own direction.
    bordering : ndarray of bool, shape (m,), optional
        Those of a conservative motion that stay on the imaginary axis; None of other motions.
    of_values : ndarray of complex, shape (m,), optional
        Derivatives of the eigenvalues along the branch, where all are known.
    """

    values: np.ndarray
    errors: np.ndarray
    rates: np.ndarray
    still: bool = False
    bordering: np.ndarray | None = None
    of_values: np.ndarray | None = None

    @property
    def measures(self) -> np.ndarray:
        """Real parts, shape (m,); of what stays on the imaginary axis its distance from zero, negative."""
        if self.bordering is None:
            return self.values.real
        return np.where(self.bordering, -np.abs(self.values), self.values.real)

    def unstable(self, before: int | None) -> int:
        """Number of eigenvalues with positive real part.

        One whose sign is not certain in double precision counts as it did at the neighbouring point
        (`before`), so that rounding never looks like a bifurcation.
        """
        real, errors, bordering = self.measures, self.errors, self.bordering
        if self.still:
            real, errors = real[:-1], errors[:-1]
        certain = real > errors
        if before is None:
            return int(np.count_nonzero(certain))
        if bordering is None:
            counted = np.arange(len(real)) < before
        else:  # what stays on the axis is none of those that count
            free = ~bordering[: len(real)]
            counted = free & (np.cumsum(free) <= before)
        doubtful = ~(np.abs(real) > errors)
        counted = certain | (doubtful & counted)
        # Both of a pair are unstable, or neither is: as where it has come out of two real ones that met.
        alone = doubtful & counted & (self.values.imag[: len(real)] != 0.0)
        return int(np.count_nonzero(counted)) - int(np.count_nonzero(alone)) % 2


def complement(generators: np.ndarray) -> np.ndarray:
    """Orthonormal basis of the complement of the neutral directions, shape (..., n, n - k)."""
    q, _ = np.linalg.qr(generators, mode="complete")
    return q[..., generators.shape[-1] :]


def keeps_volumes(matrix: np.ndarray, rate: np.ndarray, rounding: np.ndarray) -> bool:
    """Whether two eigenvalues are lambda and -lambda all along a branch: their sum is zero, and stays so.

    The matrix A, its derivative along the branch and what rounding does to its entries have the shape (2, 2);
    of more eigenvalues it is not asked here.
    """
    if len(matrix) != 2:
        return False
    trace, allowed = matrix.trace(), ROUNDED * np.abs(matrix.diagonal()).sum() + rounding.trace()
    return bool(abs(trace) <= 2.0 * allowed and abs(rate.trace()) <= ROUNDED * np.abs(rate).sum())


def spectrum(
    matrix: np.ndarray,
    rate: np.ndarray,
    rounding: np.ndarray,
    generators: np.ndarray | None = None,
    zeros: int = 0,
) -> Spectrum:
    """Eigenvalues of A, without those of pinned neutral directions.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        A.
    rate : ndarray, shape (n, n)
        Its derivative along the branch.
    rounding : ndarray, shape (n, n)
        Absolute error bounds of its entries.
    generators : ndarray, shape (n, k), optional
        Neutral directions with A g = 0: their zero eigenvalues are left out by going over to the quotient
        space.
    zeros : int
        How many further eigenvalues, the smallest ones, belong to neutral directions without a generator.
    """
    matrix = np.where(np.abs(matrix) <= 2.0 * rounding, 0.0, matrix)  # noise would mislead the balancing
    if generators is not None and generators.size:
        # A g = 0, so A is block triangular in (g, complement): the rest of the spectrum is that of Q' A Q.
        q = complement(generators)
        matrix, rate, rounding = q.T @ matrix @ q, q.T @ rate @ q, np.abs(q.T) @ rounding @ np.abs(q)
    if not len(matrix):
        return Spectrum(np.zeros(0, dtype=complex), np.zeros(0), np.zeros(0))
    scaled, d = balanced(matrix, one_way=True)
    found, right = np.linalg.eig(scaled)
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:
        left = np.full_like(right, np.nan)
    # Where eigenvectors meet, their inverse overflows: the errors are infinite then, and say so.
    with np.errstate(over="ignore", invalid="ignore"):
        # The two-sided Rayleigh quotient is second-order accurate in the vectors: what is left are the
        # roundings of its own terms, those of the entries of A, and the square of what the eigenvalue
        # algorithm leaves behind.
        values = _quotients(left, scaled, right).astype(complex)
        rounded = rounding / d[:, None] * d + 4.0 * EPSILON * np.abs(scaled)
        sensitivity = _quotients(np.abs(left), rounded, np.abs(right))
        norms = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
        backward = EPSILON * np.linalg.norm(scaled) * norms
        gaps = np.abs(values[:, None] - values)
        gaps.flat[:: len(values) + 1] = np.inf
        left_behind = backward**2 / np.maximum(gaps.min(axis=1), 1e-300)
        errors = sensitivity + np.minimum(backward, left_behind)
        moving = _quotients(left, rate / d[:, None] * d, right).astype(complex)
    # Real matrices have exact conjugates; LAPACK lists each pair next to each other.
    real = found.imag == 0.0
    values[real] = values[real].real
    first = np.flatnonzero(found.imag > 0.0)
    values[first + 1] = np.conj(values[first])
    errors[first] = errors[first + 1] = np.maximum(errors[first], errors[first + 1])
    moving[first + 1] = np.conj(moving[first])
    moving[real] = moving[real].real
    if zeros:
        kept = np.sort(np.argsort(np.abs(values), kind="stable")[zeros:])
        values, errors, moving = values[kept], errors[kept], moving[kept]
    order = np.lexsort((-values.imag, -values.real))
    errors = np.where(np.isfinite(errors), errors, np.inf)
    values, moving = values[order], moving[order]
    return _bordering(Spectrum(values, errors[order], moving.real, of_values=moving))


def _bordering(found: Spectrum) -> Spectrum:
    """The same with the pairs of a conservative motion on the imaginary axis, where they stay until two meet.

    Real parts are noise there, and half the digits of it where pairs meet: their signs tell no stability.
    """
    if not krein.hamiltonian(found.values):
        return found
    on_axis = krein.bordering(found.values, found.values**2)
    values = found.values.copy()
    values.real[on_axis] = 0.0
    errors = np.where(on_axis, np.minimum(found.errors, 0.01 * np.abs(values)), found.errors)
    rates = np.where(on_axis, np.nan, found.rates)
    order = np.lexsort((-values.imag, -np.abs(values.imag), -values.real))  # those of a pair are neighbours
    return Spectrum(values[order], errors[order], rates[order], found.still, on_axis[order])


def _quotients(left: np.ndarray, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """left_i . matrix . right_i for rows of `left` and columns of `right`: one product and one sum."""
    return ((left @ matrix) * right.T).sum(axis=1)
