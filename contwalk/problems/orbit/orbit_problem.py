"""What orbits of both kinds offer to the engine in the same words."""

from __future__ import annotations

from typing import Self

import numpy as np

from contwalk.problems.orbit import augmented, branching, equations, monodromy, rates, scales, variations
from contwalk.problems.orbit.discretization import FINEST
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.return_map import ReturnMap
from contwalk.problems.problem import Located, Sample


class OrbitProblem(OrbitData):
    """The part of a problem of orbits that does not depend on how they are discretised."""

    blur = 1e-3  # solutions are solved for to a part of the tolerance only

    @property
    def meshed(self) -> Self:
        """An orbit is its own discretisation."""
        return self

    @property
    def anchored(self) -> Self:
        """Its mesh is made for the orbit."""
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

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution."""
        return equations.errors(self, self.linearize(z))

    @property
    def equation_scales(self) -> np.ndarray:
        """Units of the equations, shape (N,). Their own rows would not do: one that vanishes at a special
        point is the critical one.
        """
        return scales.equation_scales(self)

    # -- second derivatives: see `variations` ------------------------------------------------------------

    @property
    def cycle_scales(self) -> tuple[np.ndarray, np.ndarray]:
        """Units of the rows and of the columns of `cycle_matrix`."""
        return scales.cycle_scales(self)

    def cycle_matrix(self, jacobian: np.ndarray, multiplier: complex) -> np.ndarray:
        """L(mu), singular where mu is a multiplier."""
        return variations.cycle_matrix(self, jacobian, multiplier)

    def cycle_return(self, psi: np.ndarray, v: np.ndarray) -> complex:
        """-psi* L' v, where L' is the derivative of `cycle_matrix` by the multiplier."""
        return variations.cycle_return(self, psi, v)

    def cycle_derivative(self, z: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative by z of L v for a real v, shape (N, N + 1)."""
        return variations.cycle_derivative(self, z, v)

    def cycle_rate(self, z: np.ndarray, v: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Derivative of L v along a direction, for a real v, shape (N,)."""
        return variations.cycle_rate(self, z, v, tangent)

    def derivative_along(self, z: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Derivative by z of DF(z) v for a real v of length N + 1, shape (N, N + 1)."""
        return variations.derivative_along(self, z, v)

    # -- once round --------------------------------------------------------------------------------------

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure, without the flow's own and the pinned ones."""
        return monodromy.spectrum(self, z, jacobian)

    def return_map(self, z: np.ndarray) -> SectionMap:
        """The map that takes a section once round the orbit, for normal forms."""
        return ReturnMap(self, z)

    # -- discretisations ---------------------------------------------------------------------------------

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
