"""Legs without length."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid.limited_orbit import LimitedOrbit

# A leg this short, against the closure, is none.
COLLAPSED = 1e-13
# An orbit that moves less than this part of its states is a point.
STILL = 1e-9


def collapsed(orbit: LimitedOrbit, z: np.ndarray) -> str:
    """Name of an event that follows its predecessor at once, to rounding; empty if there is none.

    A guard that is zero after its own reset has a second, spurious zero there: a leg without length.
    """
    moved = max(float(np.max(np.ptp(view.nodes, axis=0))) for view in orbit.view(z))
    largest = max(float(np.max(np.abs(view.nodes))) for view in orbit.view(z))
    if orbit.itinerary.eventful and moved <= STILL * largest and not _clocked(orbit):
        return orbit.itinerary.legs[0].name
    lasting = [i for i, leg in enumerate(orbit.itinerary.legs) if not leg.momentary]
    shortest = min(lasting, key=lambda i: float(z[orbit.layout.durations][i]))
    lasts = float(z[orbit.layout.durations][shortest])
    if not orbit.itinerary.eventful or lasts > COLLAPSED * orbit.duration(z):
        return ""
    return orbit.itinerary.legs[shortest].name


def _clocked(orbit: LimitedOrbit) -> bool:
    """Whether an event happens at given times: at rest, too."""
    each = zip(orbit.itinerary.legs, orbit.passages, strict=True)
    return any(leg.transition is not None and own.of_time_alone(leg.transition) for leg, own in each)
