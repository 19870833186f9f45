"""Whether a branch has a corner where two events are exchanged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contwalk.errors import NotFinite
from contwalk.numerics.linear import kernel_direction
from contwalk.numerics.spectrum import complement
from contwalk.problems.hybrid import limit_equations
from contwalk.problems.hybrid.adjacent.at_limit import arrival, begun_elsewhere, built_at
from contwalk.problems.hybrid.adjacent.orbit import NoAdjacentOrbit
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margins import Limit
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.fine_steps import discretized

# Directions of a branch before and after an exchange that differ by more make a corner.
CORNER = 1e-5


def has_corner(problem: LimitedOrbit, z: np.ndarray, limit: Limit, tangent: np.ndarray) -> bool:
    """Whether the branch has a corner where two events are exchanged: its way before is not its way after.

    `tangent` is that of the branch that arrives. Compared are the parameter and the starts of all other legs,
    across the flow.

    z and `tangent` have shape (N + 1,).
    """
    found = discretized(problem, z).margins(z)
    which = found.limits.index(limit)
    if arrival(found, which, problem.layout.legs) != which:
        return False  # a visit begins or ceases, as the root of the distance
    try:
        if problem.itinerary.image:
            problem, z, limit = begun_elsewhere(problem, z, limit)
            tangent = kernel_direction(problem.linearize(z).jacobian, filled_magnitudes(problem, z))
        neighbour = built_at(problem, z, limit, 0.0)
    except (NoAdjacentOrbit, NotFinite, np.linalg.LinAlgError):
        return False
    if neighbour.grows.test == "dip":
        return False  # as above: beyond, a guard turns before it is met
    there = neighbour.problem
    weights = filled_magnitudes(there, neighbour.z)
    leaving = kernel_direction(there.linearize(neighbour.z).jacobian, weights)
    leaving = leaving * np.sign(limit_equations.growth(there, neighbour.z, neighbour.grows, leaving))
    rough = discretized(problem, z)
    arriving = tangent * -np.sign(limit_equations.growth(rough, z, limit, tangent))

    if there.layout.sizes != problem.layout.sizes:
        return bool(np.sign(arriving[-1]) != np.sign(leaving[-1]))
    scales = [there.extended(i) for i in range(there.layout.legs)]
    before = _direction_of_orbit(rough, z, arriving, limit.leg, scales, weights[-1])
    after = _direction_of_orbit(there, neighbour.z, leaving, limit.leg, scales, weights[-1])
    return float(np.linalg.norm(before - after)) > CORNER


def _direction_of_orbit(
    problem: LimitedOrbit,
    z: np.ndarray,
    vector: np.ndarray,
    without: int,
    scales: Sequence[np.ndarray],
    weight: float,
) -> np.ndarray:
    """How an orbit changes along a direction, as a unit vector: its legs' starts, and the parameter.

    Along the flow a start moves with the instant of its event, and along pinned directions with the observer:
    both say nothing about the orbit.
    """
    parts = []
    for i in range(problem.layout.legs):
        if i == without:
            continue
        own, scalars = problem.layout.inputs(i, vector)
        direction = (np.append(own, scalars[1]) if problem.forced else own) / scales[i]
        along = [monodromy.flow_direction(problem, z, i), *monodromy.pinned_directions(problem, z, i)]
        across = complement((np.array(along) / scales[i]).T)
        parts.append(across.T @ direction)
    whole = np.concatenate([*parts, [vector[-1] / weight]])
    return whole / max(float(np.linalg.norm(whole)), 1e-300)
