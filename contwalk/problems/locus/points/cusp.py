"""Cusps (CP), at which the quadratic coefficient of a fold vanishes: p.B(q, q) = 0."""

from __future__ import annotations

from typing import Any

from contwalk.branch import Outcome
from contwalk.problems.equilibrium.points.point import Form
from contwalk.problems.locus.normal_forms import cusp_coefficient
from contwalk.problems.locus.persistence import place_of
from contwalk.problems.locus.plane import FloatPlace
from contwalk.problems.locus.points.degenerate_crossing import form_of, is_pitchfork, quadratic, touched
from contwalk.problems.locus.points.persisting import better, persists
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
        found = located_by(problem, problem.augmented, sample, [], quadratic)
        return better(sample, found, touched(problem, sample))

    def ends_ahead(self, problem: Any, sample: Sample) -> tuple[Located, Outcome] | None:
        """Where folds come to pitchforks: both parameters turn there, back along the same curve."""
        found = touched(problem, sample)
        settled = None if found is None or not is_pitchfork(problem, found, sample) else found.settled()
        if settled is None:
            return None
        end = Outcome(
            "complete",
            "rejoined",
            f"The folds become pitchforks near {place_of(problem, settled.z, 6)}: what follows are their "
            "mirror images, at the same parameters. Nothing to do.",
        )
        return settled, end

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient c."""
        if persists(located):
            return form_of(problem, located, sample)
        return None, None, cusp_coefficient(problem.plane, problem.in_plane(located.z)), None
