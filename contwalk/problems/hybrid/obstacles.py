"""What keeps Newton's method from solutions of an orbit's equations, and legs without length."""

from __future__ import annotations

import numpy as np

from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit.kinks_met import kinks_along

# Growth of deviations over a leg that is told where a branch cannot go on.
STRETCHED = 1e3
# A leg this short, against the closure, is none.
COLLAPSED = 1e-13
# An orbit that moves less than this part of its states is a point.
STILL = 1e-9


def obstacle(orbit: LimitedOrbit, z: np.ndarray) -> str:
    """Where the field is smooth by pieces only, or over which leg deviations grow.

    z has the shape (N + 1,).
    """
    kink = next(iter(kinks_along(orbit, z)), None)
    if kink is not None:
        return kink.sentence("orbits")
    grown = orbit.mesh.grown
    if not grown or max(grown) < STRETCHED:
        return ""
    most = int(np.argmax(grown))
    leg = orbit.itinerary.legs[orbit.layout.segments[most].leg]
    ends = f"ends with '{leg.name}'" if leg.name else "no event ends"
    where = "" if orbit.cuts == 1 else f"one of {orbit.cuts} segments of "
    told = (
        f"Deviations grow by {grown[most]:.0e} over {where}the segment in mode '{leg.mode}' that {ends}: "
        "where it passes beside a saddle, or along what repels it (a canard, or a homoclinic orbit "
        "nearby), the parameter stands still while the orbit changes, and beyond some of this growth no "
        "start of the segment tells its end."
    )
    if not orbit.cuttable:
        return f"{told} A smaller `tolerance` (`engine`) goes a little further."
    return f"{told} Begin the branch with more segments (`engine: {{segments: {2 * orbit.cuts}}}`)."


def collapsed(orbit: LimitedOrbit, z: np.ndarray) -> str:
    """Name of an event that follows its predecessor at once, to rounding; empty if there is none.

    A guard that is zero after its own reset has a second, spurious zero there: a leg without length.
    """
    moved = max(float(np.max(np.ptp(view.nodes, axis=0))) for view in orbit.view(z))
    largest = max(float(np.max(np.abs(view.nodes))) for view in orbit.view(z))
    if orbit.itinerary.eventful and moved <= STILL * largest and not _clocked(orbit):
        return orbit.itinerary.legs[0].name
    lasting = [i for i, leg in enumerate(orbit.itinerary.legs) if not leg.collapsed]
    shortest = min(lasting, key=lambda i: float(z[orbit.layout.durations][i]))
    lasts = float(z[orbit.layout.durations][shortest])
    if not orbit.itinerary.eventful or lasts > COLLAPSED * orbit.duration(z):
        return ""
    return orbit.itinerary.legs[shortest].name


def _clocked(orbit: LimitedOrbit) -> bool:
    """Whether an event happens at given times: at rest, too."""
    each = zip(orbit.itinerary.legs, orbit.passages, strict=True)
    return any(leg.transition is not None and own.of_time_alone(leg.transition) for leg, own in each)
