"""Points at which a cubic coefficient vanishes: generalized period doublings (GPD), Chenciner points (CH)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, where_zero
from contwalk.problems.orbit import normal_forms
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.describing import VANISHES
from contwalk.problems.orbit.multipliers import GLOBAL
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.problem import Located, Sample, Test

FIFTH = "the coefficient of fifth order, which tells the sides, is not computed"

# Cubic terms are cancelled by squares of quadratic ones: where deviations grow by more, as right beside a
# grazing of the orbit's own event, rounding leaves nothing of the difference.
MOST_GROWTH = 5e5


class VanishingCubic(OrbitLocusPoint):
    """The orbits or tori that are born change their side."""

    test, of_place = Test.VALUE, True

    def value(self, problem: Any, sample: Sample) -> float:
        """The cubic coefficient without its poles; zero where it is no more than errors of the steps, or is
        none; NaN where rounding hides it.

        Of area-preserving maps it is zero all along, and signs of errors tell nothing.
        """
        there, own = problem.plane.first(sample.z)
        map_ = there.return_map(own)
        if _drowned(map_):
            return float("nan")  # what is unknown is not zero
        found, mesh = self._without_poles(problem, sample.z, map_), problem.mesh
        return found if abs(found) > max(VANISHES, GLOBAL * mesh.amplified * mesh.tolerance) else 0.0

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The point of the curve at which it vanishes."""
        return where_zero(sample, problem, self._regular)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient, as it is left there."""
        return None, self.coefficients(problem, located.z), FIFTH

    def _regular(self, problem: Any, z: np.ndarray) -> float:
        there, own = problem.plane.first(z)
        map_ = there.return_map(own)
        return float("nan") if _drowned(map_) else self._without_poles(problem, z, map_)

    def _without_poles(self, problem: Any, z: np.ndarray, map_: SectionMap) -> float:
        values = np.linalg.eigvals(map_.a)
        factor = np.prod((1.0 - values) / (1.0 + np.abs(values)))
        for value in self.colliding(problem, z):
            values = np.delete(values, int(np.argmin(np.abs(values - value))))
            factor *= np.prod((values - value) / (1.0 + np.abs(values)))
        return float(factor.real) * self.cubic(problem, z, map_)

    def colliding(self, problem: Any, z: np.ndarray) -> Sequence[float]:
        """Critical multipliers at which a second one is a pole, for the left critical vector is normed by the
        right one; z has the shape (N + k + 2,).
        """
        return ()

    @abstractmethod
    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> float:
        """The cubic coefficient; NaN where there is none.

        z has the shape (N + k + 2,).
        """

    @abstractmethod
    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """What is told of a located point.

        z has the shape (N + k + 2,).
        """


class GeneralizedDoubling(VanishingCubic):
    """Period doublings change between super- and subcritical."""

    label = "GPD"

    def colliding(self, problem: Any, z: np.ndarray) -> Sequence[float]:
        """Minus one: a resonance 1:2.

        z has the shape (N + k + 2,).
        """
        return (-1.0,)

    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> float:
        """That of the return map's normal form.

        z has the shape (N + k + 2,).
        """
        return float(normal_forms.flip(map_)["c"])

    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """c.

        z has the shape (N + k + 2,).
        """
        there, own = problem.plane.first(z)
        return normal_forms.flip(there.return_map(own))


class Chenciner(VanishingCubic):
    """Neimark-Sacker points change between super- and subcritical."""

    label = "CH"

    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> float:
        """Re d; NaN of neutral saddles.

        z has the shape (N + k + 2,).
        """
        cosine = float(problem.further(z)[0])
        return float(normal_forms.torus(map_, np.arccos(cosine))["d"]) if abs(cosine) < 1.0 else float("nan")

    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """Re d, and the angle.

        z has the shape (N + k + 2,).
        """
        there, own = problem.plane.first(z)
        return normal_forms.torus(there.return_map(own), float(np.arccos(problem.further(z)[0])))


def _drowned(map_: SectionMap) -> bool:
    """Whether rounding hides the cubic coefficient."""
    return float(np.linalg.norm(map_.a, 2)) > MOST_GROWTH
