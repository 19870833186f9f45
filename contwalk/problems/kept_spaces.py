"""Which vectors of a critical space an image only turns.

Where a symmetry makes several eigenvalues critical together, any vector of their space is an eigenvector. One
that an image turns by a factor of its own is what deviations of solutions with less symmetry begin as
(equivariant branching lemma; M. Golubitsky, I. Stewart & D. G. Schaeffer, 1988, chapters XIII and XVIII).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# Vectors of a space are alike, and left vectors see nothing of it, below this part of their sizes.
SAME = 1e-6
# How far aside the image of a state is taken for the linear part of a map.
ASIDE = 1e-4

Map = Callable[[np.ndarray], np.ndarray]


def turned(
    space: np.ndarray, images: np.ndarray, along: np.ndarray | None = None
) -> tuple[np.ndarray, list[tuple[complex, np.ndarray]]]:
    """What a map does to a space, shape (k, k), and the vectors in it that it only turns, with their factors.

    None where the space is not kept, but for what lies `along` a vector, shape (n,). Columns of the space and
    their images have the shape (n, k), vectors in it (k,).
    """
    k = space.shape[1]
    whole = space if along is None else np.column_stack([space, along])
    found = np.linalg.lstsq(whole, images, rcond=None)[0]
    if np.abs(images - whole @ found).max() > SAME * np.abs(space).max():
        return found[:k], []
    ratios, shares = np.linalg.eig(found[:k])
    each = zip(ratios, shares.T, strict=True)
    return found[:k], [(r, v) for r, v in each if np.count_nonzero(np.abs(ratios - r) < SAME) == 1]


def keeps(image: Map, x: np.ndarray) -> bool:
    """Whether a state, shape (n,), is its own image."""
    return np.allclose(image(x), x, rtol=1e-9, atol=1e-9 * (1.0 + np.abs(x).max()))


def linear_image(image: Map, x: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Images of deviations q from a state that is its own image; these have the shape (n, k), it has (n,)."""
    return np.column_stack([(image(x + ASIDE * each) - x) / ASIDE for each in q.T])
