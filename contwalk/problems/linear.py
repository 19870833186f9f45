"""Small dense linear algebra, scaled so that units of equations and unknowns do not matter."""

from __future__ import annotations

import numpy as np


def equilibration(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and column factors after which the largest entry of each row and column is about one.

    Factors are powers of two, so that scaling is free of rounding.
    """
    magnitude = np.abs(matrix)
    rows = np.ones(matrix.shape[0])
    columns = np.ones(matrix.shape[1])
    for _ in range(3):
        largest = (magnitude * columns).max(axis=1) * rows
        rows /= _power_of_two(np.sqrt(largest))
        largest = (magnitude * rows[:, None]).max(axis=0) * columns
        columns /= _power_of_two(np.sqrt(largest))
    largest = (magnitude * columns).max(axis=1) * rows
    return rows / _power_of_two(largest), columns


def _power_of_two(values: np.ndarray) -> np.ndarray:
    usable = np.where((values > 0) & np.isfinite(values), values, 1.0)
    return np.exp2(np.round(np.log2(usable)))


class Factored:
    """A square matrix, equilibrated; `solve` applies its inverse."""

    def __init__(self, matrix: np.ndarray) -> None:
        self.rows, self.columns = equilibration(matrix)
        self._scaled = matrix * self.rows[:, None] * self.columns

    def solve(self, right: np.ndarray) -> np.ndarray:
        """x with matrix @ x = right.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the matrix is exactly singular.
        """
        return self.columns * np.linalg.solve(self._scaled, self.rows * right)

    def inverse(self) -> np.ndarray:
        """The inverse matrix."""
        return self.columns[:, None] * np.linalg.inv(self._scaled) * self.rows

    def orientation(self) -> float:
        """Sign of the determinant."""
        return float(np.linalg.slogdet(self._scaled)[0])


def null_vectors(matrix: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Right and left vectors nearest to the null space, and all singular values, of the equilibrated matrix.

    Parameters
    ----------
    matrix : ndarray, shape (m, n) with m <= n
    count : int
        Dimension of the right null space that is asked for.

    Returns
    -------
    right : ndarray, shape (n, count)
    left : ndarray, shape (m, count - (n - m))
    values : ndarray, shape (m,), relative to the largest
    """
    rows, columns = equilibration(matrix)
    u, values, vh = np.linalg.svd(matrix * rows[:, None] * columns)
    m, n = matrix.shape
    right = columns[:, None] * vh[n - count :].conj().T
    left = rows[:, None] * u[:, m - (count - (n - m)) :]
    scale = values[0] if values[0] > 0 else 1.0
    return right / np.linalg.norm(right, axis=0), left / np.linalg.norm(left, axis=0), values / scale
