"""What orbits of both kinds offer to the engine in the same words."""

from __future__ import annotations

from typing import Self

import numpy as np

from contwalk.problems.orbit import augmented, branching, rates
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.protocol import Orbit
from contwalk.problems.problem import Located, Sample


class OrbitProblem(Orbit):
    """The part of a problem of orbits that does not depend on how they are discretised."""

    blur = 1e-3  # solutions are solved for to a part of the tolerance only

    @property
    def meshed(self) -> Self:
        """An orbit is its own discretisation."""
        return self

    @property
    def observed(self) -> Self:
        """It measures its solutions itself."""
        return self

    @property
    def equivalence(self) -> Self:
        """It compares its solutions itself."""
        return self

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N, N + 1)."""
        return self.linearize(z).jacobian

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> Self:
        """The problem discretised for a solution that is taken up again."""
        problem: Self = self.adapted_to(z, weights)
        return problem

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Self:
        """The same problem on the finest steps that rounding allows."""
        problem: Self = self.refined(z, weights, FINEST)
        return problem

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""
        return augmented.observed(self, name, level, sample)

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        return rates.of_observable(self, name, sample)

    def tangent_at(self, located: Located, near: Sample) -> np.ndarray | None:
        """At a branch point, the tangent of the branch that `near` is on."""
        return branching.tangent_through(self, located, near)
