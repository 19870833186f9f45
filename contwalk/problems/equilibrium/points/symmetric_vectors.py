"""The critical vectors of a Hopf point at which a symmetry makes several pairs of eigenvalues pass at once.

Any vector of their space is an eigenvector. Cycles are born along those that a symmetry turns by a part of a
round: of three cells in a ring, rotating waves, and standing ones that a reflection takes to themselves half
a period later, or keeps (M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapter XVIII).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.equilibrium.points.lyapunov import SAME, critical_space
from contwalk.problems.orbit.closure import imaged
from contwalk.system import Symmetry
from contwalk.system.declarations import ParameterValues

# How far aside the image of a state is taken for the linear part of a map.
ASIDE = 1e-4


def symmetric_vectors(equilibrium: EquilibriumEquations, point: SpecialPoint) -> list[np.ndarray]:
    """Critical vectors, shape (n,), that declared symmetries turn; none where the pair is alone."""
    n, z = equilibrium.states, np.array(point.unknowns)
    omega = float(point.coefficients["omega"])
    space = critical_space(equilibrium.jacobian(z)[:n, :n], omega).right
    if space.shape[1] < 2:
        return []
    found: list[np.ndarray] = []
    for q in _turned(equilibrium, z, space):
        if all(abs(q.conj() @ known) < 1.0 - SAME for known in found):
            found.append(q)
    return found


def _turned(equilibrium: EquilibriumEquations, z: np.ndarray, space: np.ndarray) -> Iterator[np.ndarray]:
    """Unit vectors of a space, columns of shape (n, k), that a symmetry only turns."""
    x, p = z[: equilibrium.states], ParameterValues(**equilibrium.values_of(z))
    for symmetry in equilibrium.system.symmetries:
        if symmetry.role != "spatial" or not keeps(symmetry, x, p):
            continue
        images = np.column_stack([linear_image(symmetry, x, q, p) for q in space.T])
        turns = space.conj().T @ images
        if np.abs(images - space @ turns).max() > SAME:
            continue
        ratios, shares = np.linalg.eig(turns)
        for ratio, share in zip(ratios, shares.T, strict=True):
            if (
                np.count_nonzero(np.abs(ratios - ratio) < SAME) == 1
            ):  # else the symmetry does not tell them apart
                q = space @ share
                yield q / np.linalg.norm(q)


def keeps(symmetry: Symmetry, x: np.ndarray, p: ParameterValues) -> bool:
    """Whether a state, shape (n,), is its own image."""
    return np.allclose(imaged(symmetry, x, p), x, rtol=1e-9, atol=1e-9 * (1.0 + np.abs(x).max()))


def linear_image(symmetry: Symmetry, x: np.ndarray, q: np.ndarray, p: ParameterValues) -> np.ndarray:
    """Image of a deviation q, complex, from a state that is its own image; both have the shape (n,)."""
    parts = [(imaged(symmetry, x + ASIDE * part, p) - x) / ASIDE for part in (q.real, q.imag)]
    return parts[0] + 1j * parts[1]
