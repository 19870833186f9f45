"""What all special points of curves in two parameters share: how they are located, and the record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import kernel_direction
from contwalk.numerics.refine import Solution
from contwalk.problems.equilibrium.defining_systems import solve
from contwalk.problems.equilibrium.points.point import EquilibriumPoint
from contwalk.problems.locus.conditions import Augmented, Function, defining_system
from contwalk.problems.locus.curves import Curve
from contwalk.problems.locus.persistence import NOTHING
from contwalk.problems.locus.plane import Plane
from contwalk.problems.problem import Located, Sample, Seed

# A kappa this small against where Newton's method began is the double zero, which solves the same equations.
DEGENERATE = 1e-6
# How far from a special point the other curve through it is begun, in typical magnitudes.
BORN_BESIDE = 1e-2


@dataclass(frozen=True)
class ConditionsMet:
    """What a point of a curve was located by: conditions, and their own unknowns there."""

    augmented: Augmented
    own: Sequence[float]


class LocusPoint(EquilibriumPoint):
    """A kind of special point of curves of equilibria."""

    def errors(self, problem: Any, located: Located, sample: Sample) -> dict[str, float]:
        """Estimated errors of both parameters; where nothing else tells them, those of the curve there."""
        if located.errors:
            return dict(located.errors)
        known = np.nan_to_num(sample.error, posinf=1.0) * sample.weights
        first, second = float(located.error), float(max(known[-2], np.spacing(abs(located.z[-2]))))
        return {problem.free: first, str(problem.plane.second): second}


def born(problem: Any, point: SpecialPoint, curve: Curve, own: float = 0.0) -> list[Seed]:
    """The other curve that passes a special point, begun a little beside it: walking back finds the point."""
    other, z = problem.other(curve, np.array(point.unknowns), own)
    there = other.linearize(z)
    if not np.all(np.isfinite(there.jacobian)):
        return []
    return [beside(curve.of, other, z, kernel_direction(there.jacobian, sizes(other, z)))]


def beside(label: str, curve: Any, z: np.ndarray, tangent: np.ndarray) -> Seed:
    """A curve begun a little beside a special point z on it, along a unit tangent; both of shape (N + 1,)."""
    aside = BORN_BESIDE * tangent
    return Seed(label, z + aside, None, None, curve, other_side=z - aside)


def sizes(curve: Any, z: np.ndarray) -> np.ndarray:
    """Typical magnitudes at z on a curve, one where nothing tells, and half their ranges of parameters.

    Both have the shape (N + 1,).
    """
    told, unknown = curve.linearize(z).magnitudes, np.ones(len(z))
    if curve.spans is not None:
        unknown[-2:] = curve.spans
    return np.where(np.isfinite(told) & (told > 0.0), told, unknown)


def located_by(
    problem: Any,
    augmented: Augmented,
    sample: Sample,
    own: Sequence[float],
    function: Function | None = None,
    positive: bool = False,
) -> Located | None:
    """The point near a sample at which conditions hold, with the function of a kind where it has one.

    `own` are the conditions' own unknowns, where Newton's method begins; the curve's is the first of them, if
    it has one and its condition is among these. With `positive` those of pairs belong to frequencies and must
    stay so.
    """
    plane, count = augmented.plane, len(own)
    start = augmented.joined(problem.in_plane(sample.z), own)
    weights = problem.in_plane(sample.weights)
    scale = augmented.joined(weights, _own_scales(augmented, problem.in_plane(sample.z), own))
    system = defining_system(augmented, scale, start, function)
    size = plane.size
    frequencies = [
        k
        for k, condition in enumerate(c for c in augmented.conditions if c.unknowns)
        if positive and condition.unfolding is None
    ]

    def described(found: Solution) -> Located | None:
        values = found.values
        z, there = augmented.split(values)[0], values[size : size + count]
        if not all(there[k] > DEGENERATE * abs(own[k]) for k in frequencies):
            return None
        if not _unfolded(augmented, z, there):
            return None
        errors = {problem.free: float(found.errors[-1]), str(plane.second): float(found.errors[-2])}
        kept = there[: problem.curve.own] if count else np.zeros(problem.curve.own)
        place, met = np.concatenate([z[:size], kept, z[size:]]), ConditionsMet(augmented, there.tolist())
        return Located(place, float(found.errors[-1]), met, found.refined, errors=errors)

    return solve(system, start, described, augmented.unfoldings)


def _unfolding(plane: Plane, z: np.ndarray, condition: Any) -> float:
    """What roundings of the equations at z, shape (N + 2,), could pass for a branch point's unfolding."""
    return float(condition.borders.rounding(plane.linearize(z).levels[0]))


def _own_scales(augmented: Augmented, z: np.ndarray, own: Sequence[float]) -> list[float]:
    """Magnitudes of the conditions' own unknowns."""
    conditions = [condition for condition in augmented.conditions if condition.unknowns]
    return [
        max(abs(value), 1e-300) if condition.unfolding is None else _unfolding(augmented.plane, z, condition)
        for condition, value in zip(conditions, own, strict=True)
    ]


def _unfolded(augmented: Augmented, z: np.ndarray, own: np.ndarray) -> bool:
    """Whether what F is moved by is nothing but rounding at a solution."""
    conditions = [condition for condition in augmented.conditions if condition.unknowns]
    return all(
        condition.unfolding is None or abs(value) <= NOTHING * _unfolding(augmented.plane, z, condition)
        for condition, value in zip(conditions, own, strict=True)
    )
