"""The critical vectors of a Hopf point at which a symmetry makes several pairs of eigenvalues pass at once.

Any vector of their space is an eigenvector. Cycles are born along those that a symmetry turns by a part of a
round: of three cells in a ring, rotating waves, and standing ones that a reflection takes to themselves half
a period later, or keeps (M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapter XVIII).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.permutations import Permutation
from contwalk.problems.equilibrium.points.lyapunov import SAME
from contwalk.problems.orbit.closure import imaged
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# How far aside the image of a state is taken for the linear part of a map.
ASIDE = 1e-4


def symmetric_vectors(
    equilibrium: EquilibriumEquations, z: np.ndarray, space: np.ndarray, orders: Sequence[Permutation] = ()
) -> list[np.ndarray]:
    """Vectors of a critical space, columns of shape (n, k), that symmetries turn, at z, shape (N + 1,).

    They are the declared ones, and permutations of the states that nobody declared: of vectors that these
    take to each other one is given.
    """
    x, p = z[: equilibrium.states], ParameterValues(**equilibrium.values_of(z))
    declared = [s for s in equilibrium.system.symmetries if s.role == "spatial" and keeps(s, x, p)]
    images = [np.column_stack([linear_image(s, x, q, p) for q in space.T]) for s in declared]
    found: list[np.ndarray] = []
    for image in [*images, *(space[list(order)] for order in orders)]:
        for q in _turned(space, image):
            known = [v for w in found for v in (w, *(w[list(order)] for order in orders))]
            if all(abs(q.conj() @ v) < 1.0 - SAME for v in known):
                found.append(q)
    return found


def _turned(space: np.ndarray, images: np.ndarray) -> Iterator[np.ndarray]:
    """Unit vectors of a space that a map only turns; columns of shape (n, k), and their images."""
    turns = space.conj().T @ images
    if np.abs(images - space @ turns).max() > SAME:
        return
    ratios, shares = np.linalg.eig(turns)
    for ratio, share in zip(ratios, shares.T, strict=True):
        if np.count_nonzero(np.abs(ratios - ratio) < SAME) == 1:  # else it does not tell them apart
            q = space @ share
            yield q / np.linalg.norm(q)


def keeps(symmetry: Symmetry, x: np.ndarray, p: ParameterValues) -> bool:
    """Whether a state, shape (n,), is its own image."""
    return np.allclose(imaged(symmetry, x, p), x, rtol=1e-9, atol=1e-9 * (1.0 + np.abs(x).max()))


def linear_image(symmetry: Symmetry, x: np.ndarray, q: np.ndarray, p: ParameterValues) -> np.ndarray:
    """Image of a deviation q, complex, from a state that is its own image; both have the shape (n,)."""
    parts = [(imaged(symmetry, x + ASIDE * part, p) - x) / ASIDE for part in (q.real, q.imag)]
    return parts[0] + 1j * parts[1]
