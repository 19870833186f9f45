"""Branch points of orbits (BP): [F_u F_lambda], bordered by two rows, is singular.

A further unknown is an unfolding mu b of F, which is zero where the point is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.orbit import branching, normal_forms, variations
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.null_vectors import critical_vectors
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.point_records import PAIR, Form, criticality_of, known, negligible
from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Located, Sample, Seed, Test

BRANCHING = ("c11", "c12", "c22", "c")
UP_TO_A_FACTOR = (
    "return map minus identity; c11 s^2 + 2 c12 s t + c22 t^2 = 0 for the directions s q + t h, and the "
    "cubic c, up to a common factor: p.q is zero where a pair of multipliers meets"
)
FALLEN_BACK = "the orbit repeats itself here, or is its own image: the branch ends on it"


class BranchPoint(OrbitPoint):
    """Another branch passes, or the orbit is its parent again."""

    label, test, changes, singular, daughters = "BP", Test.ORIENTATION, (-1, 0, 1), True, 1
    multiplier = 1.0

    def system(self, problem: OrbitData, sample: Sample, which: int) -> Augmented | None:
        """[F_u F_lambda] of deficient rank."""
        return _crossing(problem, sample)

    def tangent(self, problem: OrbitData, located: Located, near: Sample) -> np.ndarray | None:
        """Of the two tangents there, that of the branch that `near` is on. Shape (N + 1,)."""
        return problem.tangent_at(located, near)

    def form(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """Transcritical or a pitchfork, and to which side that opens."""
        return _branch_point(problem, located, sample)

    def form_of_pair(self, problem: OrbitData, located: Located, sample: Sample) -> Form:
        """As `form`; coefficients up to a common factor, and no criticality."""
        if located.returned_to_parent:
            return None, None, {}, PAIR
        c = normal_forms.branch_point(problem.return_map(located.z), float(sample.weights[-1]))
        largest = max(abs(c[name]) for name in BRANCHING)
        coefficients = {name: c[name] / largest for name in BRANCHING} | {"convention": UP_TO_A_FACTOR}
        return ("transcritical" if c["c11"] != 0.0 else "pitchfork"), None, coefficients, PAIR

    def seeds(self, problem: OrbitData, point: SpecialPoint) -> Sequence[Seed]:
        """The branch that crosses, if the orbit is not its parent again."""
        return problem.leaving(self, point) if point.coefficients else ()

    def branches(self, problem: OrbitData, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The branch that crosses. z has the shape (N + 1,)."""
        return branching.crossing(problem, z, point)

    def has(self, point: SpecialPoint) -> bool:
        """A branch point at which no symmetry is lost by a multiplier of -1."""
        return point.label == self.label and point.kind != "symmetry-breaking"


def _branch_point(problem: OrbitData, located: Located, sample: Sample) -> Form:
    weight = float(sample.weights[-1])
    c = known(problem, located, sample, "c", lambda map_: normal_forms.branch_point(map_, weight))
    if c["c11"] != 0.0 and not located.returned_to_parent:
        return "transcritical", None, c, None
    criticality, vanishes = criticality_of(c["c"], c.get("c_error"), negligible(problem, located, 1.0))
    if located.returned_to_parent:  # what leaves here the parent's own point tells, with its coefficients
        return "pitchfork", criticality, {}, "; ".join(filter(None, (FALLEN_BACK, vanishes)))
    return "pitchfork", criticality, c, vanishes


def _crossing(problem: OrbitData, sample: Sample) -> Augmented:
    """[F_u F_lambda] of deficient rank: another branch passes."""
    size = problem.size
    rows, columns = problem.equation_scales, sample.weights
    own = sample.tangent / columns
    start = np.vstack([problem.jacobian(sample.z) / rows[:, None] * columns, own / np.linalg.norm(own)])
    left, other = critical_vectors(problem, start)
    b = left[:size] / np.linalg.norm(left[:size])
    c = np.linalg.qr(np.column_stack([own, other]))[0].T  # the plane of this branch and the other one

    def scaled(there: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        jacobian = there.linearize(z).jacobian
        whole = np.zeros((size + 2, size + 2))
        whole[:size, : size + 1] = jacobian / rows[:, None] * columns
        whole[:size, -1], whole[size:, : size + 1] = b, c
        factored = there.factored(whole, np.ones(size + 2))
        right = factored.solve(np.eye(size + 2)[:, size:])
        left = factored.solve_adjoint(np.eye(size + 2)[:, -1])
        return (right[: size + 1] * columns[:, None]).T, left[:size] / rows, left[size:], jacobian

    def evaluate(there: OrbitData, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z, mu = y[: size + 1], y[-1]
        vs, psi, g, jacobian = scaled(there, z)
        matrix = np.zeros((size + 2, size + 2))
        matrix[:size, : size + 1], matrix[:size, -1] = jacobian, b * rows
        for k in range(2):
            matrix[size + k, : size + 1] = psi @ variations.derivative_along(there, z, vs[k])
        residual = there.linearize(z).residual + mu * b * rows
        return np.concatenate([residual, -g]), matrix

    def described(found: Located, y: np.ndarray) -> Located:
        there, z = found.problem, found.z
        vs, psi, _, _ = scaled(there, z)
        back = found.refined and there.returned_to_parent(z, sample.tangent)
        return replace(found, data=branching.NullVectors(vs, psi), returned_to_parent=back)

    return Augmented(evaluate, np.append(sample.z, 0.0), np.append(sample.weights, 1.0), described)
