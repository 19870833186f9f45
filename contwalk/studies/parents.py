"""The branch that a branch has returned to, where it is not known: of orbits begun on less than the least.

A simulation settles on what is stable, which may be a doubled orbit, or one of a pair without the symmetry of
the machine. Its branch ends where the orbit repeats itself, or is its own image: there it has become its
parent, which nobody has followed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation import control
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.opening import Opening
from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.least_part import least
from contwalk.problems.initial.orbit_from_state import orbit_at, symmetric
from contwalk.problems.orbit.asymmetry import repetitions
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.orbit.periodic_orbit import PeriodicOrbit
from contwalk.problems.problem import Problem


def parent_of(problem: Problem, point: SpecialPoint, settings: Settings) -> Opening | Outcome | None:
    """The branch that an orbit's has become at a point, begun there; None where the orbit is its own least.

    Why there is none, where it cannot be begun.
    """
    if not isinstance(problem, OrbitProblem):
        return None
    z = np.array(point.unknowns)
    there: Any = problem.finely(z)
    part: tuple[OrbitProblem, np.ndarray] | None = (
        _least_eventful(there, z) if isinstance(there, HybridOrbit) else _least_smooth(there, z)
    )
    if part is None:
        return None
    state = begin(*part, settings)
    if not isinstance(state, ContinuationState):
        return not_begun.no_start(state.reason, state.sentence, "a periodic orbit")
    return Opening(part[0], _beside(part[0], state, settings))


def _beside(problem: OrbitProblem, state: ContinuationState, settings: Settings) -> ContinuationState:
    """A solution a step away, so that the branch passes the point: it is one of its own special points."""
    for sign in (1.0, -1.0):
        z = state.sample.z + sign * settings.step * state.sample.tangent
        if control.inside(z, settings.bounds):
            found = begin(problem, z, settings)
            if isinstance(found, ContinuationState):
                return found
    return state


def _least_eventful(problem: HybridOrbit, z: np.ndarray) -> tuple[HybridOrbit, np.ndarray] | None:
    """As `_least_smooth`, of legs."""
    part = least(problem, z)
    return None if part[0] is problem else part


def _least_smooth(problem: PeriodicOrbit, z: np.ndarray) -> tuple[PeriodicOrbit, np.ndarray] | None:
    """The same orbit over its least period, and over the part of it that a symmetry makes the whole of.

    z has the shape (N + 1,) of its problem, before and after.
    """
    found, times = None, repetitions(problem, z)
    if times > 1:
        first, part = problem.first_state(z), problem.duration(z) / times
        given = problem.discretization, max(problem.subharmonic // times, 1), problem.pins
        found = problem, z = orbit_at(problem.system, problem.line, float(z[-1]), first, part, *given)
    return symmetric(problem, z, problem.weighted(problem.mesh.variation)) or found
