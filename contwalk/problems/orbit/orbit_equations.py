"""The equations of an orbit as the engine asks for them, and what is computed of them once round."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Self

import numpy as np

from contwalk.memory import of_unowned, unowned
from contwalk.numerics.linear import Factored, Factorization
from contwalk.problems.linearization import Fitted
from contwalk.problems.orbit import condensed, equations, metric, monodromy, scales
from contwalk.problems.orbit.at_kinks import BESIDE, WIDER, ending_at_kinks
from contwalk.problems.orbit.discretized_orbit import DiscretizedOrbit
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.return_map import ReturnMap
from contwalk.problems.orbit.step_blocks import multipliers_of
from contwalk.problems.problem import Linearization

# Linearizations that are kept, as far as they fit: a step asks for the same ones several times.
LEAST_KEPT, MOST_KEPT, MOST_BYTES = 3, 12, 5e7


class OrbitEquations(DiscretizedOrbit):
    """What ends where the next one starts, guards, phase, period and pins: see `equations`."""

    magnitudes_near = metric.magnitudes_near
    # Whether steps are those that they were made from, and end at no kinks of other motions.
    on_own_steps = False

    @property
    def most_kept(self) -> int:
        """How many linearizations are kept."""
        return int(min(max(MOST_BYTES / (8.0 * self.size**2), LEAST_KEPT), MOST_KEPT))

    def linearize(self, z: np.ndarray) -> Linearization:
        """The equations at z. z has the shape (N + 1,)."""
        return self.known.at("linearization", z, self.most_kept, lambda: self._linearized(z))

    def _linearized(self, z: np.ndarray) -> Linearization:
        """The equations at z, computed."""
        there = self.at_kinks(z)
        residual, jacobian, nodes = equations.with_derivatives(there, z)
        if there is self:
            self.known.at("nodes", z, self.most_kept, lambda: nodes)
        levels, magnitudes = of_unowned(equations.levels, self), unowned(self.magnitudes_near)
        nearby = unowned(self.residual)
        found = Linearization(
            residual,
            jacobian,
            lambda: (levels(z, jacobian), None),
            lambda: magnitudes(z),
            self._factored,
            None if self.in_closure else lambda: nearby,
            self.fitted,
        )
        found.dear = self.known.once("dear", lambda: equations.dear(self))
        return found

    def residual(self, z: np.ndarray) -> np.ndarray:
        """F(z), shape (N,), for far less than with its derivatives."""
        return equations.residual(self.at_kinks(z), z)

    @property
    def fitted(self) -> Fitted | None:
        """What solves for unknowns that are hard to guess, as durations of legs that end with events."""
        return None

    @property
    def cost(self) -> int:
        """Right-hand sides of one pass with derivatives, each column counted as one."""
        return equations.cost(self)

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A matrix of these equations and unknowns, and of borders that come last, factored.

        The matrix has the shape (m, m), the weights (m,).
        """
        return self._factored(matrix, weights)

    @property
    def _factored(self) -> Callable[[np.ndarray, np.ndarray], Factorization]:
        # An equation of the phase is one of the first leg's start: the chain has no place for it.
        return partial(condensed.factored, self.layout) if self.itinerary.eventful else Factored

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z), shape (N, N + 1)."""
        return self.linearize(z).jacobian

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution. z has the shape (N + 1,), the errors (N,)."""
        return equations.errors(self, self.linearize(z))

    @property
    def equation_scales(self) -> np.ndarray:
        """Units of the equations, shape (N,). Their own rows would not do: one that vanishes at a special
        point is the critical one.
        """
        return self.known.on(self.mesh, "equation scales", lambda: scales.equation_scales(self)).copy()

    # -- once round --------------------------------------------------------------------------------------

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure, without the flow's own and the pinned ones.

        z has the shape (N + 1,), the jacobian (N, N + 1).
        """
        there = self.at_kinks(z)
        if there is self:
            return self._multipliers(z, jacobian)
        found = there._multipliers(z, there.jacobian(z))
        wider = ending_at_kinks(self, z, WIDER * BESIDE)
        others = wider._multipliers(z, wider.jacobian(z)).values
        apart = np.abs(found.values[:, None] - others).min(axis=1, initial=np.inf)
        return found.doubted(np.nan_to_num(apart, nan=np.inf))

    def _multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """As `multipliers`, on its own steps."""
        if self.uneven and self.mesh.segments > 1:
            return multipliers_of(self, z, monodromy.becoming_of(self, z))
        return monodromy.spectrum(self, z, jacobian)

    def at_kinks(self, z: np.ndarray) -> Self:
        """The same orbit on steps that end where its field bends. z has the shape (N + 1,)."""
        held = self.on_own_steps or self.reference_orbit is not None  # this phase is told by its own steps
        return self if held else ending_at_kinks(self, z)

    def return_map(self, z: np.ndarray) -> SectionMap:
        """The map that takes a section once round the orbit, for normal forms. z has the shape (N + 1,)."""
        there, own = self.explicit(z)
        return ReturnMap(there, own)

    def velocity(self, z: np.ndarray) -> np.ndarray:
        """dx/dt at the start. z has the shape (N + 1,)."""
        return monodromy.flow_direction(*self.explicit(z), 0)

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""
        gradient = np.zeros(len(z))
        gradient[self.layout.durations] = 1.0
        if self.in_closure and self.forced:
            gradient[-1] = equations.period_of(self, z)[1]
        return gradient
