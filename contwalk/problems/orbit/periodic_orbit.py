"""Periodic orbits of a smooth system as one free parameter varies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.orbit_problem import OrbitProblem
from contwalk.problems.parameter_line import Ends
from contwalk.problems.passed_over import passed_over
from contwalk.problems.problem import Sample
from contwalk.system import Neutral, System


class PeriodicOrbit(OrbitProblem):
    """The problem S phi(x, T, p) = x with a phase condition, by multiple shooting.

    The unknowns are u = (x_0, ..., x_m-1, T, a): states at the starts of m segments of equal duration, the
    period (autonomous systems only), a drift for each pinned neutral direction. An instance is one
    discretisation, with its section and its steps; `adapted` makes the next one.

    Parameters
    ----------
    system : System
        Its first mode's field is continued.
    parameters : mapping
        Values of all parameters.
    free : str
        Name of the free parameter, or `path`.
    path : tuple of two mappings, optional
        All parameters at its beginning and end, when `free` is `path`.
    pins : sequence of Neutral
        Neutral directions that are pinned along the branch.
    reference : ndarray, shape (n,), optional
        State at which pins without a parameter hold their direction.
    subharmonic : int
        The orbit of a forced system lasts so many of its periods.
    discretization : Discretization, optional
        Steps, segments and how exactly orbits are computed; by default chosen as the accuracy asks.
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
        *,
        pins: Sequence[Neutral] = (),
        reference: np.ndarray | None = None,
        subharmonic: int = 1,
        discretization: Discretization | None = None,
    ) -> None:
        given = system, Itinerary((Leg(system.modes[0].name),)), parameters, free, path
        super().__init__(
            *given,
            pins=pins,
            reference=reference,
            subharmonic=subharmonic,
            discretization=discretization,
        )

    # -- along a branch ----------------------------------------------------------------------------------

    def _watched(
        self, z: np.ndarray, found: Multipliers, error: float, known: Sample | None
    ) -> dict[str, Any]:
        """What a sample tells of such orbits only."""
        return {
            "forbidden": self.system.has_events
            and passed_over(self.system, *self.motion_of(z), self.values_of(z)),
        }
