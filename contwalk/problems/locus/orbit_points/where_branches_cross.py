"""Points of curves of orbits at which a branch point that persists is passed.

On an invariant face, or with a symmetry, branches cross at all values of both parameters. Where the orbits of
a curve are such a branch point the curve of the other branch passes as well: the curve's equations are
singular, as those of a fold there are. With the branch point's own condition, and F + mu b for F, they are
regular; where there is no branch point mu is not zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_places import Held
from contwalk.problems.locus.orbit_points.crossing import Crossing
from contwalk.problems.locus.orbit_points.point import Form, OrbitLocusPoint, known_to, together
from contwalk.problems.locus.orbit_points.switching import (
    born,
    both_born,
    crossing_born,
    ones_born,
    second_cosine,
)
from contwalk.problems.locus.orbit_points.two_at_once import BRANCH_POINT, TwoAtOnce
from contwalk.problems.locus.persistence import unfolds
from contwalk.problems.locus.valued_curves import BranchPoints, steepest_crossing
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.problem import Located, Sample, Seed

NOTE = "the multiplier one is that of a branch point that persists, not of a fold"


class WhereBranchesCross(Crossing):
    """The curve of the other branch crosses at a branch point that persists.

    Parameters
    ----------
    both : str
        What a point is told as that is of the curve and a branch point: `LPPD` on curves of doublings.
    """

    def __init__(self, both: str) -> None:
        self._both = both

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The curve's condition and that of a branch point, with the unknown that unfolds it."""
        _, own = problem.plane.first(sample.z)
        weights = problem.of_orbit(sample.weights)
        near = At(own, weights, float(sample.weights[-2]), problem.plane, float(sample.z[-2]))
        crossing = steepest_crossing(near)
        column, width = crossing.unfolding[:, 0], len(sample.z)
        held = [problem.condition, Held(crossing, np.array([width]))]
        system = together(problem, sample, held, np.zeros(1))

        def described(found: Located, y: np.ndarray) -> Located | None:
            moved = found.refined and unfolds(found.problem.plane, y[:width], float(y[width]) * column)
            return None if moved else found

        return replace(system, described=described)

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The branch point of the curve near a sample; none where the equations would have to be others."""
        return OrbitLocusPoint.locate(self, problem, sample, which)

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """That of the curve beside the point: at it two curves pass.

        Shape (N + k + 2,).
        """
        return near.tangent

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of the other branch, and that of the branch points themselves."""
        points = ones_born(problem, point) if point.label == self._both and point.kind == BRANCH_POINT else []
        return [*crossing_born(problem, point), *points]

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of the point by the name that it has as one of both curves.

        Where a pair that the curve holds is at one itself, no other multiplier is: two curves cross there.
        """
        record, held = super().describe(problem, located, sample, s), problem.further(located.z)
        if len(held) and float(held[0]) >= 1.0 - known_to(problem):
            return record
        return replace(record, label=self._both, kind=BRANCH_POINT, note=NOTE)

    def has(self, point: SpecialPoint) -> bool:
        """A crossing, told as one or as the point that it is."""
        return super().has(point) or (point.label == self._both and point.kind == BRANCH_POINT)


class OnBranchPoints(TwoAtOnce):
    """On a curve of branch points that persist a doubling or a torus is passed, of both branches."""

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A multiplier as the other curve holds it, of orbits that are no half of symmetric ones."""
        return isinstance(problem.curve, BranchPoints) and super().tells(problem, sample, which)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curves of both branches."""
        cosine = second_cosine(point, None) if self.other == "NS" else None
        return both_born(problem, point, self.other, cosine)

    def has(self, point: SpecialPoint) -> bool:
        """Such a point."""
        return point.label == self.label and point.kind == BRANCH_POINT

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The kind: the multiplier one is no fold's."""
        return BRANCH_POINT, {}, NOTE


class R1OnBranchPoints(OnBranchPoints):
    """On a curve of branch points that persist a second multiplier is one, where tori come to it."""

    def __init__(self) -> None:
        super().__init__("R1", "NS")
        self.changes = (-1, 1)  # type: ignore[misc]

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real positive multiplier."""
        value = sample.eigenvalues[which]
        return isinstance(problem.curve, BranchPoints) and value.imag == 0.0 and value.real > 0.0

    def system(self, problem: Any, sample: Sample, which: int) -> Augmented | None:
        """The curve's equations, and a pair of multipliers whose product is one, as on curves of tori."""
        return self.both(problem, sample)

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """One."""
        return complex(1.0)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of tori, and of the neutral saddles that they become."""
        return born(problem, point, "NS", 1.0)

    def has(self, point: SpecialPoint) -> bool:
        """Such a point."""
        return point.label == self.label

    def form(self, problem: Any, located: Located, sample: Sample) -> Form:
        """The coefficients."""
        return OrbitLocusPoint.form(self, problem, located, sample)
