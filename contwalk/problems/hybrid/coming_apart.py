"""Events that happen at one instant by a symmetry, and come apart where it is lost.

Beside the orbit either of them comes first. Where they commute the machine is smooth there, but once only: to
the second order each side has terms of its own. So stability is told, and how branches leave is not.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.orbit import variations
from contwalk.problems.orbit.null_vectors import null_vectors
from contwalk.problems.orbit.scales import cycle_scales
from contwalk.problems.problem import Seed


def part(problem: LimitedOrbit, direction: np.ndarray) -> bool:
    """Whether a direction of the unknowns, shape (N,) or (N + 1,), takes events of one instant apart.

    A duration that it leaves as it is has rounding of the others, to its root.
    """
    together = [leg.together for leg in problem.itinerary.legs]
    moved = np.abs(direction[problem.layout.durations])[together] / problem.mesh.total
    return bool(np.any(moved > np.sqrt(EPSILON) * np.abs(direction).max()))


def along(seed: Seed) -> bool:
    """Whether events come apart on a branch that leaves."""
    problem = seed.problem
    return isinstance(problem, LimitedOrbit) and seed.tangent is not None and part(problem, seed.tangent)


def critical(
    problem: LimitedOrbit, z: np.ndarray, multiplier: float | None, coefficients: Mapping[str, Any]
) -> bool:
    """Whether events come apart along a point's critical direction, of a multiplier or of that of its angle.

    z has the shape (N + 1,).
    """
    turn = np.exp(1j * coefficients["theta"]) if "theta" in coefficients else multiplier
    if turn is None or not any(leg.together for leg in problem.itinerary.legs):
        return False
    matrix = variations.cycle_matrix(problem, problem.linearize(z).jacobian, turn)
    return part(problem, null_vectors(problem, matrix, *cycle_scales(problem))[0])


def told(problem: LimitedOrbit) -> str:
    """What is to be said of such a point."""
    itinerary = problem.itinerary
    places = [k for k, leg in enumerate(itinerary.legs) for k in (k - 1, k) if leg.together]
    names = ", ".join(f"'{name}'" for name in dict.fromkeys(itinerary.legs[k].name for k in places))
    return (
        f"events at one instant ({names}) come apart in what leaves here: which is first changes with its "
        "side, and with it the terms of second order"
    )
