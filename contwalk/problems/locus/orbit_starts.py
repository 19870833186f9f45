"""Curves in two parameters from located special points of orbits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.hybrid.closed_up import broken_at
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curves import CURVES, LIMITS, VALUED, begun_at
from contwalk.problems.locus.orbit_locus import OrbitLocus
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.locus.orbit_restored import plane_of
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.restoring import Facts

FOLLOWED = (*CURVES, *LIMITS, *VALUED)


def locus_at(
    facts: Facts, point: SpecialPoint, weights: np.ndarray, typical: Mapping[str, float]
) -> tuple[OrbitLocus, np.ndarray]:
    """The curve through a located special point of orbits, and that point's z, shape (N + k + 2,).

    Parameters
    ----------
    facts : Facts
        What is stored of its branch; the parameters are those of the point.
    point : SpecialPoint
        A point of one of the kinds of `FOLLOWED`.
    weights : ndarray, shape (N + 1,)
        Typical magnitudes of its unknowns.
    typical : mapping
        Typical magnitudes of the two parameters, by name.

    Raises
    ------
    StartError
        If no curve begins there.
    """
    if point.label not in FOLLOWED or point.status != "located":
        raise StartError(
            f"No curve in two parameters can be followed from {point.name or point.label}.",
            f"Start at a located special point of orbits: {', '.join(FOLLOWED)}.",
        )
    first_name, second_name = typical
    free = first_name, second_name
    plane = plane_of(facts, facts.info.problem, free)
    own = np.array(point.unknowns)[:-1]
    first, second = (facts.parameters[name] for name in free)
    near, scale = np.append(own, first), np.append(weights[:-1], typical[free[0]])
    there = plane.on_lines(np.array([second, first]))[0].at_stored(near, scale)
    plane = OrbitPlane(there, free)
    there = plane.on_lines(np.array([second, first]))[0]
    _check_symmetry(there, near, point, free)
    placed = _along_first(point, near, facts.free == first_name)
    curve, further = begun_at(there, placed, At(near, scale, typical[free[1]]), free)
    z = np.concatenate([own, further, [second, first]])
    known = np.concatenate(
        [weights[:-1], np.where(further == 0.0, 1.0, np.abs(further)), [typical[free[1]]], scale[-1:]]
    )
    return OrbitLocus(plane, curve, (z, known)), z


def _check_symmetry(
    orbit: DiscretizedOrbit, z: np.ndarray, point: SpecialPoint, free: tuple[str, str]
) -> None:
    """Refuse a curve of orbits closed up to a symmetry that the machine has at its start alone."""
    values, system = orbit.values_of(z), orbit.system
    for name in free:
        line = ParameterLine.of(system, values, name)
        broken = broken_at(orbit, z, line.at(line.elsewhere(system, values[name])))
        if broken:
            raise StartError(
                f"No curve in two parameters can be followed from {point.name}: its orbit is closed up to "
                f"the symmetry '{broken}', which holds at {name} = {values[name]:.10g} and not beside it.",
                f"Continue over {name} alone first, and start from a special point of that branch.",
            )


def _along_first(point: SpecialPoint, near: np.ndarray, same: bool) -> SpecialPoint:
    """A point of a branch as one of orbits on the line along the first parameter, whose unknowns are `near`.

    Of a branch along another parameter (not the `same`) the tangent is known but for what that moves. `near`
    has the shape (N + 1,).
    """
    tangent = point.tangent if same else (*point.tangent[:-1], 0.0)
    return replace(point, unknowns=tuple(near.tolist()), tangent=tangent)
