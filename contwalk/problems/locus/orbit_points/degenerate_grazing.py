"""Grazings whose second rate vanishes (GRD): cusps of curves of grazings.

A guard that touches zero from above has a second derivative there that is positive. Where that vanishes the
least value merges with a greatest one, the instant of the touch turns while both parameters stand still, and
what goes on is the curve of orbits that touch from below: two curves of grazings meet in a cusp.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.problems.hybrid import limit_equations
from contwalk.problems.hybrid.limits import transition_of
from contwalk.problems.hybrid.soft_equations import SoftEquations
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.point import OrbitLocusPoint
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Sample, Test

# Limits at which a guard is zero together with its rate.
TOUCHING = ("dip", "rate")


class DegenerateGrazing(OrbitLocusPoint):
    """The second derivative of the guard that grazes vanishes."""

    label, test, of_place = "GRD", Test.VALUE, True

    def value(self, problem: Any, sample: Sample) -> float:
        """The second derivative of the guard over the leg's own time; NaN where there is none.

        Of other limits, of orbits through soft transitions, and of guards whose graph is too large, nothing
        is told.
        """
        limit = problem.curve.limit
        if limit.test not in TOUCHING or isinstance(problem.orbit, SoftEquations):
            return float("nan")
        there, own = problem.plane.first(sample.z)
        view = there.view(own)[limit.leg]
        try:
            map_ = view.piece.passage.guard_derivative(transition_of(there, limit), 2)
        except UnsupportedOperation:
            return float("nan")
        share = _share(problem, sample.z)
        x = view.end if share == 1.0 else view.stepped(share)
        return float(map_(share, x, map_.constants(view.piece.values(view.scalars)))[0])

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The curve's equations, and that derivative."""
        limit, share, n = problem.curve.limit, _share(problem, sample.z), problem.plane.size
        further = np.arange(n, n + problem.curve.further)

        def second(orbit: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return limit_equations.second_rate(orbit, limit, y, share)

        held = Held(Augmented(second, sample.z, sample.weights), further)
        places = [*range(n), len(sample.z) - 2, len(sample.z) - 1]

        def evaluate(there: Any, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            row = np.zeros((1, len(y)))
            value, row[:, places], row[:, further] = held.over(there.plane, y, y[further])
            return there.linearize(y).with_row(value, row)

        return Augmented(evaluate, sample.z, sample.weights, in_units=True)


def _share(problem: Any, z: np.ndarray) -> float:
    """Where on its leg a guard touches zero, 0..1."""
    limit = problem.curve.limit
    if limit.test != "dip":
        return 1.0
    return float(problem.further(z)[0] / z[problem.orbit.layout.durations][limit.leg])
