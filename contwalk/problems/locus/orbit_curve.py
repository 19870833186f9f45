"""What a curve of orbits is: the label of its points, its condition, the multipliers it holds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

from contwalk.problems.locus.condensed import of_any_orbit
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.valued import Valued
from contwalk.problems.orbit.augmented import Augmented


class OrbitCurve(ABC):
    """What is followed.

    Attributes
    ----------
    of : str
        The label of its points.
    further : int
        Unknowns beside those of the orbit and both parameters.
    observables : tuple of str
        What is told of its points beside what is told of orbits.
    unfolds : bool
        Whether its further unknown unfolds the orbit's equations, and must stay zero.
    by_values : bool
        Whether its condition is made of values that are known of any orbit.
    """

    of: ClassVar[str]
    further: int = 0
    observables: ClassVar[tuple[str, ...]] = ()
    unfolds: ClassVar[bool] = False
    by_values: ClassVar[bool] = False

    @abstractmethod
    def system(self, orbit: Any, near: At, further: np.ndarray) -> Augmented | Valued:
        """The orbit's equations with the condition, near a place and values of the further unknowns, (k,)."""

    def condition(self, orbit: Any, near: At, further: np.ndarray) -> Augmented | Valued:
        """`system`, of orbits whose soft transitions are condensed too.

        `further` has the shape (k,).
        """
        if self.asks_explicit(further):
            return of_any_orbit(orbit, near, further, self.system)
        return self.system(orbit, near, further)

    def asks_explicit(self, further: np.ndarray) -> bool:
        """Whether it needs more than values of condensed orbits; `further` has the shape (k,)."""
        return not self.by_values

    def critical(self, further: np.ndarray) -> np.ndarray:
        """The multipliers that the curve holds where they are, shape (c,), at its further unknowns, (k,)."""
        return np.zeros(0, dtype=complex)

    def genuine(self, further: np.ndarray) -> bool:
        """Whether anything bifurcates there: not at neutral saddles.

        `further` has the shape (k,).
        """
        return True

    def facts(self) -> dict[str, Any]:
        """What is stored of it, as plain JSON values."""
        return {"of": self.of}
