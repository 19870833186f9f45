"""Points of orbits at which several multipliers pass 1 together (BP), as a symmetry of the field makes them.

L = F_u has a null space of k dimensions. With k borders B and C*, [L B; C* 0] [V; G] = [0; I] is regular, and
G, of shape (k, k), vanishes where L does on that space (W. Govaerts, 2000, chapter 3). The equations are

    F + B m = 0,    C* (u - u_0) = 0,    trace G = 0

with u_0 on the tangent of the branch, which has no part in the null space where a symmetry makes that. Of a
point the unfoldings m are zero, and all of G is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit import branching, variations
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import MEET
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Located, Sample, Seed, Test


class SeveralMultipliers(OrbitPoint):
    """More than two branches may meet there."""

    label, test, singular, daughters, multiplier = "BP", Test.TOGETHER, True, 1, 1.0

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """F_u singular on a space of several dimensions; None where no several multipliers are near one."""
        count = int(np.sum(np.abs(sample.eigenvalues - 1.0) < MEET))
        moves = abs(sample.tangent[-1]) > MEET * sample.weights[-1]
        return _singular_on_space(problem, sample, count) if count > 1 and moves else None

    def tangent(self, problem: OrbitData, located: Located, near: Sample) -> np.ndarray | None:
        """Only continuity tells: that of `near`, shape (N + 1,)."""
        return near.tangent

    def seeds(self, problem: OrbitData, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave along what symmetries keep."""
        return problem.leaving(self, point)

    def branches(self, problem: OrbitData, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that cross. z has the shape (N + 1,)."""
        return branching.crossing(problem, z, point)

    def has(self, point: SpecialPoint) -> bool:
        """A branch point with a multiplicity."""
        return point.label == self.label and "multiplicity" in point.coefficients


def _singular_on_space(problem: OrbitData, near: Sample, count: int) -> Augmented:
    """F_u singular on a space of so many dimensions, near a place."""
    size = problem.size
    rows, columns = problem.equation_scales, near.weights[:size]
    u, _, vh = np.linalg.svd(problem.jacobian(near.z)[:, :size] / rows[:, None] * columns)
    # In bases that are dual to each other, G is what the multipliers are beyond one, and its trace their sum.
    dual = (u[:, -count:] / rows[:, None]).T @ (columns[:, None] * vh[-count:].T)
    borders = u[:, -count:] @ np.linalg.inv(dual / np.linalg.norm(dual)).T, vh[-count:]

    def scaled(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        matrix = there.linearize(z).jacobian[:, :size] / rows[:, None] * columns
        whole = np.block([[matrix, borders[0]], [borders[1], np.zeros((count, count))]])
        factored, unit = there.factored(whole, np.ones(size + count)), np.eye(size + count)[:, size:]
        right, left = factored.solve(unit), factored.solve_adjoint(unit)
        return right[:size] * columns[:, None], left[:size] / rows[:, None], right[size:]

    along = near.tangent[:size] / near.tangent[-1]

    def evaluate(there: OrbitData, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z, unfoldings = y[: size + 1], y[size + 1 :]
        right, left, corner = scaled(there, z)
        lin, added, held = there.linearize(z), borders[0] * rows[:, None], borders[1] / columns
        matrix = np.zeros((size + count + 1, size + count + 1))
        matrix[:size, : size + 1], matrix[:size, size + 1 :] = lin.jacobian, added
        matrix[size:-1, :size], matrix[size:-1, size] = held, -held @ along
        for v, p in zip(right.T, left.T, strict=True):
            matrix[-1, : size + 1] -= p @ variations.derivative_along(there, z, np.append(v, 0.0))
        apart = held @ (z[:size] - near.z[:size] - (z[-1] - near.z[-1]) * along)
        return np.concatenate([lin.residual + added @ unfoldings, apart, [corner.trace()]]), matrix

    def described(found: Located, y: np.ndarray) -> Located | None:
        zeros = np.append(scaled(found.problem, found.z)[2], y[size + 1 :])
        return None if np.abs(zeros).max() > MEET**2 else replace(found, multiplicity=count)

    scale = np.append(near.weights, np.ones(count))
    return Augmented(evaluate, np.append(near.z, np.zeros(count)), scale, described)
