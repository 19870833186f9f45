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

MOST_SWEEPS = 60
# Factors that the iteration is begun at, where it stalls from one.
MOST_STARTS = 8
# An eigenvalue this small against the block that it is in is not known from it.
GRADED = 1e-6
EPSILON = float(np.finfo(float).eps)
# Powers of two further apart than this are as good as zero beside each other.
FARTHEST = 1000
# So many powers of two, summed over all factors, are within the range of doubles.
SAFE_POWERS = 900


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
    for first in range(0, len(factors), max(len(factors) // MOST_STARTS, 1)):
        chain = [np.array(factor, dtype=complex) for factor in (*factors[first:], *factors[:first])]
        try:
            _hessenberg(chain)
            _sweeps(chain)
        except np.linalg.LinAlgError:
            continue
        return scaled_product(np.array([np.diag(factor) for factor in chain]))
    raise np.linalg.LinAlgError("the periodic QR iteration does not converge")


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


def _hessenberg(chain: list[np.ndarray]) -> None:
    """All factors but the last upper triangular, the last one upper Hessenberg."""
    _triangular(chain)
    last = chain[-1]
    for k in range(len(last) - 2):
        q, _ = np.linalg.qr(last[k + 1 :, k : k + 1], mode="complete")
        last[k + 1 :, :] = q.conj().T @ last[k + 1 :, :]
        last[k + 2 :, k] = 0.0
        chain[0][:, k + 1 :] = chain[0][:, k + 1 :] @ q
        _triangular(chain, k + 1)


def _triangular(chain: list[np.ndarray], first: int = 0) -> None:
    """Restore the triangular form of rows and columns from `first` on, passing the changes on to the last."""
    for i in range(len(chain) - 1):
        size = np.linalg.norm(chain[i])
        q, r = np.linalg.qr(chain[i][first:, first:], mode="complete")
        lost = np.flatnonzero(np.diag(r) == 0.0)
        # A factor that is singular to rounding: which rounding it was makes no difference, but zero stops
        # the sweeps.
        r[lost, lost] = 0.1 * EPSILON * size
        chain[i][first:, first:] = r
        chain[i + 1][:, first:] = chain[i + 1][:, first:] @ q


def _sweeps(chain: list[np.ndarray]) -> None:
    """Shifted QR sweeps until the last factor is triangular as well."""
    last = chain[-1]
    high, sweeps = len(last) - 1, 0
    while high > 0:
        sizes = np.abs(np.diag(last))
        below = np.abs(np.diag(last, -1))
        near = sizes[:-1] + sizes[1:]
        # Where both neighbours vanish, the whole factor is the measure.
        near = np.where(near > 0.0, near, np.linalg.norm(last))
        below_is_nothing = below <= EPSILON * near
        for k in np.flatnonzero(below_is_nothing):
            last[k + 1, k] = 0.0
        if last[high, high - 1] == 0.0:
            high, sweeps = high - 1, 0
            continue
        low = high - 1
        while low > 0 and last[low, low - 1] != 0.0:
            low -= 1
        if sweeps >= MOST_SWEEPS:
            raise np.linalg.LinAlgError("the periodic QR iteration does not converge")
        sweeps += 1
        _sweep(chain, low, high, _shift(chain, high, sweeps))


def _shift(chain: list[np.ndarray], high: int, sweeps: int) -> tuple[complex, int]:
    """The eigenvalue of the trailing block of the product that is nearest to its corner: a number and the
    power of two that it is multiplied by, since the block may lie beyond the range of doubles.
    """
    corner = slice(high - 1, high + 1)
    block, exponent = np.eye(2, dtype=complex), 0
    for factor in chain:
        block = factor[corner, corner] @ block
        power = max(int(np.frexp(np.abs(block).max())[1]), -FARTHEST)
        block, exponent = block * 2.0**-power, exponent + power
    if sweeps % 11 == 10:  # an exceptional shift, against cycles
        return complex(abs(block[1, 0]) + abs(block[1, 1])), exponent
    values = np.linalg.eigvals(block)
    sizes = np.abs(values)
    # The smaller of two graded eigenvalues is mostly rounding of the product; shifted by the larger
    # one a sweep carries nothing of the smaller to the corner. Without a shift they separate by themselves,
    # as fast as they are graded.
    if sizes.min() <= GRADED * sizes.max():
        return 0.0, 0
    return complex(values[np.argmin(np.abs(values - block[1, 1]))]), exponent


def _first_column(chain: list[np.ndarray], low: int, shift: tuple[complex, int]) -> np.ndarray:
    """The direction of the first column of the shifted product, shape (2,), in rows low and low + 1."""
    last = chain[-1]
    column = last[low : low + 2, low].copy()
    if shift[0]:
        diagonal = np.array([[factor[low, low]] for factor in chain[:-1]])
        product, exponents = _product_and_exponents(diagonal)
        # Whichever is larger is left as it is, so that nothing overflows.
        ahead = int(exponents[0]) - shift[1]
        column = column * product[0] * 2.0 ** max(min(ahead, 0), -FARTHEST)
        column[0] -= shift[0] * 2.0 ** max(min(-ahead, 0), -FARTHEST)
    return column


def _sweep(chain: list[np.ndarray], low: int, high: int, shift: tuple[complex, int]) -> None:
    """One QR sweep on rows and columns low..high: a bulge is chased through all factors."""
    last, column = chain[-1], _first_column(chain, low, shift)
    for k in range(low, high):
        if k > low:
            column = last[k : k + 2, k - 1].copy()
        rotation = _rotation(column)
        last[k : k + 2, :] = rotation @ last[k : k + 2, :]
        if k > low:
            last[k + 1, k - 1] = 0.0
        for i, factor in enumerate(chain):
            factor[:, k : k + 2] = factor[:, k : k + 2] @ rotation.conj().T
            if i < len(chain) - 1:
                rotation = _rotation(factor[k : k + 2, k])
                factor[k : k + 2, :] = rotation @ factor[k : k + 2, :]
                factor[k + 1, k] = 0.0


def _rotation(column: np.ndarray) -> np.ndarray:
    """The unitary matrix, shape (2, 2), that takes a column to a multiple of (1, 0)."""
    a, b = complex(column[0]), complex(column[1])
    length = float(np.hypot(abs(a), abs(b)))
    if length == 0.0:
        return np.eye(2, dtype=complex)
    a, b = a / length, b / length
    return np.array([[a.conjugate(), b.conjugate()], [-b, a]])
