"""Where a curve of equilibria ends, or cannot go on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.problems.equilibrium.diagnosis import EquilibriumDiagnosis
from contwalk.problems.kink import Kink, Met
from contwalk.problems.locus.plane import Plane
from contwalk.problems.sample import Sample


@dataclass(frozen=True)
class LocusDiagnosis:
    """What is known of such places: what is known of the equilibria themselves.

    `in_plane` reads (x, drifts, second, first) from the unknowns of the curve, shape (N + 1,).
    """

    plane: Plane
    in_plane: Callable[[np.ndarray], np.ndarray]

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Nothing is known by which a curve ends."""
        return None

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z, shape (N + 1,), is not finite."""
        return EquilibriumDiagnosis(self.plane).explain(self.in_plane(z))

    def obstacle(self, z: np.ndarray) -> str:
        """Nothing is known of what keeps a curve from going on at z, shape (N + 1,)."""
        return ""

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """Where the equilibria's equations change their piece between two places, shape (N + 1,)."""
        return EquilibriumDiagnosis(self.plane).passed(self.in_plane(a), self.in_plane(b))

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Where the equilibria's equations are smooth by pieces only."""
        places = (replace(s, z=self.in_plane(s.z), weights=self.in_plane(s.weights)) for s in (a, b))
        return EquilibriumDiagnosis(self.plane).kinks_between(*places)

    def many_branches(self, z: np.ndarray) -> bool:
        """Nothing is known of curves that cross at z, shape (N + 1,), at the ends of ranges."""
        return False
