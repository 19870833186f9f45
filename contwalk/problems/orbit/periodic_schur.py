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

SCHUR = Entry("contwalk.problems.orbit.schur_sweeps", "schur", "q", "qqq")
# Factors that the iteration is begun at, where it stalls from one.
MOST_STARTS = 8
# So many powers of two, summed over all factors, are within the range of doubles.
SAFE_POWERS = 900


def warmup() -> None:
    """Compile the loops, or find them compiled."""
    _ = SCHUR.address


def product_eigenvalues(factors: Sequence[np.ndarray]) -> np.ndarray:
    """Eigenvalues of factors[-1] @ ... @ factors[0], each of shape (r, r).

    Parameters
    ----------
    factors : sequence of ndarray
        In the order in which they act.

    Returns
    -------
    ndarray of complex, shape (r,)

    Raises
    ------
    numpy.linalg.LinAlgError
        If the iteration does not converge.
    """
    if len(factors) == 1:
        return np.linalg.eigvals(factors[0]).astype(complex)
    if not all(np.any(factor) for factor in factors):
        return np.zeros(len(factors[0]), dtype=complex)
    if len(factors[0]) == 1:
        return scaled_product(np.array([factor[0] for factor in factors], dtype=complex))
    # A product has the eigenvalues of its cyclic permutations: where one stalls another one may not.
    m, r = len(factors), len(factors[0])
    for first in range(0, m, max(m // MOST_STARTS, 1)):
        chain = np.array([*factors[first:], *factors[:first]], dtype=complex)
        if sweeps_of(chain) >= 0:
            return scaled_product(chain.reshape(m, r * r)[:, :: r + 1].copy())
    raise np.linalg.LinAlgError("the periodic QR iteration does not converge")


def sweeps_of(chain: np.ndarray) -> int:
    """Bring factors (m, r, r), complex, to triangles in their place; how many sweeps that took, or -1 where
    they do not converge.
    """
    count: int = SCHUR(address(chain), len(chain), chain.shape[1])
    return count


def conjugates(values: np.ndarray) -> np.ndarray:
    """Complex eigenvalues of a real product, shape (r,), as exact conjugates, which complex arithmetic leaves
    only nearly so.
    """
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


def scaled_product(entries: np.ndarray) -> np.ndarray:
    """Products over the first axis of complex numbers (m, r), shape (r,).

    Partial products may lie far beyond the range of doubles where the whole lies in it: powers of two are
    taken out on the way.
    """
    if not _within_range(entries):
        return _shifted(*_product_and_exponents(entries))
    product = np.ones(entries.shape[1], dtype=complex)
    for row in entries:
        product = product * row
    return product


def _product_and_exponents(entries: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Products over the first axis of complex numbers (m, r), as numbers of size one and powers of two."""
    product, exponents = np.ones(entries.shape[1], dtype=complex), np.zeros(entries.shape[1], dtype=int)
    for row in entries:
        product = product * row
        _, shift = np.frexp(np.maximum(np.abs(product.real), np.abs(product.imag)))
        product, exponents = _shifted(product, -shift), exponents + shift
    return product, exponents


def _within_range(entries: np.ndarray) -> bool:
    """Whether no part of any partial product is beyond the range of doubles: then powers of two, which change
    no digit, need not be taken out.
    """
    parts = np.abs(entries.view(float))
    powers = np.abs(np.frexp(parts[parts > 0.0])[1])
    return bool(np.isfinite(parts).all()) and int(powers.sum()) < SAFE_POWERS


def _shifted(values: np.ndarray, exponents: np.ndarray) -> np.ndarray:
    """Complex numbers times powers of two."""
    with np.errstate(over="ignore"):
        return np.ldexp(values.real, exponents) + 1j * np.ldexp(values.imag, exponents)
