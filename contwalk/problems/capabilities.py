"""What problems are asked beside their equations, each for one purpose.

A problem answers with an object that has these members; where its own class has them, that is the problem
itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Protocol, Self

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.problems.kink import Kink, Met
from contwalk.problems.located import Located
from contwalk.problems.parents import gained_symmetry, kept_symmetry
from contwalk.problems.sample import Sample


class OwnMeasures:
    """The part of a problem that measures and compares its solutions itself."""

    @property
    def observed(self) -> Self:
        """It measures its solutions itself."""
        return self

    @property
    def equivalence(self) -> Self:
        """It compares its solutions itself."""
        return self

    def asymmetries(self, z: np.ndarray) -> Mapping[str, float]:
        """How far a solution, shape (N + 1,), is from symmetries that a parent of its branch may have.

        In units of its own range, by name: none are known.
        """
        return {}

    def gains_symmetry(self, a: np.ndarray, b: np.ndarray) -> bool:
        """Whether the second of two neighbours, shape (N + 1,), has a symmetry that the first has not."""
        return gained_symmetry(lambda: self.asymmetries(a), lambda: self.asymmetries(b))

    def keeps_symmetry(self, point: np.ndarray, guess: np.ndarray, z: np.ndarray) -> bool:
        """Whether a solution beside a branch point has a symmetry that the guess of it has not, or neither is
        told from the point.

        All have the shape (N + 1,).
        """
        return kept_symmetry(*(partial(self.asymmetries, each) for each in (point, guess, z)))


class OwnPlace:
    """The part of a problem whose equations are made for a place, and that makes them anew itself."""

    @property
    def anchored(self) -> Self:
        """An instance is one mesh, or has borders of one place."""
        return self


class OwnMesh(OwnPlace):
    """The part of a problem that is its own discretisation."""

    @property
    def meshed(self) -> Self:
        """An instance is one discretisation."""
        return self


class Observed(Protocol):
    """What is measured of solutions."""

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Names of the observables, in the order of `Sample.observables`."""

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state that stands for a solution, shape (n,)."""

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""


class Diagnosis(Protocol):
    """What is known of places where a branch ends, or cannot go on: nothing but what a class tells itself."""

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring solutions, if it does."""

    def end_functions(self, sample: Sample) -> tuple[float, ...]:
        """Functions that are positive beyond an end that `ended` tells, whose zeros are the end; none where
        the end is no place on the branch.
        """
        return ()

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z is not finite. z has the shape (N + 1,)."""

    def obstacle(self, z: np.ndarray) -> str:
        """What makes solutions beside z hard to find, and what helps; empty if nothing is known of that.

        z has the shape (N + 1,).
        """
        return ""

    def growth(self, z: np.ndarray) -> str:
        """By how much deviations grow where that makes steps short, and what helps; empty where they do not.

        z has the shape (N + 1,).
        """
        return ""

    def passed(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """Where the equations change their piece on the straight way from a solution to another z, which
        need not be one, in their order: what no solution tells of itself, and where a branch may end.

        Both have the shape (N + 1,).
        """

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Where the equations are smooth by pieces only: between two solutions, or on the second one."""
        return b.kinks

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding. z has the shape (N + 1,)."""
        return False


class Equivalence(Protocol):
    """Which solutions are one, or images of each other."""

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        All have the shape (N + 1,).
        """

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one."""

    def asymmetries(self, z: np.ndarray) -> Mapping[str, float]:
        """How far a solution, shape (N + 1,), is from symmetries that a parent of its branch may have.

        In units of its own range, by name.
        """

    def gains_symmetry(self, a: np.ndarray, b: np.ndarray) -> bool:
        """Whether the second of two neighbours, shape (N + 1,), has a symmetry that the first has not.

        Then a step from one to the other has gone over to the branch that theirs left.
        """

    def keeps_symmetry(self, point: np.ndarray, guess: np.ndarray, z: np.ndarray) -> bool:
        """Whether a solution beside a branch point has a symmetry that the guess of it has not, or neither is
        told from the point.

        Then the first step of a branch has not left its parent. All have the shape (N + 1,).
        """

    def mirror(self, sample: Sample) -> Mirror | None:
        """What takes one half of the branch that leaves a solution to the other, if a symmetry does."""


class Mirror(Protocol):
    """What takes one half of a branch to the other, where they are images of each other under symmetries."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself; empty where it has not."""

    def row(self, row: np.void, before: np.void, last: np.void) -> np.ndarray | None:
        """The stored image of a stored solution, shape (1,); None if it does not solve the equations.

        `before` is the regular row from which the walk stepped to it, and `last` that row's image.
        """

    def sample(self, row: np.void) -> Sample:
        """Place and metric of a stored solution, as a sample that tells no more."""

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name."""

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point, whose row is given; `last` as of `row`."""
