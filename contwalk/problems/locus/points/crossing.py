"""Points at which another curve of the same kind crosses (BP): the equations G of the curve are singular.

G + mu b = 0 with both corners of the bordered DG zero (Moore 1980, Numer. Funct. Anal. Optim. 2, 441, by
borders); mu is zero where it is one. Second derivatives of G are differences of DG along the null vectors:
they steer Newton's method and tell tangents, and have no part in where the point is, for G and DG are
evaluated with as many digits as it takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import EPSILON
from contwalk.numerics.refine import DefiningSystem, Solution
from contwalk.problems.equilibrium.defining_systems import solve
from contwalk.problems.locus.bordered import CrossingBorders, Deficient, crossing_borders, deficient
from contwalk.problems.locus.conditions import BESIDE
from contwalk.problems.locus.curves import Curve
from contwalk.problems.locus.plane import solver_of_floats
from contwalk.problems.locus.points.point import NOTHING, LocusPoint, beside, born, sizes
from contwalk.problems.problem import Located, Sample, Seed, Test

# What differences of slopes leave of a coefficient that is zero.
FAINT = 1e-6
# The corners of the bordered equations, in their units, below which a point that is located is a crossing.
SINGULAR = 1e-6
# A kappa this small, in the metric, is that of a pair zero.
ROUNDED = 1e-6
NO_DOUBLE_ZERO = "no normal form: that of Bogdanov-Takens points is not the one at branch points"


class Crossing(LocusPoint):
    """Two curves of one kind cross."""

    label, test, changes, singular, daughters = "BP", Test.ORIENTATION, (-1, 0, 1), True, 1

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The crossing near a sample."""
        return _Singular(problem, sample.z, sample.weights).located(sample.z)

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """Of the two tangents there that of the curve that `near` is on, shape (N + 1,)."""
        found = _most_singular(problem, located.z, near.weights).directions()
        if not found:
            return near.tangent
        products = [float((t / near.weights) @ (near.tangent / near.weights)) for t in found]
        best = int(np.argmax(np.abs(products)))
        return found[best] * (np.sign(products[best]) or 1.0)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve that crosses, along the tangent that this one does not have."""
        z = _place(point, (str(problem.plane.second), problem.free))
        there = problem.at(z)
        weights = sizes(there, z)
        found = _most_singular(there, z, weights).directions()
        if len(found) < 2:
            return ()
        parent = np.array(point.tangent) / weights
        parent = parent / np.linalg.norm(parent)
        other = min(found, key=lambda t: abs(float((t / weights) @ parent)))
        return (beside("BP", there, z, other),)


def at_zero(problem: Any, found: Located, sample: Sample) -> bool:
    """Whether the pair of a curve of Hopf points is zero at a point located near a sample."""
    size = problem.plane.size
    return abs(float(found.z[size])) <= ROUNDED * float(sample.weights[size])


def _place(point: SpecialPoint, names: Sequence[str]) -> np.ndarray:
    """The unknowns of a point, shape (M + 1,), whose last ones are parameters of these names.

    A parameter that is zero to its error is zero: rounding is no typical magnitude.
    """
    z = np.array(point.unknowns)
    known_to = np.array([point.errors.get(name, 0.0) for name in names])
    z[-len(names) :][np.abs(z[-len(names) :]) <= known_to] = 0.0
    return z


def both_born(problem: Any, point: SpecialPoint, curve: Curve, own: float = 0.0) -> list[Seed]:
    """The other curve through a special point, or both where two of that kind cross there.

    Between these a direction that solves the linear equations leads to either, and right beside the point.
    """
    other, z = problem.other(curve, np.array(point.unknowns), own)
    if not np.all(np.isfinite(other.linearize(z).jacobian)):
        return []
    singular = _most_singular(other, z, sizes(other, z))
    found = singular.directions() if singular.missed < SINGULAR else []
    return [beside(curve.of, other, z, t) for t in found] or born(problem, point, curve, own)


def located_by_units(problem: Any, sample: Sample) -> Located | None:
    """The crossing near a sample, where an equation whose terms all vanish counts by its units.

    By its rounding it would count more than all others just beside such a place.
    """
    return _Singular(problem, sample.z, sample.weights, sample.weights[:-1]).located(sample.z)


def _most_singular(problem: Any, z: np.ndarray, weights: np.ndarray) -> _Singular:
    """The equations at a crossing, by their rounding or by their units: as it is one by.

    z and the weights have the shape (M + 1,). An equation whose terms all but vanish there has next to no
    rounding, and by it hides that the others are singular.
    """
    each = (_Singular(problem, z, weights), _Singular(problem, z, weights, weights[:-1]))
    return min(each, key=lambda singular: singular.missed)


@dataclass(frozen=True)
class _Singular:
    """The equations of a curve at and near a place where they are singular.

    z and the weights have the shape (M + 1,) for M equations G. `rows` are magnitudes of these, shape (M,);
    without, their rounding tells them.
    """

    problem: Any
    z: np.ndarray
    weights: np.ndarray
    rows: np.ndarray | None = None

    @cached_property
    def _levels(self) -> np.ndarray:
        """Rounding of the equations, shape (M,)."""
        levels = self.problem.linearize(self.z).levels[0]
        return np.asarray(levels)

    @cached_property
    def borders(self) -> CrossingBorders:
        """Of DG."""
        rows = self._levels / EPSILON if self.rows is None else self.rows
        return crossing_borders(self._slopes(self.z), rows, self.weights)

    def _slopes(self, u: np.ndarray) -> np.ndarray:
        """DG, shape (M, M + 1)."""
        slopes: np.ndarray = self.problem.augmented.values(u)[1]
        return slopes

    def _deficient(self, u: np.ndarray) -> Deficient:
        return deficient(self._slopes(u), self.borders, solver_of_floats)

    def _second(self, u: np.ndarray, left: np.ndarray, q: np.ndarray) -> np.ndarray:
        """left . D2G(q, .), shape (M + 1,)."""
        step = BESIDE / float(np.linalg.norm(q / self.weights))
        ahead, behind = (self._slopes(u + sign * step * q) for sign in (1.0, -1.0))
        return np.asarray(left @ (ahead - behind) / (2.0 * step))

    def located(self, start: np.ndarray) -> Located | None:
        """The crossing near a place, shape (M + 1,)."""
        augmented, borders = self.problem.augmented, self.borders
        column, size = borders.column, len(self._levels)
        some = column != 0.0
        unfolding = float(np.max(self._levels[some] / np.abs(column[some])))

        def residual(v: np.ndarray) -> np.ndarray:
            u, mu = v[:-1], v[-1]
            return np.concatenate([augmented.values(u)[0] + mu * column, self._deficient(u).values])

        def jacobian(v: np.ndarray) -> np.ndarray:
            u = v[:-1]
            found = self._deficient(u)
            matrix = np.zeros((size + 2, size + 2))
            matrix[:size, :-1], matrix[:size, -1] = self._slopes(u), column
            matrix[size:, :-1] = [-self._second(u, found.left, q) for q in found.right]
            return matrix

        def exactly(v: Sequence[Any]) -> list[Any]:
            values, place, told, owns = augmented.exactly(v[:-1])
            slopes = augmented.jacobian(place, told, owns)
            moved = [a + float(b) * v[-1] for a, b in zip(values, column, strict=True)]
            return [*moved, *deficient(slopes, borders, place.solver).values]

        def described(found: Solution) -> Located | None:
            if not abs(found.values[-1]) <= NOTHING * unfolding:
                return None
            names = self.problem.free, str(self.problem.plane.second)
            errors = {name: float(found.errors[-2 - k]) for k, name in enumerate(names)}
            return Located(found.values[:-1], float(found.errors[-2]), refined=found.refined, errors=errors)

        scale = np.append(self.weights, max(unfolding, 1e-300))
        system = DefiningSystem(scale, residual, jacobian, exactly)
        return solve(system, np.append(start, 0.0), described, unfoldings=(-1,))

    @property
    def missed(self) -> float:
        """How far the equations are from being singular; infinite where that cannot be told."""
        try:
            return float(np.max(np.abs(self._deficient(self.z).values)))
        except np.linalg.LinAlgError:
            return float("inf")

    def directions(self) -> list[np.ndarray]:
        """Tangents of the two curves through the crossing, shape (M + 1,), units in the metric; or none."""
        try:
            found = self._deficient(self.z)
        except np.linalg.LinAlgError:
            return []
        basis = np.linalg.qr(np.column_stack(found.right) / self.weights[:, None])[0] * self.weights[:, None]
        t1, t2 = basis.T
        first, second = (self._second(self.z, found.left, t) for t in (t1, t2))
        form = np.array([[first @ t1, first @ t2], [first @ t2, second @ t2]])
        values, vectors = np.linalg.eigh(form)
        # Of a form with a root that is as good as double the two directions are not told apart.
        if not (values[0] < 0.0 < values[1]) or min(abs(values)) < FAINT * max(abs(values)):
            return []
        tangents = []
        for sign in (1.0, -1.0):
            x, y = np.sqrt(values[1]) * vectors[:, 0] + sign * np.sqrt(-values[0]) * vectors[:, 1]
            t = x * t1 + y * t2
            tangents.append(t / np.linalg.norm(t / self.weights))
        return tangents
