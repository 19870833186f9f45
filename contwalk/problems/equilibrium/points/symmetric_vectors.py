"""The critical vectors of a Hopf point at which a symmetry makes several pairs of eigenvalues pass at once.

Any vector of their space is an eigenvector. Cycles are born along those that a symmetry turns by a part of a
round: of three cells in a ring, rotating waves, and standing ones that a reflection takes to themselves half
a period later, or keeps (M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapter XVIII).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from contwalk.numerics.permutations import Permutation
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.images import imaged
from contwalk.problems.kept_spaces import SAME, keeps, linear_image, turned
from contwalk.system.declarations import ParameterValues


def symmetric_vectors(
    equilibrium: EquilibriumEquations, z: np.ndarray, space: np.ndarray, orders: Sequence[Permutation] = ()
) -> list[np.ndarray]:
    """Vectors of a critical space, columns of shape (n, k), that symmetries turn, at z, shape (N + 1,).

    They are the declared ones, and permutations of the states that nobody declared: of vectors that these
    take to each other one is given.
    """
    x, p = z[: equilibrium.states], ParameterValues(**equilibrium.values_of(z))
    spatial = [partial(imaged, s, parameters=p) for s in equilibrium.system.symmetries if s.role == "spatial"]
    maps = [image for image in spatial if keeps(image, x)]
    images = [linear_image(m, x, space.real) + 1j * linear_image(m, x, space.imag) for m in maps]
    found: list[np.ndarray] = []
    for image in [*images, *(space[list(order)] for order in orders)]:
        for _, share in turned(space, image)[1]:
            q = space @ share / np.linalg.norm(space @ share)
            known = [v for w in found for v in (w, *(w[list(order)] for order in orders))]
            if all(abs(q.conj() @ v) < 1.0 - SAME for v in known):
                found.append(q)
    return found
