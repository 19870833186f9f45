"""Where a branch of orbits through events ends, or cannot go on."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.hybrid import obstacles, undefined
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.vanishing import in_no_time, onto_an_event
from contwalk.problems.orbit.conservation import not_conserved
from contwalk.problems.orbit.diagnosis import OrbitDiagnosis
from contwalk.problems.orbit.homoclinic import homoclinic
from contwalk.problems.orbit.unbounded import unbounded
from contwalk.problems.orbit.vanishing import at_a_point
from contwalk.problems.problem import Sample


class HybridDiagnosis(OrbitDiagnosis):
    """What is known of such places."""

    def __init__(self, orbit: DiscretizedOrbit) -> None:
        super().__init__(orbit)
        self._eventful = orbit

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring solutions; limits are the engine's business."""
        orbit = self._eventful
        shrinks = (in_no_time, onto_an_event) if orbit.word.eventful else (at_a_point,)
        reasons = (not_conserved, *shrinks, homoclinic, unbounded)
        return next((outcome for reason in reasons if (outcome := reason(orbit, a, b)) is not None), None)

    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z has no value, as a sentence; empty if none is found."""
        return undefined.where(self._eventful, z)

    def obstacle(self, z: np.ndarray) -> str:
        """Where the field is smooth by pieces only, or over which leg deviations grow."""
        return obstacles.obstacle(self._eventful, z)
