"""Periodic orbits of a smooth system as one free parameter varies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import numpy as np

from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.orbit_data import Further
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.parameter_line import Ends
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Sample
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
    limited = None
    # Stability grows with the square of the amplitude, and drowns in the error of the steps nearer by.
    branching_offset = 1.0

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

    # -- along a branch ----------------------------------------------------------------------------------

    def _watched(
        self, z: np.ndarray, found: Multipliers, error: float, known: Sample | None
    ) -> dict[str, Any]:
        """What a sample tells of such orbits only."""
        return {
            "forbidden": self.system.has_events
            and passed_over(self.system, *self.motion_of(z), self.values_of(z)),
        }
