"""Normal forms of the special points of equilibria, from exact second and third derivatives.

Notation (docs/theory.md): q right and p left critical vector with |q| = 1 and p.q = 1; B and C the second
and third derivatives of the vector field by the states.
"""

from __future__ import annotations

import numpy as np

from contwalk.numerics.linear import critical_pair
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations

# How many roundings away a solution is looked at to tell how well a coefficient is known.
ROUNDINGS = 4.0
# A coefficient has a sign if it is this many times its estimated error.
SURE = 10.0


class Forms:
    """B and C at one point, for vectors of unknowns or of unknowns and parameter.

    z has the shape (N + 1,), a vector that one, (N,) or (n,); B and C have the shape (N,).
    """

    def __init__(self, problem: EquilibriumEquations, z: np.ndarray) -> None:
        self._inputs = problem.inputs(z)
        self._kernels = problem.kernels
        self._length = problem.size + 1

    def _padded(self, v: np.ndarray) -> np.ndarray:
        return np.concatenate([v, np.zeros(self._length - len(v))])

    def second(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """B(v, w), shape (N,)."""
        return self._kernels.second(*self._inputs, self._padded(v), self._padded(w))

    def third(self, v: np.ndarray, w: np.ndarray, y: np.ndarray) -> np.ndarray:
        """C(v, w, y), shape (N,)."""
        return self._kernels.third(*self._inputs, self._padded(v), self._padded(w), self._padded(y))


def critical_vectors(problem: EquilibriumEquations, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q and p of F_u where it is singular, |q| = 1, p.q = 1, or as of a double zero where p.q vanishes.

    Both have the shape (N,), z (N + 1,). The sign of q makes its largest entry positive.
    """
    pair = critical_pair(problem.jacobian(z)[:, : problem.size], problem.errors_of_matrix(z))
    q, p = pair.right.real, pair.left.real
    sign = np.sign(q[np.argmax(np.abs(q))])
    return sign * q, sign * p


def rounded(z: np.ndarray, weights: np.ndarray) -> list[np.ndarray]:
    """Two neighbours of a solution, some roundings away from it in every state, the parameter as it is.

    The solution and its weights have the shape (N + 1,).
    """
    apart = ROUNDINGS * np.finfo(float).eps * np.maximum(np.abs(z), weights)
    apart[-1] = 0.0
    signs = np.cos(np.arange(1.0, len(z) + 1.0))  # no symmetry of a machine has these
    return [z + apart * signs, z - apart * signs]
