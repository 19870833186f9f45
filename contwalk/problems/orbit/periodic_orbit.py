"""Periodic orbits of a smooth system as one free parameter varies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np

from contwalk.memory import of_unowned, unowned
from contwalk.numerics.linear import Factored
from contwalk.problems import neutral as neutrals
from contwalk.problems.kink import Kink
from contwalk.problems.orbit import asymmetry, equations, monodromy, switching, termination
from contwalk.problems.orbit.cutting import room
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.mirror import OrbitMirror, mirror_of
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.orbit_data import Further
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.orbit.orbit_section import velocities
from contwalk.problems.orbit.points.catalogue import POINT_TYPES
from contwalk.problems.orbit.smooth_diagnosis import SmoothDiagnosis
from contwalk.problems.orbit.step_blocks import multipliers_of
from contwalk.problems.parameter_line import Ends
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Linearization, Sample
from contwalk.system import System


class PeriodicOrbit(OrbitProblem):
    """The problem S phi(x, T, p) = x with a phase condition, by multiple shooting.

    The unknowns are u = (x_0, ..., x_m-1, T, a): states at the starts of m segments of equal duration, the
    period (autonomous systems only), a drift for each pinned neutral direction. An instance is one
    discretisation, with its section and its steps; `adapted` makes the next one.

    Parameters
    ----------
    system : System
        Its first mode's field is continued.
    parameters, free, path, pins, reference
        As for `Equilibrium`.
    subharmonic : int
        The orbit of a forced system lasts so many of its periods.
    discretization : Discretization
    """

    kind = "periodic_orbit"
    in_closure = True
    asymmetries = asymmetry.of_moving
    point_types = POINT_TYPES
    limited = None
    # Stability grows with the square of the amplitude, and drowns in the error of the steps nearer by.
    branching_offset = 1.0
    switching = switching

    def __init__(
        self,
        system: System,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None = None,
        **further: Unpack[Further],
    ) -> None:
        itinerary = Itinerary((Leg(system.modes[0].name),))
        super().__init__(system, itinerary, parameters, free, path, **further)

    # -- what is told of it ------------------------------------------------------------------------------

    @property
    def diagnosis(self) -> SmoothDiagnosis:
        """What is known of places where a branch ends, or cannot go on."""
        return SmoothDiagnosis(self)

    def velocity(self, z: np.ndarray) -> np.ndarray:
        """dx/dt at the start. z has the shape (N + 1,), the velocity (n,)."""
        return velocities(self, z)[0] / self.duration(z)

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """None: there are no events. z has the shape (N + 1,)."""
        return ()

    # -- equations ---------------------------------------------------------------------------------------

    def _linearized(self, z: np.ndarray) -> Linearization:
        if self.forced:
            equations.period_of(self, z)  # asked first: without a period there is no motion to tell of
        residual, jacobian, nodes = equations.with_derivatives(self, z)
        self.known.at("nodes", z, self.most_kept, lambda: nodes)
        levels, magnitudes = of_unowned(equations.levels, self), unowned(self.magnitudes_near)
        return Linearization(residual, jacobian, lambda: (levels(z, jacobian), None), lambda: magnitudes(z))

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factored:
        """A matrix of these equations and unknowns, and of borders that come last, factored.

        The matrix has the shape (m, m), the weights (m,).
        """
        return Factored(matrix, weights)

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch of these orbits, as fields of `BranchInfo`."""
        neutral = len(self.pins) + len(self.system.conserved) + (0 if self.forced else 1)
        return {
            "problem": self.kind,
            "observables": self.observable_names,
            "unknowns": self.cut_into(room(self)).size,
            "spectrum": max(self.states - neutral, 1),
            "closure": self.whole[0],
            "subharmonic": self.subharmonic,
            "settings": {
                **neutrals.kept(self.pins, self.line, self.states),
                "segments": self.mesh.segments,
                **({"scheme": self.discretization.scheme} if self.uneven else {}),
                "fold": self.itinerary.closures,
                "parts": self.parts,
                "power": self.itinerary.power,
                "turns": self.turns.tolist(),
                # Where the stored state is taken: a section, or where the phase happens to be fixed.
                "reported": "at a section" if self.discretization.report_at is not None else "",
            },
        }

    # -- along a branch ----------------------------------------------------------------------------------

    def _watched(
        self, z: np.ndarray, found: Multipliers, error: float, known: Sample | None
    ) -> dict[str, Any]:
        """What a sample tells of such orbits only."""
        return {
            "observables": self.observables(z, found) if known is None else known.observables,
            "forbidden": self.system.has_events
            and passed_over(self.system, *self.motion_of(z), self.values_of(z)),
        }

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure, without the flow's own and the pinned ones.

        z has the shape (N + 1,), the jacobian (N, N + 1).
        """
        if self.uneven and self.mesh.segments > 1:
            return multipliers_of(self, z, monodromy.becoming_of(self, z))
        return monodromy.spectrum(self, z, jacobian)

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""
        gradient = super().duration_gradient(z)
        if self.forced:
            gradient[-1] = equations.period_of(self, z)[1]
        return gradient

    def admissible_at(self, z: np.ndarray) -> bool:
        """Whether a solution is one that the machine can move on: without events, all are.

        z has the shape (N + 1,).
        """
        return True

    def returned_to_parent(self, z: np.ndarray, tangent: np.ndarray) -> bool:
        """Whether the orbit of a branch with this tangent has become its parent again.

        z and tangent have the shape (N + 1,).
        """
        return termination.returned_to_parent(self, z, tangent)

    # -- special points ----------------------------------------------------------------------------------

    def mirror(self, sample: Sample) -> OrbitMirror | None:
        """What takes one half of the branch that leaves an orbit to the other, if a symmetry does."""
        return mirror_of(self, sample)
