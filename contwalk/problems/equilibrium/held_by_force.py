"""Pinned directions along which equilibria are held by a force, and do not come in families."""

from __future__ import annotations

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Sample

# A drift this many times above what rounding makes of zero is one: a direction is neutral to 1e-12 of its
# terms.
FORCED = 1e4


def forced(problem: EquilibriumEquations, sample: Sample) -> str | None:
    """Name of the pinned direction whose drift is not zero at a solution; None where all of them are.

    The drift of a family of equilibria is what rounding of the equations makes of zero. Any other stands in
    for a residual of the machine's own equations, which are not solved then.
    """
    if not problem.pins:
        return None
    z, weights, linearization = sample.z, sample.weights, problem.linearize(sample.z)
    level = linearization.levels[0]
    try:
        bordered = linearization.bordered(sample.tangent / weights**2, weights)
        for place, pin in enumerate(problem.pins, problem.states):
            noise = np.abs(bordered.solve_adjoint(np.eye(len(z))[place])[: len(level)]) @ level
            if abs(z[place]) > FORCED * noise:
                return pin.name
    except np.linalg.LinAlgError:  # a branch point of the pinned equations: its neighbours tell
        return None
    return None


def takes_force(problem: EquilibriumEquations, z: np.ndarray, way: np.ndarray) -> bool:
    """Whether holding the pinned directions takes a force that grows along a way from a solution.

    z and the way have the shape (N + 1,).
    """
    jacobian, n = problem.jacobian(z), problem.states
    forces = np.abs(jacobian[:n, n : problem.size] * way[n : problem.size])
    rates, rounding = np.abs(jacobian[:n]) @ np.abs(way), EPSILON * np.max(np.abs(jacobian[:n, :n]))
    return bool(np.max(forces, initial=0.0) > max(1e-9 * np.max(rates), rounding * np.max(np.abs(way[:n]))))
