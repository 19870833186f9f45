"""What is told of deviations that grow too much over a segment, or a leg, of an orbit, and what helps."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.itinerary import Leg
from contwalk.problems.orbit.stretching import stretched

# Growth of deviations over a segment of a leg that is told where a branch cannot go on, and over all of them:
# roundings grown by that are a ten-thousandth of the orbit.
OVER_LEGS, OVER_ALL = 1e3, 1e12


def over_closure(orbit: DiscretizedOrbit, z: np.ndarray) -> str:
    """By how much deviations grow over a segment where that is too much, and what helps.

    z has the shape (N + 1,).
    """
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
    return f"{grown} Begin the branch with {remedy}{'' if orbit.uneven else f', or with {more}'}."


def over_legs(orbit: DiscretizedOrbit) -> str:
    """Over which leg deviations grow, by how much, and what helps; empty if they do not grow much."""
    grown = orbit.mesh.grown
    if not grown:
        return ""
    most = int(np.argmax(grown))
    if grown[most] < OVER_LEGS:
        return _over_all(orbit)
    leg = orbit.itinerary.legs[orbit.layout.segments[most].leg]
    ends = _ended(leg)
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


def _over_all(orbit: DiscretizedOrbit) -> str:
    """As `over_legs`, where no segment is too long, and all of a leg's together are."""
    whole = np.ones(orbit.layout.legs)
    with np.errstate(over="ignore"):
        for segment, growth in zip(orbit.layout.segments, orbit.mesh.grown, strict=True):
            whole[segment.leg] *= max(growth, 1.0)
    most = int(np.argmax(whole))
    if whole[most] < OVER_ALL:
        return ""
    leg = orbit.itinerary.legs[most]
    return (
        f"Deviations grow by up to {whole[most]:.0e} over the segment in mode '{leg.mode}' that "
        f"{_ended(leg)}: along what repels it (a canard, or a homoclinic orbit nearby) the parameter stands "
        "still while the orbit changes, and double precision does not tell such orbits from each other. "
        "Begin another branch beyond, from a simulation."
    )


def _ended(leg: Leg) -> str:
    """How a leg ends, in words."""
    return f"ends with '{leg.name}'" if leg.name else "no event ends"
