"""The curve on the other side of a change of the order of events: of orbits with the order beyond it.

Where two events happen at once the orbit is one of both orders. It has the condition of the curve as an orbit
of the other order too if the events commute to first order, as a release without a force and an impact do:
then the curve goes on there. If they do not, its multipliers jump, and the curve of the other order, if there
is one, begins elsewhere on the curve of those changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.memory import memory_of, remembered
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.hybrid.adjacent.branch import STEPS, admissible
from contwalk.problems.hybrid.adjacent.orbit import NoAdjacentOrbit
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.reasons_in_words import first_sentence
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.problem import Seed
from contwalk.problems.solving import newton_on
from contwalk.signatures import folded

# A curve goes on at a point if it is no farther from it than this, in the metric: the point is known to 1e-6
# of its parameters and better, and multipliers that jump move the curve by as much as they jump.
ONE_PLACE = 1e-3
# Points whose curves beyond are kept: a curve ends there, in words, and the next one begins.
MOST_KEPT = 4
# What equations without a solution end in.
FAILURES = (ContwalkError, NoAdjacentOrbit, np.linalg.LinAlgError)


def found(locus: Any, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
    """The curves that go on beyond a point of a curve of orbits, and in words what was found, or tried.

    Parameters
    ----------
    locus : OrbitLocus
    point : SpecialPoint
        The change of order on it.
    """
    curve, orbit = locus.curve, locus.orbit
    values = tuple(locus.values_of(np.array(point.unknowns)).items())
    key = curve, locus.plane.free, orbit.itinerary, orbit.discretization, point.unknowns, values
    known = memory_of(locus.system, "curves beyond")
    made: tuple[Sequence[Seed], str] = remembered(known, key, MOST_KEPT, lambda: _beyond(locus, point))
    return made


def _beyond(locus: Any, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
    """As `found`.

    The orbits beyond are those on the line along the curve: along one of both parameters alone the order may
    stay.
    """
    z, tangent = np.array(point.unknowns), np.array(point.tangent)
    there = locus.plane.on_tangent(z, tangent)
    at = replace(
        point,
        unknowns=(*locus.of_orbit(z)[:-1].tolist(), 0.0),
        tangent=(*locus.of_orbit(tangent)[:-1].tolist(), 1.0),
    )
    orbits, told = there.limited.neighbours(at)
    seeds: list[Seed] = []
    reasons: list[str] = []
    for orbit in orbits:
        words = f"[{folded(orbit.problem.itinerary.signature(orbit.problem.system)) or 'no events'}]"
        try:
            seeds.append(_goes_on(locus, point, orbit, words))
        except FAILURES as reason:
            reasons.append(f"signature {words}: {first_sentence(str(reason)).rstrip('.')}")
    if seeds:
        return seeds, "The curve goes on there with orbits of the other order: a curve of its own."
    if not orbits:
        return (), f"No curve goes on beyond it. {told}"
    return (), f"No curve goes on beyond it with orbits of {'; of '.join(reasons)}."


def _goes_on(locus: Any, point: SpecialPoint, orbit: Seed, words: str) -> Seed:
    """The curve of orbits of another order, from the place at which one of these is the curve's own.

    Raises
    ------
    ContwalkError, LinAlgError
        If it does not begin there.
    """
    problem: Any = orbit.problem
    z, made, own = np.array(point.unknowns), problem.finely(orbit.z), orbit.z
    further, typical = locus.further(z), locus.weights[-2:]
    place = np.concatenate([own[:-1], further, z[-2:] + own[-1] * np.array(point.tangent)[-2:]])
    sizes = np.where(further == 0.0, 1.0, np.abs(further))
    weights = np.concatenate([filled_magnitudes(made, own)[:-1], sizes, typical])
    curve = locus.on(made, place, weights)
    tangent = kernel_direction(curve.linearize(place).jacobian, weights)
    solved = newton_on(curve, place, weights, tangent / weights**2)
    off = float(np.linalg.norm((solved - place) / weights))
    if off > ONE_PLACE:
        raise NoAdjacentOrbit(
            f"their multipliers are others, and the nearest one that has the condition of {locus.curve.of} "
            f"is {off:.2g} away, as parts of the magnitudes there; begin its curve at a point of their own "
            "branch"
        )
    tangent = kernel_direction(curve.linearize(solved).jacobian, weights)

    def simulated(there: np.ndarray) -> tuple[LimitedOrbit, np.ndarray]:
        first, unknowns = curve.plane.first(there)
        return first.explicit(unknowns) if isinstance(first, SoftEquations) else (first, unknowns)

    way, _ = admissible(curve, solved, tangent, weights, words, STEPS, simulated)
    return Seed(locus.curve.of, solved, way * tangent, None, curve, one_sided=True)
