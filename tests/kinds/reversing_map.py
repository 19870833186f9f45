"""Orbits at which a real multiplier passes zero (ZM): beyond, the return map turns one direction round.

Of a smooth flow none ever does, since the product of all is exp of an integral (Liouville): resets do it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit.augmented import Augmented, where_zero
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import Form
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Located, Sample, Test


@dataclass(frozen=True)
class ReversingMap(OrbitPoint):
    """The return map begins to turn one direction round.

    Parameters
    ----------
    forgotten : int
        How many multipliers are zero, or nothing but rounding, all along: of states that a reset sets.
    """

    label, test = "ZM", Test.VALUE
    forgotten: int = 0

    def value(self, problem: OrbitData, sample: Sample) -> float:
        """The product of the multipliers that are not forgotten."""
        return self._product(sample.eigenvalues)

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """F = 0 and a product of zero."""

        def value(there: OrbitData, z: np.ndarray) -> float:
            return self._product(there.multipliers(z, there.linearize(z).jacobian).values)

        return where_zero(problem, sample, value)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """The largest modulus of the others."""
        return None, None, {"largest": float(np.max(np.abs(sample.eigenvalues)))}, None

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """The multiplier that is zero."""
        return 0j

    def _product(self, multipliers: np.ndarray) -> float:
        order = np.argsort(np.abs(multipliers))
        return float(np.prod(multipliers[order[self.forgotten :]]).real)
