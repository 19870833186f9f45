"""The cycle that is born at a Hopf point of a machine with events: an orbit that meets none yet.

Its equations are those of the machine's other orbits. So its branch is told where it comes to an event, and
goes on through soft transitions.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.orbit.section import Section
from contwalk.problems.problem import Seed


def eventful(born: Seed) -> Seed:
    """The seed of a smooth cycle as one of the machine's orbits, of the whole cycle.

    It is left as it is where an orbit with legs cannot be one: those with soft transitions, or of which only
    a part was integrated, are not cut into segments, and a drift along a pinned direction is none of a point.
    """
    smooth = born.problem
    assert isinstance(smooth, PeriodicOrbit)
    assert smooth.section is not None
    m, n = smooth.mesh.segments, smooth.states
    system, x = smooth.system, born.z[:n]
    itinerary = Itinerary((Leg(system.modes[0].name),))
    if smooth.pins or (m > 1 and (smooth.whole[1] > 1 or applies(system, itinerary))):
        return born
    kind = SoftOrbit if applies(system, itinerary) else HybridOrbit
    problem = kind(
        system,
        itinerary,
        smooth.parameters,
        smooth.free,
        smooth.line.ends,
        reference=x,
        discretization=smooth.discretization,
    )
    problem = problem.cut_into(m)
    places, own = [each.states for each in problem.layout.segments], list(problem.passages[0].states)
    section = Section(smooth.section.point[own], smooth.section.normal[own])
    z = problem.assembled([x], [smooth.whole[1] * smooth.duration(born.z)], np.zeros(0), float(born.z[-1]))
    for place in places:
        z[place] = x[own]
    there = problem.adapted_to(z, problem.weighted(smooth.mesh.magnitudes), section=section)

    def on_leg(of_smooth: np.ndarray) -> np.ndarray:
        result = np.zeros(len(z))
        for place, states in zip(places, of_smooth[: m * n].reshape(m, n), strict=True):
            result[place] = states[own]
        result[-1] = of_smooth[-1]
        return result

    return replace(
        born,
        z=z,
        tangent=on_leg(born.tangent),
        reach=lambda change: on_leg(born.reach(change)),
        problem=there,
    )
