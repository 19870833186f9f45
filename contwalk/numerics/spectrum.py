"""Eigenvalues of an equilibrium, how sure they are, and how fast they move along the branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.numerics import krein
from contwalk.numerics.linear import EPSILON, balanced

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


def taken_out(values: np.ndarray, wanted: np.ndarray) -> tuple[list[int], list[int]]:
    """Numbers of the values that are left, in their order, and of those nearest to wanted ones, each once.

    The values have the shape (n,), the wanted ones (k,).
    """
    kept, taken = list(range(len(values))), list[int]()
    for value in wanted:
        taken.append(min(kept, key=lambda k: abs(values[k] - value)))
        kept.remove(taken[-1])
    return kept, taken


def complement(generators: np.ndarray) -> np.ndarray:
    """Orthonormal basis of the complement of the neutral directions, shape (..., n, n - k)."""
    q, _ = np.linalg.qr(generators, mode="complete")
    return q[..., generators.shape[-1] :]


def quotient(
    matrix: np.ndarray, rate: np.ndarray, rounding: np.ndarray, generators: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, its rate and its error bounds, shape (n - k, n - k), with one state less for each generator.

    Of what is conserved, g A = 0, a state is told by the others; along a neutral direction, A g = 0, the
    others count from where a state is. It is the state whose entries bring the least error to where they come
    to stand: an orthonormal basis would add those of the fastest one to all others, and leave nothing of what
    is slower than it by the inverse of the rounding unit.
    """
    while generators.shape[1]:
        conserved = np.abs(generators.T @ matrix).sum(axis=1) < np.abs(matrix @ generators).sum(axis=0)
        errors = EPSILON * np.abs(matrix) + rounding
        sizes = np.abs(generators.T)
        brought = np.where(conserved[:, None], sizes @ errors, sizes @ errors.T)
        brought = np.divide(brought, sizes, out=np.full(sizes.shape, np.inf), where=sizes > 0.0)
        row, i = np.unravel_index(int(np.argmin(brought)), brought.shape)
        shares, by_others = generators[:, row] / generators[i, row], bool(conserved[row])
        errors = _without(errors, int(i), np.abs(shares), by_others)
        matrix, rate = (_without(m, int(i), -shares, by_others) for m in (matrix, rate))
        rounding = errors
        taken = np.outer(shares, generators[i])
        rest = generators - taken
        rest[np.abs(rest) <= 4.0 * EPSILON * np.abs(taken)] = 0.0
        generators = np.delete(np.delete(rest, i, axis=0), row, axis=1)
    return matrix, rate, rounding


def _without(m: np.ndarray, i: int, shares: np.ndarray, by_others: bool) -> np.ndarray:
    """A matrix, shape (n, n), without state i: its column, or its row, goes to the others by shares."""
    moved = m + (np.outer(m[:, i], shares) if by_others else np.outer(shares, m[i]))
    return np.delete(np.delete(moved, i, axis=0), i, axis=1)


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
        Neutral directions with A g = 0, or gradients of what is conserved, g A = 0: their zero eigenvalues
        are left out by going over to the `quotient`.
    zeros : int
        How many further eigenvalues, the smallest ones, belong to neutral directions without a generator.
    """
    matrix = np.where(np.abs(matrix) <= 2.0 * rounding, 0.0, matrix)  # noise would mislead the balancing
    if generators is not None and generators.size:
        matrix, rate, rounding = quotient(matrix, rate, rounding, generators)
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
        # roundings of its own terms, those of the entries of A, and what the eigenvalue algorithm leaves
        # beside the diagonal, by twos and over what lies between (G. W. Stewart & J. Sun, 1990, IV.2.3): of
        # a slow one beside fast ones that is far less than the part of the norm that any may have.
        product = left @ scaled @ right
        values = product.diagonal().astype(complex)
        rounded = rounding / d[:, None] * d + 4.0 * EPSILON * np.abs(scaled)
        sensitivity = np.abs(left) @ rounded @ np.abs(right)
        norms = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
        backward = EPSILON * np.linalg.norm(scaled) * norms
        beside = np.abs(product) + sensitivity
        gaps = np.abs(values[:, None] - values)
        gaps.flat[:: len(values) + 1] = np.inf
        left_behind = (beside * beside.T / np.maximum(gaps, 1e-300)).sum(axis=1)
        errors = sensitivity.diagonal() + np.minimum(backward, left_behind)
        # Beside eigenvalues that are one with their vectors first order tells nothing. Whatever the vectors
        # are, none is farther off than this (L. Elsner, Linear Algebra Appl. 71, 1985, 77).
        whole, off, share = np.linalg.norm(scaled), np.linalg.norm(rounded), 1.0 / len(scaled)
        farthest = (2.0 * whole) ** (1.0 - share) * (EPSILON * whole + off) ** share
        alike = ~(errors <= farthest)
        values[alike], errors[alike] = found[alike], farthest
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
    ordered = Spectrum(values, errors[order], moving.real, of_values=moving)
    return _bordering(ordered, keeps_volumes(matrix, rate, rounding))


def _bordering(found: Spectrum, alone: bool) -> Spectrum:
    """The same with the pairs of a conservative motion on the imaginary axis, where they stay until two meet.

    Real parts are noise there, and half the digits of it where pairs meet: their signs tell no stability.
    `alone`: it is the only pair.
    """
    if not (alone or krein.hamiltonian(found.values)):
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
