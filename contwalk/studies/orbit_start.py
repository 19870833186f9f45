"""Where a branch of orbits is to begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.continuation.settings import Settings
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Neutral, System


@dataclass(frozen=True, eq=False)
class OrbitStart:
    """Where a branch of orbits is to begin; see `opening_orbits.opened_orbit`.

    Parameters
    ----------
    system : System
    line : ParameterLine
    at : float, optional
        Its coordinate at the start.
    state : ndarray, shape (n,)
    settings : Settings
    discretization : Discretization, optional
    until : float or "settled", optional
        Simulate from the state so long first, and take the orbit that the motion settles on.
    period : float, optional
        Seconds, of an autonomous system's orbit or for a subharmonic one.
    mode, event : str, optional
        Of a hybrid system, the mode that the state is in, or the transition that it is right before.
    subharmonic : int
        The orbit of a forced system lasts so many of its periods.
    pins : sequence of Neutral, optional
        Neutral directions that are held; those of the start by default.
    """

    system: System
    line: ParameterLine
    at: float | None
    state: np.ndarray
    settings: Settings
    discretization: Discretization | None
    until: float | str | None = None
    period: float | None = None
    mode: str | None = None
    event: str | None = None
    subharmonic: int = 1
    pins: Sequence[Neutral] | None = None

    @property
    def values(self) -> dict[str, float]:
        """All parameters at the start, by name."""
        return self.line.at(self.line.place(self.at))
