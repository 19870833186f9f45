"""Where a branch of orbits ends, or cannot go on: what is told alike of all of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.kink import Kink, Met
from contwalk.problems.orbit import branching
from contwalk.problems.orbit.kinks_met import passed_by_parameters
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Sample


class OrbitDiagnosis(ABC):
    """What is known of such places."""

    def __init__(self, orbit: OrbitData) -> None:
        self._orbit = orbit

    @abstractmethod
    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring orbits, if it does."""

    def growth(self, z: np.ndarray) -> str:
        """Nothing is told of orbits with events but where they cannot go on. z has the shape (N + 1,)."""
        return ""

    @abstractmethod
    def obstacle(self, z: np.ndarray) -> str:
        """What makes orbits beside z hard to find, and what helps; empty if nothing is known of that.

        z has the shape (N + 1,).
        """

    @abstractmethod
    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z has no value, as a sentence; empty if none is found.

        z has the shape (N + 1,).
        """

    def explain(self, z: np.ndarray) -> str:
        """Where a residual at z is not finite. z has the shape (N + 1,)."""
        known = self.without_value(z).removesuffix(".")
        return known or "the motion from there ends or grows without bound within one period"

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What changes with the free parameter alone from an orbit to another solution, shape (N + 1,)."""
        return passed_by_parameters(self._orbit, a, b)

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Those that the second orbit crosses, and those that are passed on the step to it."""
        return b.kinks

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding. z has the shape (N + 1,)."""
        return branching.second_direction(self._orbit, z) is not None
