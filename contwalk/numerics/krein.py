"""Krein collisions: two pairs on the border of stability meet, and leave it as a quadruple.

Eigenvalues of a motion that conserves an energy, or that is reversible, come as lambda and -lambda,
multipliers as mu and 1/mu. A pair on the imaginary axis or on the unit circle cannot leave it alone. Two of
opposite Krein signature can where they meet (J.-C. van der Meer, The Hamiltonian Hopf Bifurcation, 1985);
pairs of one signature pass through each other.

With s = lambda^2, of multipliers s = mu + 1/mu, each pair on the border has one s, which is real, and a
quadruple has two that are conjugates. So (s_1 - s_2)^2 passes zero at full slope, though eigenvectors meet
there: roundings of the matrix move it by as much, and the eigenvalues by the root of that.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

# Sums of odd powers that are no larger, against those of their moduli, are zero; of multipliers the steps
# count.
HAMILTONIAN, SYMPLECTIC = 1e-10, 1e-7
# All eigenvalues may be zero.
TINY = 1e-300
# Two s are conjugates, and one is real, to half the digits: so well eigenvalues are known where pairs meet.
HALF = 1e-6


def hamiltonian(values: np.ndarray) -> bool:
    """Whether eigenvalues, shape (n,), come as lambda and -lambda, two pairs of them or more.

    Sums of their odd powers are zero then, and known to all digits where eigenvalues are not.
    """
    return _balanced(values, -values, range(1, len(values), 2), HAMILTONIAN)


def symplectic(values: np.ndarray) -> bool:
    """Whether multipliers, shape (n,), come as mu and 1/mu, two pairs of them or more."""
    powers = range(1, len(values) // 2 + 1)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # one without a partner has none
        partners = 1.0 / values
    return _balanced(values, partners, powers, SYMPLECTIC)


def _balanced(values: np.ndarray, partners: np.ndarray, powers: range, allowed: float) -> bool:
    if len(values) < 4 or len(values) % 2 or not np.isfinite([values, partners]).all():
        return False
    # Of multipliers beyond 1e154 the square is none: powers are of parts of a power of two, to the same bits.
    unit = float(np.exp2(np.ceil(np.log2(max(np.abs(values).max(), np.abs(partners).max(), TINY)))))
    return all(_cancel((values / unit) ** k, (partners / unit) ** k, allowed) for k in powers)


def _cancel(values: np.ndarray, partners: np.ndarray, allowed: float) -> bool:
    """Whether the sums of both are one, to this part of those of their moduli."""
    moduli = np.abs(values) + np.abs(partners)
    return bool(abs((values - partners).sum()) <= allowed * moduli.sum())


def parted(values: np.ndarray, s: np.ndarray) -> float:
    """(s_1 - s_2)^2 relative to (|s_1| + |s_2|)^2, NaN where there are no two such pairs.

    It is that of the quadruple nearest to its origin, else of the pairs on the border nearest to each other.

    Parameters
    ----------
    values, s : ndarray of complex, shape (n,)
        Eigenvalues or multipliers, and s of each.
    """
    upper = s[values.imag > 0.0]
    found = [_parted(a, b) for a, b in combinations(upper, 2) if _real(a, b) or _conjugates(a, b)]
    left = [value for value in found if value < 0.0]
    return max(left) if left else min(found, default=float("nan"))


def bordering(values: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Which of the eigenvalues of a Hamiltonian spectrum are on the border, shape (n,)."""
    found = np.zeros(len(values), dtype=bool)
    for i in np.flatnonzero(values.imag != 0.0):
        same = np.flatnonzero((values.imag * values[i].imag > 0.0) & (np.arange(len(values)) != i))
        quadruple = any(_conjugates(s[i], s[j]) and _parted(s[i], s[j]) < 0.0 for j in same)
        found[i] = not quadruple and abs(s[i].imag) <= HALF * abs(s[i])
    return found


def _parted(a: complex, b: complex) -> float:
    return float(((a - b) ** 2).real) / float(abs(a) + abs(b)) ** 2


def _conjugates(a: complex, b: complex) -> bool:
    return bool(abs(a - np.conj(b)) <= HALF * (abs(a) + abs(b)))


def _real(a: complex, b: complex) -> bool:
    return bool(max(abs(a.imag), abs(b.imag)) <= HALF * (abs(a) + abs(b)))
