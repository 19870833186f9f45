"""Where two curves of orbits that solve the same equations cross.

DF of the curve, (W - 1, W), loses rank there: with one column and two rows as borders the inverse has two
corners that both vanish (Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, section
5.2), and with F + mu b for F, b the column, such a point is a regular solution. DF contains second
derivatives of the flow already; what the corners change by is the difference of DF to both sides along their
vectors, so that Newton's method is one with nearly exact slopes: where it ends does not depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample

# How far along a vector of length one, in the metric, DF is looked at for its slope.
BESIDE = 1e-4
# Where a located point keeps the tangents of both curves.
WAYS = "crossing"


@dataclass(frozen=True)
class Borders:
    """A column and two rows that make DF, in units of rows and of unknowns, regular where curves cross.

    `rows` has the shape (W - 1,), `columns` (W,), `left` (W - 1,), `right` (2, W).
    """

    rows: np.ndarray
    columns: np.ndarray
    left: np.ndarray
    right: np.ndarray

    def told(self, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Both corners, shape (2,), their vectors in units of the unknowns, (2, W), and p, (W - 1,)."""
        width = jacobian.shape[1]
        matrix = np.zeros((width + 1, width + 1))
        matrix[:-2, :-1] = jacobian / self.rows[:, None] * self.columns
        matrix[:-2, -1], matrix[-2:, :-1] = self.left, self.right
        both = np.linalg.solve(matrix, np.eye(width + 1)[:, -2:])
        adjoint = np.linalg.solve(matrix.T, np.eye(width + 1)[:, -1])
        return both[-1], both[:-1].T, adjoint[:-2]


def borders(problem: Any, sample: Sample) -> Borders:
    """Borders from the singular vectors of DF near a sample."""
    scaled = problem.linearize(sample.z).jacobian * sample.weights
    rows = np.abs(scaled).max(axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)
    u, _, vh = np.linalg.svd(scaled / rows[:, None])
    return Borders(rows, sample.weights, u[:, -1], vh[-2:])


def crossing_system(problem: Any, sample: Sample) -> Augmented:
    """The equations of a point near a sample at which two curves of the problem cross; mu is zero there."""
    held, width = borders(problem, sample), len(sample.z)
    column = held.rows * held.left

    def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = y[:width]
        own = there.linearize(z)
        corners, vectors, p = held.told(own.jacobian)
        jacobian = np.zeros((width + 1, width + 1))
        jacobian[:-2, :-1], jacobian[:-2, -1] = own.jacobian, column
        jacobian[-2:, :-1] = [-slope(there, z, held, p, q) for q in vectors]
        return np.concatenate([own.residual + y[width] * column, corners]), jacobian

    def vectors(there: Any, y: np.ndarray) -> dict[str, Any]:
        return {WAYS: ways(there, y[:width], held)}

    start, scale = np.append(sample.z, 0.0), np.append(sample.weights, 1.0)
    return Augmented(evaluate, start, scale, vectors)


def slope(there: Any, z: np.ndarray, held: Borders, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """What p DF changes by along q, by each unknown, shape (W,); F's second derivative is symmetric.

    z has the shape (W,), p (W - 1,) and q (W,), in the units of the borders.
    """
    step = BESIDE / float(np.linalg.norm(q)) * q * held.columns
    ahead, behind = (there.linearize(z + side * step).jacobian for side in (1.0, -1.0))
    change: np.ndarray = (p / held.rows) @ (ahead - behind)
    return change * float(np.linalg.norm(q)) / (2.0 * BESIDE)


def ways(there: Any, z: np.ndarray, held: Borders) -> np.ndarray:
    """Tangents of both curves that cross at z, of length one in the metric, shape (2, W); none, (0, W).

    They are the directions in the plane of both null vectors along which p F changes by less than a square.
    """
    _, vectors, p = held.told(there.linearize(z).jacobian)
    slopes = np.array([slope(there, z, held, p, q) for q in vectors]) * held.columns
    form = slopes @ vectors.T
    a, b, c = form[0, 0], 0.5 * (form[0, 1] + form[1, 0]), form[1, 1]
    square = b * b - a * c
    if not square > 0.0:
        return np.zeros((0, len(z)))
    root = -(b + np.copysign(np.sqrt(square), b))
    shares = np.array([[root, a], [c, root]])
    found = shares @ vectors
    return found / np.linalg.norm(found, axis=1)[:, None] * held.columns


def tangent_through(located: Located, near: Sample) -> np.ndarray | None:
    """Of the tangents of the curves that cross at a point that of the one that `near` is on, facing its way.

    Shape (W,). None of a point at which no curves cross.
    """
    found = located.vectors.get(WAYS)
    if found is None or not len(found):
        return None
    products = (found / near.weights) @ (near.tangent / near.weights)
    best = int(np.argmax(np.abs(products)))
    return np.asarray(found[best] * np.sign(products[best]))
