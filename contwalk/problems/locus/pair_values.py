"""The condition of tori near half a turn: the product and the sum of two multipliers.

Where the map round an orbit is minus the identity on a plane, as where half a symmetric orbit has the
multipliers i and -i, the equations with one critical vector are singular. Product and sum of both multipliers
are smooth there, and where the two meet with one vector as well; their derivatives are differences.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.valued import Valued

# Cosines of the angle this near to minus one are held so.
NEAR = 0.05


def pair_values(near: At, cosine: float) -> Valued:
    """A pair of multipliers mu, 1/mu with (mu + 1/mu) / 2 = k, a further unknown, near a value of it."""
    size = len(near.z) - 1
    root = np.sqrt(complex(cosine * cosine - 1.0))
    wanted = np.array([cosine + root, cosine - root])

    def values(plane: Any, place: np.ndarray) -> np.ndarray:
        there, own = plane.first(place)
        known = there.multipliers(own, there.jacobian(own)).values
        first = int(np.argmin(np.abs(known - wanted[0])))
        rest = np.where(np.arange(len(known)) == first, np.inf, np.abs(known - wanted[1]))
        both = known[[first, int(np.argmin(rest))]]
        return np.array([float(np.prod(both).real) - 1.0, 0.5 * float(np.sum(both).real)])

    start, scale = np.append(near.z, cosine), np.append(near.weights, 1.0)
    by_own = np.array([[0.0], [-1.0]])
    return Valued(values, near.in_plane, start, scale, np.zeros((size, 1)), by_own=by_own)
