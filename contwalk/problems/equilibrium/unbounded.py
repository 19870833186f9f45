"""Branches of equilibria, and their curves, that run off to infinity while their parameter converges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.branch import Outcome
from contwalk.errors import PluginError
from contwalk.numerics.linear import EPSILON
from contwalk.problems.equilibrium.equilibrium_equations import EquilibriumEquations
from contwalk.problems.problem import Sample
from contwalk.problems.unbounded import limit_at_infinity

# The parameter is at its limit if what is left is this part of its magnitude; a limit that is such a part is
# zero. It is followed until the slope has fallen to rounding: a domain of the equations may end on the way.
REST = 1e-10
# How far from an edge of the domain, in magnitudes of the parameter, it is asked what is left to it; of a
# limit that exists it is this part of what it is at the second place, or less.
ASIDE, VANISHES = (1e-13, 1e-11), 0.95


def escape(
    problem: EquilibriumEquations, a: Sample, b: Sample, name: Callable[[int], str | None], what: str
) -> Outcome | None:
    """The end where an unknown that has a name runs off to infinity beyond two neighbouring solutions, if it
    does; `what` says so in words.
    """
    which = int(np.argmax(np.abs(b.tangent[:-1]) / b.weights[:-1]))
    found = limit_at_infinity(problem, which, a, b, REST, fallen=EPSILON)
    if found is None or name(which) is None or _at_an_edge(problem, b):
        return None
    free, limit = problem.free, 0.0 if abs(found[0]) <= REST * b.weights[-1] else found[0]
    return Outcome(
        "complete",
        "unbounded",
        f"{what} as {free} tends to {limit:.10g}: {name(which)} is {b.z[which]:.4g} at "
        f"{free} = {b.parameter:.10g}. Nothing to do.",
    )


def _at_an_edge(problem: EquilibriumEquations, b: Sample) -> bool:
    """Whether right beyond a solution the equations have no value, but a limit where they cease to have one.

    There a branch arrives, however steeply: at p = 1 along x = (p - 1)**0.1, not along x = log(p - 1). What
    they change by on the rest of the way vanishes with it.
    """
    size, way = float(b.weights[-1]), float(np.copysign(1.0, b.tangent[-1]))
    inside, beyond = b.parameter, b.parameter + way * REST * size
    if _has_value(problem, b.z, beyond):
        return False
    while (between := 0.5 * (inside + beyond)) not in (inside, beyond):
        inside, beyond = (between, beyond) if _has_value(problem, b.z, between) else (inside, between)
    rests = []
    for distance in ASIDE:
        there = b.z.copy()
        there[-1] = inside - way * distance * size
        rests.append(distance * np.abs(problem.jacobian(there)[:, -1]).max())
    return bool(rests[0] < VANISHES * rests[1])


def _has_value(problem: EquilibriumEquations, z: np.ndarray, value: float) -> bool:
    """Whether the equations at z, shape (N + 1,), have a value with another parameter."""
    there = z.copy()
    there[-1] = value
    return _finite(problem, there)


def _finite(problem: EquilibriumEquations, z: np.ndarray) -> bool:
    try:
        with np.errstate(all="ignore"):
            return problem.linearize(z).finite
    except PluginError:
        return False
