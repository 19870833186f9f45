"""Eigenvalues of a product of matrices that is never formed.

A. Bojanczyk, G. Golub, P. Van Dooren, "The periodic Schur decomposition", Proc. SPIE 1770 (1992) 31: all
factors are brought to triangular form by unitary transformations between neighbours, the last one by way
of Hessenberg form and shifted QR sweeps. Each factor is perturbed by its own rounding only, so that
multipliers of 1e12 and 1e-12 in one product come out with their own relative accuracy, as long as each
factor is well scaled.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.flow.compiled.addresses import address
from contwalk.flow.compiled.entry_points import Entry

EIGENVALUES = Entry("contwalk.problems.orbit.schur_sweeps", "eigenvalues", "q", "qqqq")
# Factors that the iteration is begun at, where it stalls from one.
MOST_STARTS = 8


def warmup() -> None:
    """Compile the loops, or find them compiled."""
    _ = EIGENVALUES.address


def product_eigenvalues(factors: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """Eigenvalues of factors[-1] @ ... @ factors[0], each of shape (r, r).

    Parameters
    ----------
    factors : sequence of ndarray, or ndarray of shape (m, r, r)
        In the order in which they act.

    Returns
    -------
    ndarray of complex, shape (r,)

    Raises
    ------
    numpy.linalg.LinAlgError
        If the iteration does not converge.
    """
    given = np.asarray(factors, dtype=complex)
    m, r, _ = given.shape
    if m == 1:
        return np.linalg.eigvals(factors[0]).astype(complex)
    if not given.any(axis=(1, 2)).all():
        return np.zeros(r, dtype=complex)
    values = np.empty(r, dtype=complex)
    # A product has the eigenvalues of its cyclic permutations: where one stalls another one may not.
    for first in range(0, m, max(m // MOST_STARTS, 1)):
        if sweeps_of(np.concatenate([given[first:], given[:first]]), values) >= 0:
            return values
    raise np.linalg.LinAlgError("the periodic QR iteration does not converge")


def sweeps_of(chain: np.ndarray, values: np.ndarray) -> int:
    """Bring factors (m, r, r), complex, to triangles in their place, and write down the eigenvalues (r,) of
    their product; how many sweeps that took, or -1 where they do not converge.
    """
    m, r, _ = chain.shape
    count: int = EIGENVALUES(address(chain), m, r, address(values))
    return count


def product(factors: Sequence[np.ndarray] | np.ndarray) -> np.ndarray:
    """The product of factors in the order in which they act, formed."""
    whole: np.ndarray = factors[0]
    with np.errstate(over="ignore", invalid="ignore"):  # beyond 1e308 it is infinite
        for factor in factors[1:]:
            whole = factor @ whole
    return whole


def conjugates(values: np.ndarray) -> np.ndarray:
    """Complex eigenvalues of a real product, shape (r,), as exact conjugates, which complex arithmetic leaves
    only nearly so.
    """
    if not values.imag.any():
        return values
    values = values.copy()
    upper = np.flatnonzero(values.imag > 0.0)
    lower = list(np.flatnonzero(values.imag < 0.0))
    for k in upper:
        if not lower:
            break
        partner = min(lower, key=lambda j: abs(values[j] - np.conj(values[k])))
        lower.remove(partner)
        mean = 0.5 * (values[k] + np.conj(values[partner]))
        values[k], values[partner] = mean, np.conj(mean)
    return values
