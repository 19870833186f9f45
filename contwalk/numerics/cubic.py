"""Cubics with given values and rates at both ends of 0..1 (Hermite interpolation)."""

from __future__ import annotations

import numpy as np


def weights(t: np.ndarray) -> np.ndarray:
    """What both values, then both rates, count for at places of any shape, shape (4, ...)."""
    r = 1.0 - t
    return np.stack([r * r * (1.0 + 2.0 * t), t * t * (3.0 - 2.0 * t), t * r * r, -t * t * r])


def turns(given: np.ndarray) -> np.ndarray:
    """Where cubics turn between the ends, shape (k, 2); 0 in the place of one that does not.

    `given` has both values, then both rates, of each, shape (k, 4).
    """
    fa, fb, da, db = given.T
    a, b, c = 3.0 * (da + db - 2.0 * (fb - fa)), 2.0 * (3.0 * (fb - fa) - 2.0 * da - db), da
    with np.errstate(all="ignore"):
        root = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        found = np.stack([root / a, c / root], axis=1)
    return np.where((found > 0.0) & (found < 1.0), found, 0.0)
