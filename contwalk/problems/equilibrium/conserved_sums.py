"""Weighted sums of states that a field conserves and nobody has declared, as totals of reactions."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.refine import DIGITS
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# So many states more than there are rates are asked, at most this part of themselves away from the start.
MORE, AWAY = 4, 0.1
# Half the digits of extended precision: what is left of rates below this part of theirs is zero.
ZERO = 1e-20
# A weight this near to a number of so many digits is that; and a sum moves by no more of what its terms do.
EXACT, WRITTEN = 1e-11, 6


def conserved_sums(problem: EquilibriumEquations, z: np.ndarray) -> np.ndarray:
    """Weights w with w . f = 0 at all states, as rows in echelon form, shape (k, n).

    z, shape (N + 1,), is a state of equations without pins. A sum that depends on the free parameter, too,
    is no sum that a branch keeps: the parameter is moved as well. Rates are evaluated and eliminated with 40
    digits: beside a reaction that is 1e12 times as fast a slow one is rounding to floats, and what only the
    fast ones keep would be taken for conserved.
    """
    import mpmath

    n = problem.states
    none = np.zeros((0, n))
    sizes, numbers = np.abs(z) + (z == 0.0), np.arange(1.0, len(z) + 1.0)
    with mpmath.workdps(DIGITS), np.errstate(invalid="ignore"):
        try:
            places = (z + AWAY * np.cos(numbers * (k + 1.0)) * sizes for k in range(n + MORE))
            inputs = (problem.exact_inputs([mpmath.mpf(float(v)) for v in place]) for place in places)
            rates = np.array([problem.kernels.residual.exactly(*each)[:n] for each in inputs], object).T
            if not np.all(np.isfinite(rates.astype(float))):
                return none
            weights = _echelon(_unmoved(rates))
        except (NotFinite, PluginError, ArithmeticError, ValueError):
            return none
        missed = np.abs(weights @ rates) > EXACT * (np.abs(weights) @ np.abs(rates))
    return _as_written(weights[~missed.any(axis=1)].astype(float))


def _unmoved(rates: np.ndarray) -> np.ndarray:
    """Weights, rows of shape (k, n), with which rates, (n, m) in extended precision, add up to zero."""
    sizes = np.abs(rates).max(axis=1)
    units = 1 / np.where(sizes > 0, sizes, 1)
    rows, own = rates * units[:, None], np.diag(units)
    for k in range(len(rows)):
        left = np.abs(rows[k:])
        row, column = (int(i) for i in np.unravel_index(int(np.argmax(left)), left.shape))
        if left[row, column] <= ZERO:
            return own[k:]
        for each in (rows, own):
            each[[k, k + row]] = each[[k + row, k]]
        factors = rows[k + 1 :, column] / rows[k, column]
        own[k + 1 :] -= np.outer(factors, own[k])
        rows[k + 1 :] -= np.outer(factors, rows[k])
    return own[len(rows) :]


def _echelon(rows: np.ndarray) -> np.ndarray:
    """The same space of weights, rows of shape (k, n), in place: each row has a state of its own."""
    for k in range(len(rows)):
        # Of two that are alike the first.
        sizes = np.round((np.abs(rows[k:]) / np.abs(rows[k:]).max()).astype(float), WRITTEN)
        pivot = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        row, column = int(pivot[0]) + k, int(pivot[1])
        rows[[k, row]] = rows[[row, k]]
        rows[k] = rows[k] / rows[k, column]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, column], rows[k])
        rows[np.abs(rows) < ZERO] = 0
    return rows


def _as_written(rows: np.ndarray) -> np.ndarray:
    """Weights, shape (k, n), of which the largest is 1 in each row and the first one positive."""
    for row in rows:
        row /= np.abs(row).max() * np.sign(row[np.flatnonzero(row)[0]])
        near = np.array([float(f"{weight:.{WRITTEN}g}") for weight in row])
        row[:] = np.where(np.abs(row - near) < EXACT * np.abs(row), near, row)
    return rows
