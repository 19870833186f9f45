"""The condition of curves along which a multiplier is minus one."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.points.period_doubling import flip_system


class Flips(OrbitCurve):
    """A multiplier minus one: an orbit is doubled, or half a symmetric one loses the symmetry."""

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Augmented:
        """L(-1) is singular.

        `further` has the shape (k,).
        """
        return flip_system(orbit, near)

    def critical(self, further: np.ndarray) -> np.ndarray:
        """Minus one.

        `further` has the shape (k,).
        """
        return np.array([complex(-1.0)])
