"""Cusps (CP), at which the quadratic coefficient of a fold vanishes: p.B(q, q) = 0."""

from __future__ import annotations

from typing import Any

from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import Critical
from contwalk.problems.locus.normal_forms import cusp_coefficient
from contwalk.problems.locus.plane import FloatPlace, Place
from contwalk.problems.locus.points.point import LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Test


class Cusp(LocusPoint):
    """Two branches of folds meet."""

    label, test = "CP", Test.VALUE

    def value(self, problem: Any, sample: Sample) -> float:
        """p.B(q, q) along the curve."""
        place = FloatPlace(problem.plane, problem.in_plane(sample.z))
        return quadratic(place, problem.augmented.told(place, [0.0])[0], 0.0)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The cusp near a sample."""
        return located_by(problem, problem.augmented, sample, [], quadratic)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient c."""
        return None, None, cusp_coefficient(problem.plane, problem.in_plane(located.z)), None


def quadratic(place: Place, found: Critical, kappa: Any) -> Any:
    """p.B(q, q)."""
    return found.left[0] @ place.second(found.right[0], found.right[0])
