"""Where a branch of orbits through events ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.hybrid import corners, end_maps, jumping_limits, obstacles, undefined
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.vanishing import in_no_time, onto_an_event
from contwalk.problems.kink import Met
from contwalk.problems.orbit.conservation import not_conserved
from contwalk.problems.orbit.diagnosis import OrbitDiagnosis
from contwalk.problems.orbit.homoclinic import homoclinic
from contwalk.problems.orbit.unbounded import unbounded
from contwalk.problems.orbit.vanishing import at_a_point
from contwalk.problems.problem import Sample


class HybridDiagnosis(OrbitDiagnosis):
    """What is known of such places."""

    def __init__(self, orbit: LimitedOrbit) -> None:
        super().__init__(orbit)
        self._eventful = orbit

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring solutions; limits are the engine's business."""
        orbit = self._eventful
        shrinks = (in_no_time, onto_an_event) if orbit.itinerary.eventful else (at_a_point,)
        reasons = (not_conserved, *shrinks, homoclinic, unbounded)
        return next((outcome for reason in reasons if (outcome := reason(orbit, a, b)) is not None), None)

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What changes with the free parameter alone on the way from an orbit to another one; jumps of guards
        and resets, and of their slopes, that events pass on it; of other guards and of what is only told,
        jumps through zero. Both have the shape (N + 1,).
        """
        orbit = self._eventful
        jumps = *end_maps.passed(orbit, a, b), *jumping_limits.passed(orbit, a, b)
        return *super().passed(a, b), *jumps, *corners.passed(orbit, a, b)

    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z has no value, as a sentence; empty if none is found.

        z has the shape (N + 1,).
        """
        return undefined.where(self._eventful, z)

    def obstacle(self, z: np.ndarray) -> str:
        """Where the field is smooth by pieces only, or over which leg deviations grow.

        z has the shape (N + 1,).
        """
        return obstacles.obstacle(self._eventful, z)
