"""Null vectors of nearly singular matrices of an orbit, by bordering.

With almost any borders b and c, [A b; c* 0] [v; g] = [0; 1] is regular though A is singular, v is its right
null vector and, from the adjoint system, psi its left one. Of a matrix that is only nearly singular they are
null vectors but for g; with themselves as the next borders they become its critical singular vectors
(W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, chapter 3).
"""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.orbit_data import OrbitData

# Of a scaled matrix with g as small as this, null vectors are known well enough.
NULL = 1e-8
# What borders become by so many rounds is the best that there is far from a singular point.
ROUNDS = 3
# Vectors of a regular bordered matrix are not longer than this, against borders of length one.
LONGEST = 1e10


def bordered(
    problem: OrbitData, matrix: np.ndarray, b: np.ndarray, c: np.ndarray
) -> tuple[np.ndarray, np.ndarray, complex]:
    """v, psi and g of the bordered systems of a scaled matrix.

    The matrix has the shape (m, m), all vectors (m,).

    Raises
    ------
    numpy.linalg.LinAlgError
        If the bordered matrix is exactly singular.
    """
    size = len(matrix)
    whole = np.zeros((size + 1, size + 1), dtype=np.result_type(matrix, b, c))
    whole[:size, :size], whole[:size, size], whole[size, :size] = matrix, b, c.conj()
    unit = np.zeros(size + 1)
    unit[size] = 1.0
    factored = problem.factored(whole, np.ones(size + 1))
    right, left = factored.solve(unit), factored.solve_adjoint(unit)
    return right[:size], left[:size], right[size]


def critical_vectors(problem: OrbitData, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Left and right null vectors b and c, of length one, of a scaled matrix that is nearly singular."""
    size = len(matrix)
    c, b = np.cos(np.arange(1.0, size + 1.0)), np.sin(np.arange(1.0, size + 1.0))
    b, c = b / np.linalg.norm(b), c / np.linalg.norm(c)
    for _ in range(ROUNDS):
        try:
            v, psi, g = bordered(problem, matrix, b, c)
        except np.linalg.LinAlgError:
            return _by_svd(matrix)
        length, other = float(np.linalg.norm(v)), float(np.linalg.norm(psi))
        if not (length < LONGEST and other < LONGEST):
            return _by_svd(matrix)
        c, b = v / length, psi / other
        if abs(g) <= NULL * length:
            break
    return b, c


def _by_svd(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """THE LAST RESORT, many times dearer than a border: where one border leaves the matrix singular,
    its null space has more than one dimension, and only the SVD tells one pair of null vectors from others.
    """
    u, _, vh = np.linalg.svd(matrix)
    return u[:, -1], vh[-1].conj()


def null_vectors(
    problem: OrbitData, matrix: np.ndarray, rows: np.ndarray, columns: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Right and left null vectors of a nearly singular matrix from its scaled form, L v = 0 and psi* L = 0.

    `rows` and `columns` are the units of its equations and of its unknowns; both vectors are units in the
    scaled norm.

    The matrix has the shape (m, m), all vectors (m,).
    """
    b, c = critical_vectors(problem, matrix / rows[:, None] * columns)
    return c * columns, b / rows
