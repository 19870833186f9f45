"""What every discretised orbit is made of, whatever its unknowns are."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np

from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.evaluations import Evaluations
from contwalk.problems.orbit.protocol import Orbit
from contwalk.problems.parameter_line import Ends, ParameterLine
from contwalk.system import Neutral, System


class OrbitData(Orbit):
    """A system, the line of its parameters, what is pinned, and how finely orbits are computed."""

    def __init__(
        self,
        system: System,
        parameters: Mapping[str, float],
        free: str,
        path: Ends | None,
        pins: Sequence[Neutral],
        reference: np.ndarray | None,
        subharmonic: int,
        discretization: Discretization | None,
    ) -> None:
        self.system, self.line = system, ParameterLine.of(system, parameters, free, path)
        self.free, self.parameters = free, self.line.parameters
        self.pins, self.reference = tuple(pins), reference
        self.subharmonic = subharmonic
        self.discretization = discretization or Discretization()
        self.states = len(system.states)
        self.forced = system.period is not None
        self.section = None
        self.known = Evaluations()

    def _varied(self, **changes: Any) -> Self:
        """The same with some attributes changed; nothing that is remembered of this one is true of it."""
        other = copy.copy(self)
        other.known = Evaluations()
        for name, value in changes.items():
            setattr(other, name, value)
        return other
