"""The cycle that is born at a Hopf point of a machine with events: an orbit that meets none yet.

Its equations are those of the machine's other orbits. So its branch is told where it comes to an event, and
goes on through soft transitions.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_orbit import SoftOrbit, applies
from contwalk.problems.hybrid.word import Leg, Word
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.orbit.section import Section
from contwalk.problems.problem import Seed


def eventful(born: Seed) -> Seed:
    """The seed of a smooth cycle as one of the machine's orbits, of the whole cycle.

    It is left as it is where an orbit with legs cannot be one: a leg is not cut into segments, and a drift
    along a pinned direction is none of a point.
    """
    smooth = born.problem
    assert isinstance(smooth, PeriodicOrbit)
    assert smooth.section is not None
    if smooth.segments > 1 or smooth.pins:
        return born
    system, x = smooth.system, born.z[: smooth.states]
    word = Word((Leg(system.modes[0].name),))
    kind = SoftOrbit if applies(system, word) else HybridOrbit
    problem = kind(
        system,
        word,
        smooth.parameters,
        smooth.free,
        smooth.line.ends,
        reference=x,
        discretization=smooth.discretization,
    )
    place, own = problem.layout.states[0], list(problem.passages[0].states)
    section = Section(smooth.section.point[own], smooth.section.normal[own])
    z = problem.assembled([x], [smooth.whole[1] * smooth.duration(born.z)], np.zeros(0), float(born.z[-1]))
    there = problem.adapted_to(z, problem.weighted(smooth.mesh.magnitudes), section=section)

    def on_leg(of_smooth: np.ndarray) -> np.ndarray:
        result = np.zeros(len(z))
        result[place], result[-1] = of_smooth[own], of_smooth[-1]
        return result

    return replace(
        born,
        z=z,
        tangent=on_leg(born.tangent),
        reach=lambda change: on_leg(born.reach(change)),
        problem=there,
    )
