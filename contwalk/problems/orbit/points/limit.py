"""What all limits of orbits share: a margin passes zero, and beyond it the orbit is not the machine's."""

from __future__ import annotations

from collections.abc import Sequence

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import LimitType, Seed, Test


class OrbitLimit(OrbitPoint, LimitType):
    """A kind of limit: its equations are those of the margin that passes zero (`hybrid.limits`)."""

    test = Test.MARGIN

    def seeds(self, problem: OrbitData, point: SpecialPoint) -> Sequence[Seed]:
        """The branches of orbits that the machine goes over to beyond it."""
        return () if self.declared or problem.limited is None else problem.limited.neighbours(point)[0]
