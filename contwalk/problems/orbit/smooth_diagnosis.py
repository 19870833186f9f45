"""Where a branch of orbits without events ends, or cannot go on."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.orbit import termination, undefined
from contwalk.problems.orbit.diagnosis import OrbitDiagnosis
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.kinks_met import kinks_along
from contwalk.problems.orbit.stretching import stretched
from contwalk.problems.problem import Sample


class SmoothDiagnosis(OrbitDiagnosis):
    """What is known of such places."""

    def __init__(self, orbit: DiscretizedOrbit) -> None:
        super().__init__(orbit)
        self._smooth = orbit

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring orbits, if it does."""
        return termination.ended(self._smooth, a, b)

    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z has no value, as a sentence; empty if none is found.

        z has the shape (N + 1,).
        """
        return undefined.where(self._smooth, z)

    def obstacle(self, z: np.ndarray) -> str:
        """How much deviations grow over a segment, where that is what Newton's method has to fight with.

        z has the shape (N + 1,).
        """
        orbit = self._smooth
        met = kinks_along(orbit, z)
        return met[0].sentence("orbits") if met else self.growth(z)

    def growth(self, z: np.ndarray) -> str:
        """By how much deviations grow over a segment where that is too much, and what helps.

        z has the shape (N + 1,).
        """
        orbit = self._smooth
        if not stretched(orbit, z):
            return ""
        m = orbit.mesh.segments
        where = f"over one of {m} segments of the orbit" if m > 1 else "over the orbit"
        grown = f"Deviations grow by {orbit.mesh.growth:.0e} {where}, and steps become short by that."
        scheme, more = orbit.discretization.scheme, f"more segments (`engine: {{segments: {2 * m}}}`)"
        if orbit.discretization.segments is not None:
            return f"{grown} Begin the branch with {more}."
        if scheme == "collocation":
            return f"{grown} More segments than these are not made."
        other = "auto" if scheme == "shooting" else "collocation"
        remedy = f"`engine: {{discretization: {other}}}`, which cuts orbits where deviations grow"
        return f"{grown} Begin the branch with {remedy}{f', or with {more}' if scheme == 'shooting' else ''}."
