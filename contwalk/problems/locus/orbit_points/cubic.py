"""Points at which a cubic coefficient vanishes: generalized period doublings (GPD), Chenciner points (CH)."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import NotFinite
from contwalk.numerics.bracketing import UNSURE
from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, known_to, where_zero
from contwalk.problems.locus.partners import partners
from contwalk.problems.orbit import normal_forms
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.point_records import VANISHES
from contwalk.problems.problem import Located, Sample, Seed, Test

FIFTH = "the coefficient of fifth order, which tells the sides, is not computed"

# Cubic terms are cancelled by squares of quadratic ones: where deviations grow by more, as right beside a
# grazing of the orbit's own event, rounding leaves nothing of the difference.
MOST_GROWTH = 5e5
UNKNOWN = float("nan"), 0.0


class VanishingCubic(OrbitLocusPoint):
    """The orbits or tori that are born change their side."""

    test, of_place, dear = Test.VALUE, True, True

    def value(self, problem: Any, sample: Sample) -> float:
        """The cubic coefficient; `UNSURE` where it is no more than errors of the steps, NaN where there is
        none or rounding hides it.

        Of area-preserving maps it is zero all along, and signs of errors tell nothing. Beside strong
        resonances its terms are large, and their errors with them, while it may stay what it is. Where the
        curve holds both of a pair mu, 1/mu there is none on one direction alone.
        """
        there, own = problem.plane.first(sample.z)
        if len(partners(there, own, problem.curve.critical(problem.further(sample.z)))):
            return UNKNOWN[0]
        found, terms = self._with_terms(problem, sample.z)
        hidden = abs(found) <= max(VANISHES, known_to(problem)) * terms
        return math.copysign(UNSURE, found) if hidden else found

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The point of the curve at which it vanishes."""
        return where_zero(sample, problem, lambda own, z: self._with_terms(own, z)[0])

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient, as it is left there."""
        return None, self.coefficients(problem, located.z), FIFTH

    def _with_terms(self, problem: Any, z: np.ndarray) -> tuple[float, float]:
        """The cubic coefficient, NaN where it is unknown, and the size of its terms.

        It has poles where other multipliers meet those of its equations, but on invariant faces none: they
        are told from zeros by what it does beside them, and nothing is multiplied by.
        """
        there, own = problem.plane.first(z)
        map_ = there.return_map(own)
        if float(np.linalg.norm(map_.a, 2)) > MOST_GROWTH or _folded(map_.a, known_to(problem)):
            return UNKNOWN
        try:
            return self.cubic(problem, z, map_)
        except (NotFinite, np.linalg.LinAlgError):  # at a pole itself
            return UNKNOWN

    @abstractmethod
    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> tuple[float, float]:
        """The cubic coefficient, NaN where there is none, and the size of its terms.

        z has the shape (N + k + 2,).
        """

    @abstractmethod
    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """What is told of a located point.

        z has the shape (N + k + 2,).
        """


def _folded(a: np.ndarray, known: float) -> bool:
    """Whether a multiplier is one to the errors of the steps: what (1 - A)^-1 tells is rounding there.

    Where branches cross at all values of the parameters the coefficient has no pole, but another value on
    each of both curves.
    """
    values = np.linalg.svd(np.eye(len(a)) - a, compute_uv=False)
    return bool(values[-1] <= known * values[0])


class GeneralizedDoubling(VanishingCubic):
    """Period doublings change between super- and subcritical."""

    label = "GPD"

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of folds of doubled orbits that is born there."""
        births: Any = import_module("contwalk.problems.locus.doubled_births")  # it knows curves of orbits
        found: Sequence[Seed] = births.folds_of_doubled_orbits(problem, point)
        return found

    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> tuple[float, float]:
        """That of the return map's normal form.

        z has the shape (N + k + 2,).
        """
        return normal_forms.cubic_of_flip(map_)

    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """c.

        z has the shape (N + k + 2,).
        """
        there, own = problem.plane.first(z)
        return normal_forms.flip(there.return_map(own))


class Chenciner(VanishingCubic):
    """Neimark-Sacker points change between super- and subcritical."""

    label = "CH"

    def cubic(self, problem: Any, z: np.ndarray, map_: SectionMap) -> tuple[float, float]:
        """Re d; NaN of neutral saddles.

        z has the shape (N + k + 2,).
        """
        cosine = float(problem.further(z)[0])
        if not abs(cosine) < 1.0:
            return UNKNOWN
        d, terms = normal_forms.cubic_of_torus(map_, float(np.arccos(cosine)))
        return d.real, terms

    def coefficients(self, problem: Any, z: np.ndarray) -> dict[str, Any]:
        """Re d, and the angle.

        z has the shape (N + k + 2,).
        """
        there, own = problem.plane.first(z)
        return normal_forms.torus(there.return_map(own), float(np.arccos(problem.further(z)[0])))
