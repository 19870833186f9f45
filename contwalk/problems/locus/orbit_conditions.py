"""What curves of orbits hold: conditions beside the orbit's own equations, each a minimally augmented system.

| curve | condition | further unknowns |
|---|---|---|
| LP | F_u is singular | |
| PD | L(-1) is singular | |
| NS | L(mu) is singular for mu and 1/mu | k = (mu + 1/mu) / 2 |
| GR, OC, AZ | the equations of the limit | as it has |
| BP | [F_u F_parameter] has deficient rank, for one parameter | mu, which unfolds F |
| BP where a symmetry is lost | L(-1) is singular | |
| UZ | an observable, or a parameter, is at its value | |

L(mu) is F_u with what closes being mu times what began. A pair mu, 1/mu with mu^2 = 2 k mu - 1 is looked
for in the numbers a + b mu with real a and b: the bordered inverse has the corner g = g0 + g1 mu, and g0 =
g1 = 0 are regular where mu is exp(+-i theta), k = cos theta, where both are one or both minus one (strong
resonances 1:1 and 1:2), and beyond, where they are real (neutral saddles; Govaerts, Kuznetsov & Dhooge
2005, SIAM J. Sci. Comput. 27, 231).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.linear import Factored
from contwalk.problems.locus.bordered import major, towards
from contwalk.problems.orbit import scales, variations
from contwalk.problems.orbit.augmented import Augmented, Near
from contwalk.problems.orbit.null_vectors import critical_vectors
from contwalk.problems.orbit.orbit_data import OrbitData

# What a condition of a pair is made of: g, v, both left vectors, what L changes by, and DF.
Parts = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class At:
    """A place that a condition is made near.

    Parameters
    ----------
    z, weights : ndarray, shape (N + 1,)
        Unknowns of an orbit with the first parameter, and typical magnitudes.
    second : float
        The typical magnitude of the second parameter.
    plane : OrbitPlane, optional
        The orbits at all values of both parameters, for conditions that ask for both lines.
    value : float, optional
        The second parameter itself.
    """

    z: np.ndarray
    weights: np.ndarray
    second: float
    plane: Any = None
    value: float = 0.0

    @property
    def place(self) -> np.ndarray:
        """(u, second, first), shape (N + 2,)."""
        return np.concatenate([self.z[:-1], [self.value], self.z[-1:]])

    @property
    def in_plane(self) -> np.ndarray:
        """Typical magnitudes of (u, second, first), shape (N + 2,)."""
        return np.concatenate([self.weights[:-1], [self.second], self.weights[-1:]])


def pair_system(problem: OrbitData, near: Near, cosine: float, held: bool = False) -> Augmented:
    """A pair of multipliers mu, 1/mu with (mu + 1/mu) / 2 = k, near a place and a value of k.

    k is a further unknown; where it is `held` it keeps its value, and there is none.
    """
    size, (rows, columns) = problem.size, scales.cycle_scales(problem, near.weights)
    row, column = _borders(problem, near, cosine)

    def matrices(jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The bordered L(0), and what it changes by with mu, scaled."""
        still = variations.cycle_matrix(problem, jacobian, 0.0).real / rows[:, None] * columns
        turned = variations.cycle_matrix(problem, jacobian, 1.0).real / rows[:, None] * columns - still
        whole = np.block([[still, column[:, None]], [row, np.zeros(1)]])
        return whole, np.pad(turned, (0, 1))

    def solved(there: OrbitData, y: np.ndarray) -> Parts:
        """g, v, both left vectors, what L changes by, and DF."""
        k = cosine if held else float(y[size + 1])
        jacobian = there.linearize(y[: size + 1]).jacobian
        whole, changing = matrices(jacobian)
        factored = Factored(np.block([[whole, -changing], [changing, whole + 2.0 * k * changing]]))
        corners = np.array([size, 2 * size + 1])
        units = np.eye(2 * size + 2)[:, corners]
        x, left = factored.solve(units[:, 0]), factored.solve_adjoint(units).T
        return x[corners], x.reshape(2, -1)[:, :size], left.reshape(2, 2, -1)[:, :, :size], changing, jacobian

    def bordered(there: OrbitData, y: np.ndarray, parts: Parts) -> tuple[np.ndarray, np.ndarray]:
        z, (g, v, left, changing, jacobian) = y[: size + 1], parts
        moved = [variations.cycle_derivative(there, z, own * columns) / rows[:, None] for own in v]
        matrix = np.zeros((size + 2, len(y)))
        matrix[:size, : size + 1] = jacobian
        matrix[size:, : size + 1] = -(left[:, 0] @ moved[0] + left[:, 1] @ moved[1])
        if not held:
            matrix[size:, size + 1] = -2.0 * left[:, 1] @ (changing[:size, :size] @ v[1])
        return np.concatenate([there.linearize(z).residual, g]), matrix

    def evaluate(there: OrbitData, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return bordered(there, y, solved(there, y))

    def in_plane(
        there: OrbitData, across: OrbitData, y: np.ndarray, second: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        parts, place = solved(there, y), np.append(y[:size], second)
        column = variations.by_parameter(across, place, parts[2] / rows, parts[1] * columns)
        return *bordered(there, y, parts), np.concatenate(column)

    further = [] if held else [cosine]
    start, scale = np.append(near.z, further), np.append(near.weights, np.ones(len(further)))
    return Augmented(evaluate, start, scale, in_plane=in_plane)


def _borders(problem: OrbitData, near: Near, cosine: float) -> tuple[np.ndarray, np.ndarray]:
    """A row and a column, shape (N,) each, that make the bordered matrix regular near a place."""
    rows, columns = scales.cycle_scales(problem, near.weights)
    jacobian = problem.jacobian(near.z)

    def vectors(multiplier: complex) -> tuple[np.ndarray, np.ndarray]:
        matrix = variations.cycle_matrix(problem, jacobian, multiplier) / rows[:, None] * columns
        left, right = critical_vectors(problem, matrix)
        return right, left

    if abs(cosine) < 1.0:
        right, left = (major(v) for v in vectors(complex(cosine, np.sqrt(1.0 - cosine**2))))
    else:
        apart = np.sqrt(cosine**2 - 1.0)
        first, second = vectors(cosine + apart), vectors(cosine - apart)
        right, left = (towards(w, v) + v for v, w in zip(first, second, strict=True))
    return right / np.linalg.norm(right), left / np.linalg.norm(left)
