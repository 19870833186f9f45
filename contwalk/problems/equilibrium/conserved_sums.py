"""Weighted sums of states that a field conserves and nobody has declared, as totals of reactions."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# So many states beside the start are asked, at most this part of themselves away, and as many parameters.
PLACES, AWAY = 4, 0.1
# Singular values below this part of the largest are zero: fields are rounded to 1e-16 of their terms.
ZERO = 1e-12
# A weight this near to a number of so many decimals is that.
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
    matrix = matrix / np.maximum(np.abs(matrix).max(axis=0), np.finfo(float).tiny)
    left, sizes, _ = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(sizes > ZERO * sizes[0])) if sizes[0] > 0.0 else 0
    return _echelon(left[:, rank:].T)


def _echelon(rows: np.ndarray) -> np.ndarray:
    """The same space by rows of which each has a state of its own, with the weight 1."""
    rows = rows.copy()
    for k in range(len(rows)):
        pivot = np.unravel_index(int(np.argmax(np.abs(rows[k:]))), rows[k:].shape)
        row, column = int(pivot[0]) + k, int(pivot[1])
        rows[[k, row]] = rows[[row, k]]
        rows[k] /= rows[k, column]
        others = np.arange(len(rows)) != k
        rows[others] -= np.outer(rows[others, column], rows[k])
    near = np.round(rows, DIGITS)
    rows = np.where(np.abs(rows - near) < EXACT, near, rows)
    for row in rows:  # as one writes them
        row *= np.sign(row[np.flatnonzero(row)[0]])
    return rows
