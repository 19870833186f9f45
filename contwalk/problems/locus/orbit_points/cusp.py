"""Cusps of cycles (CPC), at which the quadratic coefficient of a fold of orbits vanishes."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, where_zero
from contwalk.problems.orbit import normal_forms
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample, Test


class CuspOfCycles(OrbitLocusPoint):
    """Two branches of folds meet."""

    label, test, of_place, of_regular = "CPC", Test.VALUE, True, True

    def value(self, problem: Any, sample: Sample) -> float:
        """psi F_uu v v along the curve."""
        return quadratic(problem, sample.z)

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The fold at which it vanishes."""
        return where_zero(sample, problem, quadratic)

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The cubic coefficient."""
        there, own = problem.plane.first(located.z)
        return None, normal_forms.cusp(there.return_map(own)), None


def quadratic(problem: Any, z: np.ndarray) -> float:
    """psi F_uu v v with the vectors of the fold's bordered matrix.

    z has the shape (N + k + 2,).
    """
    there, own = problem.plane.first(z)
    fold = problem.condition.system
    v = fold.critical(there, own)
    return float(fold.evaluate(there, own)[1][-1, : len(v)] @ v)
