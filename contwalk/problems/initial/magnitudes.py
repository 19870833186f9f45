"""What the states of an orbit move by, those at rest included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems.orbit.shooting import CONSTANT
from contwalk.system import State
from contwalk.system.variables import declared_scales

# A state below this part of the largest one is rounding of it, and so is one below `LEAST`.
ROUNDING, LEAST = 1e-9, 1e-250


def magnitudes_on(declared: Sequence[State], states: np.ndarray, tolerance: float) -> np.ndarray:
    """Half the range of each state on an orbit; of one at rest its declared scale, its size, or 1 if it is 0.

    Parameters
    ----------
    declared : sequence of State, length n
    states : ndarray, shape (k, n)
        On the orbit.
    tolerance : float
        Of the integration that they are from.

    Returns
    -------
    ndarray, shape (n,)
    """
    ranges, sizes = 0.5 * np.ptp(states, axis=0), np.maximum(np.abs(states).max(axis=0), 1e-300)
    scales = declared_scales(declared)
    shares = ranges / np.maximum(sizes, ROUNDING * sizes.max())
    still = (shares <= CONSTANT * shares.max()) | (shares <= 10.0 * tolerance)
    own = np.where(sizes > max(ROUNDING * sizes.max(), LEAST), sizes, 1.0)
    return np.where(still, np.where(np.isfinite(scales), scales, own), ranges)
