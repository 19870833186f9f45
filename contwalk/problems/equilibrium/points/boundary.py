"""An equilibrium reaches a guard of its mode (BE)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.problems.equilibrium import defining_systems as defining
from contwalk.problems.equilibrium.beyond_boundary import beyond
from contwalk.problems.equilibrium.boundaries import boundaries_of, unit
from contwalk.problems.equilibrium.points.point import EquilibriumPoint, Form
from contwalk.problems.problem import LimitType, Located, Sample, Seed, Test


class BoundaryEquilibrium(EquilibriumPoint, LimitType):
    """A boundary equilibrium bifurcation.

    Source: M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems,
    Springer 2008, chapter 5.
    """

    label, test, reason = "BE", Test.MARGIN, "boundary_equilibrium"
    entered, beyond = True, "the equilibria of the other mode"

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The equilibrium near a sample at which a guard is zero; `which` is the boundary's number."""
        return self.at_level(problem, sample, which, 0.0)

    def at_level(self, problem: Any, sample: Sample, which: int, level: float) -> Located | None:
        """Where the margin is a level, in its unit at the sample."""
        boundary = boundaries_of(problem.system)[which]
        kernels = problem.guard_kernels(boundary.name)
        value = boundary.side * level * unit(kernels[1], problem.inputs(sample.z), sample.weights)
        return defining.observed(problem, sample, kernels, value, limit=which)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """Its kind, and a note that names the guard and what lies beyond."""
        boundary = located.among(boundaries_of(problem.system))
        found = beyond(problem, located.z, sample.weights, boundary)
        return found.kind, None, {}, f"It reaches {found.words}"

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The branch of equilibria of the other mode."""
        return () if problem.limited is None else problem.limited.neighbours(point)[0]


BOUNDARY_EQUILIBRIUM = BoundaryEquilibrium()
