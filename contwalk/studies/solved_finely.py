"""A first orbit solved again on steps so fine that their errors hide nothing of its symmetries."""

from __future__ import annotations

from typing import TypeVar

from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.problems.orbit.asymmetry import nearly_less
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.problem import equations_at
from contwalk.problems.sample import Sample

Orbit = TypeVar("Orbit", bound=OrbitProblem)

# Tolerance of these steps, in units of that along the branch.
FINER = 1e-4


def solved_finely(problem: Orbit, sample: Sample, settings: Settings) -> tuple[Orbit, Sample]:
    """An orbit and its problem on steps whose errors do not hide that it repeats itself, or is its own image.

    As they are where nothing is hidden, and where there is no solution on such steps.
    """
    if not nearly_less(problem, sample.z):
        return problem, sample
    tolerance = max(FINER * problem.discretization.walking, FINEST)
    finer = problem.refined(sample.z, sample.weights, tolerance)
    again = begin(finer, sample.z, settings)
    if not isinstance(again, ContinuationState):
        return problem, sample
    there, _ = equations_at(finer, again.sample.z)
    return there, again.sample
