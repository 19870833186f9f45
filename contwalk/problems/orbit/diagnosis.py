"""Where a branch of orbits ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.capabilities import Diagnosis
from contwalk.problems.kink import Met
from contwalk.problems.orbit import branching, growth_told, undefined
from contwalk.problems.orbit.conservation import not_conserved
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.homoclinic import homoclinic
from contwalk.problems.orbit.kinks_met import kinks_along, passed_by_parameters
from contwalk.problems.orbit.termination import held, unborn
from contwalk.problems.orbit.unbounded import unbounded
from contwalk.problems.orbit.vanishing import at_a_point
from contwalk.problems.problem import Sample

# Why a branch ends between two neighbouring orbits, if it does for this reason.
Reason = Callable[[Any, Sample, Sample], Outcome | None]


class OrbitDiagnosis(Diagnosis):
    """What is known of such places."""

    # Each says when it applies; how a family shrinks to nothing depends on what it meets on the way.
    shrinking: ClassVar[tuple[Reason, ...]] = (at_a_point,)
    # What else ends a family, where no law tells its limit.
    lost: ClassVar[tuple[Reason, ...]] = ()

    def __init__(self, orbit: DiscretizedOrbit) -> None:
        self._orbit = orbit

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring orbits, if it does; limits are not asked here."""
        reasons = (unborn, held, not_conserved, *self.shrinking, homoclinic, unbounded, *self.lost)
        found = (reason(self._orbit, a, b) for reason in reasons)
        return next((outcome for outcome in found if outcome is not None), None)

    def growth(self, z: np.ndarray) -> str:
        """By how much deviations grow over a segment of a closure where that is too much, and what helps.

        Of legs nothing is told but where they cannot go on. z has the shape (N + 1,).
        """
        return growth_told.over_closure(self._orbit, z) if self._orbit.in_closure else ""

    def obstacle(self, z: np.ndarray) -> str:
        """What makes orbits beside z hard to find, and what helps: a field that is smooth by pieces only, or
        how much deviations grow over a segment, or a leg; empty if nothing is known of that.

        z has the shape (N + 1,).
        """
        met = kinks_along(self._orbit, z)
        if met:
            return met[0].sentence("orbits")
        if self._orbit.in_closure:
            return self.growth(z)
        return growth_told.over_legs(self._orbit.explicit(z)[0])  # whose legs its steps are made for

    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z has no value, as a sentence; empty if none is found.

        z has the shape (N + 1,).
        """
        return undefined.where(self._orbit, z)

    def explain(self, z: np.ndarray) -> str:
        """Where a residual at z is not finite. z has the shape (N + 1,)."""
        known = self.without_value(z).removesuffix(".")
        return known or "the motion from there ends or grows without bound within one period"

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What changes with the free parameter alone from an orbit to another solution, shape (N + 1,)."""
        return passed_by_parameters(self._orbit, a, b)

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding. z has the shape (N + 1,)."""
        return branching.second_direction(self._orbit, z) is not None
