"""Weighted sums of states that a field conserves and nobody has declared, as totals of reactions."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# So many states beside the start are asked, at most this part of themselves away, and as many parameters.
PLACES, AWAY = 4, 0.1
# Singular values below this part of the largest are zero: fields are rounded to 1e-16 of their terms.
ZERO = 1e-12
# A weight this near to a number of so many digits, or to none in like units, is that; and a sum moves by no
# more of what its terms do.
EXACT, DIGITS = 1e-11, 6


def conserved_sums(problem: EquilibriumEquations, z: np.ndarray) -> np.ndarray:
    """Weights w with w . f = 0 at all states, as rows in echelon form, shape (k, n).

    z, shape (N + 1,), is a state of equations without pins. A sum that depends on the free parameter, too,
    is no sum that a branch keeps: the parameter is moved as well.
    """
    n = problem.states
    none = np.zeros((0, n))
    columns = []
    if not np.all(np.isfinite(z)):
        return none
    try:
        for k in range(PLACES):
            moved = z + AWAY * np.cos(np.arange(1.0, len(z) + 1.0) * (k + 1.0)) * (np.abs(z) + (z == 0.0))
            here = problem.linearize(moved)
            columns += [here.residual[:n, None], problem.jacobian(moved)[:n, :n]]
    except (NotFinite, PluginError):
        return none
    matrix = np.hstack(columns)
    if not np.all(np.isfinite(matrix)):
        return none
    units, weights, seen = np.ones(n), none, matrix
    for _ in range(n):  # a state's weight may be found after another's
        seen = seen / np.maximum(np.abs(seen).max(axis=0), np.finfo(float).tiny)
        left, sizes, _ = np.linalg.svd(seen)
        rank = int(np.count_nonzero(sizes > ZERO * sizes[0])) if sizes[0] > 0.0 else 0
        found = _echelon(left[:, rank:].T)
        factors = _alike(np.abs(seen), np.abs(found).max(axis=0, initial=0.0))
        seen, units, weights = seen * factors[:, None], units * factors, found * units
    missed = np.abs(weights @ matrix) > EXACT * (np.abs(weights) @ np.abs(matrix))
    return _as_written(weights[~missed.any(axis=1)])


def _alike(sizes: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Factors of rates, shape (n,), after which all weights are about one: none is lost in rounding then.

    Of entries with these sizes, shape (n, c), weights `own` are known, shape (n,). Where one is zero it may
    be lost: it is no larger than what the others, in each column, are against it.
    """
    others = own @ sizes
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = np.where(sizes > 0.0, others / sizes, np.inf).min(axis=1)
    return np.where(own > 0.0, own, np.where((bounds > 0.0) & (bounds < 1.0), bounds, 1.0))


def _echelon(rows: np.ndarray) -> np.ndarray:
    """The same space of weights, rows of shape (k, n), by rows of which each has a state of its own."""
    rows = rows.copy()
    for k in range(len(rows)):
        sizes = np.round(np.abs(rows[k:]), DIGITS)  # of two that are alike the first
        pivot = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        row, column = int(pivot[0]) + k, int(pivot[1])
        rows[[k, row]] = rows[[row, k]]
        rows[k] /= rows[k, column]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, column], rows[k])
    rows[np.abs(rows) < EXACT] = 0.0
    return rows


def _as_written(rows: np.ndarray) -> np.ndarray:
    """Weights, shape (k, n), of which the largest is 1 in each row and the first one positive."""
    for row in rows:
        row /= np.abs(row).max() * np.sign(row[np.flatnonzero(row)[0]])
        near = np.array([float(f"{weight:.{DIGITS}g}") for weight in row])
        row[:] = np.where(np.abs(row - near) < EXACT * np.abs(row), near, row)
    return rows
