"""Points that the user asks for (UZ), and the ends of curves (EP)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.conditions import Augmented, Level, ParameterAt
from contwalk.problems.locus.plane import Place
from contwalk.problems.locus.points.corner import beyond_corner
from contwalk.problems.locus.points.point import LocusPoint, located_by
from contwalk.problems.problem import Located, Sample, Seed, Test
from contwalk.quantities import FREQUENCY_SQUARED


class MarkedValue(LocusPoint):
    """A parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(LocusPoint):
    """The curve ends."""

    label, test = "EP", Test.END

    def goes_on(self, point: SpecialPoint) -> bool:
        """Whether another eigenvalue may have taken over there what is marked."""
        return point.kind == "stop_at"

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of the eigenvalue that has the largest real part from there on."""
        return beyond_corner(problem, point)


def marked_on(problem: Any, name: str, level: float, sample: Sample) -> Located | None:
    """The point of a curve near a sample at which an observable or a free parameter has a value."""
    own = [problem.own(sample.z)] * problem.curve.own
    if name == FREQUENCY_SQUARED:

        def beyond(place: Place, told: Any, kappa: Any) -> Any:
            return kappa - level

        return located_by(problem, problem.augmented, sample, own, beyond)
    names = problem.line.names
    mark = ParameterAt(-1 - names.index(name), level) if name in names else Level(name, level)
    augmented = Augmented(problem.plane, (*problem.augmented.conditions, mark))
    return located_by(problem, augmented, sample, own)
