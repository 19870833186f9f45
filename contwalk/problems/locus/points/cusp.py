"""Cusps (CP), at which the quadratic coefficient of a fold vanishes: p.B(q, q) = 0."""

from __future__ import annotations

from typing import Any

from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.bordered import Critical, zero_borders
from contwalk.problems.locus.conditions import Augmented, Zero
from contwalk.problems.locus.normal_forms import cusp_coefficient
from contwalk.problems.locus.plane import FloatPlace, Place
from contwalk.problems.locus.points.persisting import KIND, NOTE, better, branch_point, persists
from contwalk.problems.locus.points.point import LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Test


class Cusp(LocusPoint):
    """Two branches of folds meet."""

    label, test, of_place = "CP", Test.VALUE, True

    def value(self, problem: Any, sample: Sample) -> float:
        """p.B(q, q) along the curve."""
        place = FloatPlace(problem.plane, problem.in_plane(sample.z))
        return quadratic(place, problem.augmented.told(place, [0.0])[0], 0.0)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The cusp near a sample, or where folds touch a curve of branch points."""
        plane, size = problem.plane, problem.plane.size
        matrix = plane.jacobian(problem.in_plane(sample.z))[:, :size]
        fold = Zero(zero_borders(matrix, sample.weights[:size]))

        def function(place: Place, told: Any, own: Any) -> Any:
            return quadratic(place, fold.told(place, 0.0), 0.0)

        crossing = Augmented(plane, (branch_point(problem, sample),))
        return better(
            sample,
            located_by(problem, problem.augmented, sample, [], quadratic),
            located_by(problem, crossing, sample, [0.0], function),
        )

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient c."""
        numbers = cusp_coefficient(problem.plane, problem.in_plane(located.z))
        return (KIND, None, numbers, NOTE) if persists(located) else (None, None, numbers, None)


def quadratic(place: Place, found: Critical, kappa: Any) -> Any:
    """p.B(q, q)."""
    return found.left[0] @ place.second(found.right[0], found.right[0])
