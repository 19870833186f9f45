"""What all special points of orbits share: they are solutions of augmented systems, on ever finer steps.

The orbit is asked first: one with condensed transitions answers through the explicit one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import PAIR, Form
from contwalk.problems.problem import Located, PointType, Sample, Seed


class OrbitPoint(PointType):
    """A kind of special point of orbits.

    Attributes
    ----------
    multiplier : float, optional
        The real multiplier that is critical there.
    """

    multiplier: ClassVar[float | None] = None

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """The augmented system whose solution near a sample is such a point; None if there is none."""
        return None

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """Kind, criticality, coefficients and note of a located point.

        Raises
        ------
        numpy.linalg.LinAlgError
            Where its critical directions are not determined.
        NotFinite
            Where there is no motion beside it.
        """
        return None, None, {}, None

    def form_of_pair(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """As `form`, where the critical multiplier is double, as of a pair mu, 1/mu.

        Coefficients on the critical direction alone do not exist there, and their signs tell no stability.
        """
        return None, None, {}, PAIR

    def branches(self, problem: OrbitData, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a point, on fine steps. z has the shape (N + 1,)."""
        return ()

    def locate(self, problem: OrbitData, sample: Sample, which: int) -> Located | None:
        """The point near a sample, by its augmented system."""
        return problem.locate(self, sample, which)

    def describe(self, problem: OrbitData, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        return problem.special_point(self, located, sample, s)
