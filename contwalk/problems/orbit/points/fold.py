"""Folds of orbits (LP): F_u is singular.

In an explosion of cycles the parameter stands still to the errors of the steps, and F_u is singular all
along to the same errors. A multiplier that passes one tells the fold from its neighbours: the point is then
the solution of F = 0 and that multiplier = 1, along the branch.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.orbit import normal_forms, scales, variations
from contwalk.problems.orbit.augmented import Augmented, Near
from contwalk.problems.orbit.critical_along import along_branch
from contwalk.problems.orbit.null_vectors import bordered, critical_vectors
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import Form
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Located, Sample, Test


class FlatFold(OrbitPoint):
    """A fold where the parameter stands still."""

    label, test, changes, multiplier = "LP", Test.TURN, (-1, 1), 1.0

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """A real multiplier at one."""
        return along_branch(problem, sample, self.multiplier)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """The coefficients of the return map's normal form."""
        return None, None, normal_forms.fold(problem.return_map(located.z)), None


class Fold(FlatFold):
    """The branch turns back in the parameter."""

    flat = (FlatFold(),)

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """F_u singular."""
        return fold_system(problem, sample)


def fold_system(problem: OrbitData, near: Near) -> Augmented:
    """F_u singular, near a place."""
    size = problem.size
    rows, columns = scales.equation_scales(problem, near.weights), near.weights[:size]
    b, c = critical_vectors(problem, problem.jacobian(near.z)[:, :size] / rows[:, None] * columns)

    def scaled(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        jacobian = there.linearize(z).jacobian
        v, psi, g = bordered(there, jacobian[:, :size] / rows[:, None] * columns, b, c)
        return v * columns, psi / rows, float(g.real)

    def evaluate(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, psi, g = scaled(there, z)
        return there.linearize(z).with_row(g, -psi @ variations.derivative_along(there, z, np.append(v, 0.0)))

    def in_plane(
        there: OrbitData, across: OrbitData, z: np.ndarray, second: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        v, psi, g = scaled(there, z)
        found = there.linearize(z).with_row(
            g, -psi @ variations.derivative_along(there, z, np.append(v, 0.0))
        )
        place = np.append(z[:size], second)
        return *found, np.concatenate(variations.by_parameter(across, place, psi[None, None], [v]))

    def critical(there: OrbitData, z: np.ndarray) -> np.ndarray:
        return scaled(there, z)[0]

    def described(found: Located, z: np.ndarray) -> Located:
        return replace(found, critical=critical(found.problem, z))

    return Augmented(evaluate, near.z, near.weights, described, in_plane=in_plane, critical=critical)
