"""Where fields are smooth by pieces only along the motion of an orbit."""

from __future__ import annotations

import numpy as np

from contwalk.problems import kinks
from contwalk.problems.kinks import Kink
from contwalk.problems.orbit.orbit_data import OrbitData


def kinks_along(orbit: OrbitData, z: np.ndarray) -> tuple[Kink, ...]:
    """Those that the motion of z crosses, each once, and jumps that its events lie on."""
    at_events = orbit.kinks_at_events(z)
    found = (kinks.along(course) for course in orbit.courses(z))
    return tuple(dict.fromkeys(kink for part in (*found, at_events) for kink in part))
