"""Where a branch of orbits through events ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.problems.hybrid import corners, end_maps, jumping_limits
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.unresolved import unresolved
from contwalk.problems.hybrid.vanishing import in_no_time, onto_an_event
from contwalk.problems.kink import Met
from contwalk.problems.orbit.diagnosis import OrbitDiagnosis


class HybridDiagnosis(OrbitDiagnosis):
    """What is known of such places."""

    shrinking = (*OrbitDiagnosis.shrinking, in_no_time, onto_an_event)
    lost = (unresolved,)

    def __init__(self, orbit: LimitedOrbit) -> None:
        super().__init__(orbit)
        self._eventful = orbit

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What changes with the free parameter alone on the way from an orbit to another one; jumps of guards
        and resets, and of their slopes, that events pass on it; of other guards and of what is only told,
        jumps through zero. Both have the shape (N + 1,).
        """
        orbit = self._eventful
        jumps = *end_maps.passed(orbit, a, b), *jumping_limits.passed(orbit, a, b)
        return *super().passed(a, b), *jumps, *corners.passed(orbit, a, b)
