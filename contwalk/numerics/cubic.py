"""Cubics with given values and rates at both ends of 0..1 (Hermite interpolation)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

# An extremum is looked at when it comes this much nearer to zero than the ends.
NEAR_ZERO = 0.5


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


def dip(values: Sequence[float], rates: Sequence[float], corner: bool = False) -> float | None:
    """Where what falls from one positive value and grows to another is least, if near to zero, in 0..1.

    The cubic of values and rates at both ends tells where; where there may be a `corner`, the tangents at
    both ends tell how near.
    """
    given = np.array([[*values, *rates]])
    places = turns(given)[0]
    least = (given @ weights(places))[0]
    meet = (values[1] - values[0] - rates[1]) / (rates[0] - rates[1])
    nearest = min(least.min(), values[0] + rates[0] * meet if corner else np.inf)
    return float(places[np.argmin(least)]) if nearest < NEAR_ZERO * min(values) else None
