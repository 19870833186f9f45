"""What the continuation engine sees of a problem.

Rules
-----
1. `z` is a vector of N unknowns with the free parameter last.
2. `linearize(z)` gives residual, exact Jacobian and the rounding level of each equation.
3. `examine` computes everything that is stored or watched at a solution, once.
4. `point_types` are the kinds of special points that its branches have. Each says what tells it (`Test`), and
   has its defining system, its normal form, and the branches that leave.
5. What only some problems have is an object of its own (`meshed`, `limited`), None for the others: nobody
   has to refuse a member. What is asked for one purpose is one too (`capabilities`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.errors import NotFinite
from contwalk.problems.capabilities import Diagnosis, Equivalence, Mirror, Observed
from contwalk.problems.linearization import Linearization
from contwalk.problems.located import Located
from contwalk.problems.parameter_line import ParameterLine
from contwalk.problems.point_test import Test
from contwalk.problems.sample import Sample
from contwalk.system.special_points import KindOfPoint

__all__ = [
    "MAX_ABS",
    "MAX_RE",
    "Anchored",
    "Diagnosis",
    "Equivalence",
    "Limit",
    "LimitType",
    "Limited",
    "Linearization",
    "Located",
    "Meshed",
    "Mirror",
    "Observed",
    "PointType",
    "Problem",
    "Sample",
    "Seed",
    "Test",
    "at_stored",
    "equations_at",
    "finest",
    "refined",
]

# Observables that every problem has: the largest real part of an equilibrium, the largest modulus of an
# orbit.
MAX_RE, MAX_ABS = "max_re", "max_abs"


@dataclass(frozen=True)
class Seed:
    """A branch that leaves a special point: a solution on it (or the point itself) and its direction.

    Without a direction (`tangent` None) it is a guess of a solution, and regular there.

    `reach(change)` estimates how far each unknown moves along it while the parameter changes so much, shape
    (N + 1,), for unknowns that are zero at the point. `problem` is whose solutions they are. `one_sided`:
    the other direction leads to the same solutions once more. `other_side` is a place as good to begin at, on
    the other side of the point: one of both may be out of the range.
    """

    label: str
    z: np.ndarray
    tangent: np.ndarray | None
    reach: Callable[[float], np.ndarray] | None
    problem: Problem
    one_sided: bool = False
    other_side: np.ndarray | None = None


class PointType(KindOfPoint):
    """A kind of special point; one object serves all problems of a class.

    Attributes
    ----------
    test : Test
    changes : tuple of int
        Changes of the unstable count that a point of this kind can bring about.
    singular, of_regular : bool
        Whether the equations are singular there, and tell no error; whether there is none where they are.
    flat : tuple of PointType
        What else is tried where the parameter stands still, to the errors of the equations.
    along : bool
        Whether it is located along the branch, where `value` passes zero: its equations are singular there.
    births : bool
        Whether orbits are born there on a branch of equilibria.
    daughters : int, optional
        How many branches leave, where it is the same number always.
    told : bool
        Whether it is special; what only changes the unstable count is not.
    saddles : bool
        Whether a curve of Hopf points goes on as neutral saddles beyond.
    of_place, dear : bool
        Whether `value` asks of a sample nothing but z and tangent, and then costs as much as a solution.
    """

    test: ClassVar[Test]
    changes: ClassVar[tuple[int, ...]] = (0,)
    singular: ClassVar[bool] = False
    of_regular: ClassVar[bool] = False
    flat: ClassVar[tuple[PointType, ...]] = ()
    along: ClassVar[bool] = False
    births: ClassVar[bool] = False
    daughters: ClassVar[int | None] = None
    told: ClassVar[bool] = True
    saddles: ClassVar[bool] = False
    of_place: ClassVar[bool] = False
    dear: ClassVar[bool] = False

    def value(self, problem: Any, sample: Sample) -> float:
        """The function that passes zero at such points, where `test` is `Test.VALUE`, or `along`."""
        raise NotImplementedError(f"points {self.label} have no test function of their own")

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """Whether stability measure `which` passes zero at a point of this kind, if `test` is STABILITY."""
        return False

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """The point near a sample, by its defining system; `which` is the number of the measure or margin."""
        return None

    def at_level(self, problem: Any, sample: Sample, which: int, level: float) -> Located | None:
        """The solution near a sample at which measure `which` has a level that is not zero."""
        return None

    def tangent(self, problem: Any, located: Located, near: Sample) -> np.ndarray | None:
        """Tangent there of the branch that `near` is on, where DF alone does not determine it; else None."""
        return None

    def held_beside(self, problem: Any, sample: Sample) -> tuple[int, int]:
        """How many eigenvalues that the curve itself holds are unstable before a point, and after it."""
        return sample.held_unstable, sample.held_unstable

    def describe(self, problem: Any, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        raise NotImplementedError(f"points {self.label} have no record")

    def seeds(self, problem: Any, point: SpecialPoint) -> Iterable[Seed]:
        """The branches that leave a stored point."""
        return ()

    def has(self, point: SpecialPoint) -> bool:
        """Whether a stored point is of this kind."""
        return point.label == self.label

    def goes_on(self, point: SpecialPoint) -> bool:
        """Whether what leaves a stored point is the same in other unknowns: it is always followed."""
        return False

    def critical(self, point: SpecialPoint, sample: Sample) -> complex:
        """The eigenvalue that is critical at a stored point."""
        return complex(sample.critical)

    def ends_ahead(self, problem: Any, sample: Sample) -> tuple[Located, Outcome] | None:
        """The point ahead of a sample at which a curve ends and beside which its equations are singular, and
        how it ends; None where curves go on.
        """
        return None

    def tells_of(self, located: Located) -> bool:
        """Whether a located point is stored, and not only what another test sees of one that is."""
        return self.told


class LimitType(PointType):
    """A kind of point beyond which solutions are not the machine's: `Test.MARGIN`.

    Attributes
    ----------
    reason : str
        The reason code of a branch that ends there.
    like : str
        Under which label a run file says what is done there, where that is not its own.
    shared : bool
        Whether two that coincide are one.
    declared : bool
        Whether nothing happens there but that something is no longer as it was declared to be.
    entered : bool
        Whether a branch that comes from beyond goes on: what it becomes is the machine's.
    beyond : str
        What a branch goes on to where it switches.
    """

    reason: ClassVar[str]
    like: ClassVar[str] = ""
    shared: ClassVar[bool] = False
    declared: ClassVar[bool] = False
    entered: ClassVar[bool] = False
    beyond: ClassVar[str] = "orbits of another signature"


class Limit(Protocol):
    """Something that must stay positive along a branch for its solutions to be what the machine does.

    `type` and `kind` are those of the special point where it passes zero; `name` says what it is; `acts`
    whether something happens there. Of two that pass zero at once for one reason, the lower `rank` tells it.
    """

    @property
    def kind(self) -> str | None:
        """As of the special point where it passes zero."""

    @property
    def name(self) -> str:
        """What it is."""

    @property
    def acts(self) -> bool:
        """Whether something happens there."""

    @property
    def type(self) -> LimitType:
        """The kind of special point where it passes zero."""

    @property
    def rank(self) -> int:
        """Which of several that tell the same is told."""


class Limited(Protocol):
    """What problems have whose solutions may not be the machine's: limits, and what lies beyond."""

    @property
    def limits(self) -> Sequence[Limit]:
        """The limits whose margins samples tell, in their order."""

    def margins(self, z: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Margins at a place, of shape (N + 1,) as the weights; NaN where they are not told off solutions."""

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""

    def stopped(self, located: Located, sample: Sample) -> str:
        """In words, why solutions beyond a limit are not the machine's, and what is nearest to it."""

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The branches beyond a limit, and in words what was found, or tried."""


class Anchored(Protocol):
    """What problems have whose equations are made for a place: its mesh, or the borders of a matrix."""

    def adapted(self, sample: Sample) -> tuple[Problem, Sample]:
        """The problem made anew for what follows a solution, and the solution's sample on it."""

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> Problem:
        """The problem for a solution that is taken up again. z and weights have the shape (N + 1,)."""


class Meshed(Anchored, Protocol):
    """What problems have whose solutions are functions, given on a mesh: an instance is one mesh."""

    # How far from a branch point that a walk begins at its side is looked at, in parts of the first step.
    branching_offset: float
    # A located point lies on the branch if it is this near, relative to the segment, beside rounding.
    location_tolerance: float

    @property
    def method(self) -> str:
        """How motions are integrated, and why so."""

    def sizes_since(self, sample: Sample, begun: Sample) -> np.ndarray:
        """What weights of the metric grow with, shape (N + 1,), on a branch that began elsewhere."""

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Errors of the equations at a solution, of its steps, shape (N,). z has the shape (N + 1,)."""

    def refined(self, z: np.ndarray, weights: np.ndarray) -> Problem:
        """The problem discretised for special points near z. z and weights have the shape (N + 1,)."""

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Problem:
        """The problem on the finest steps that rounding allows. z and weights have the shape (N + 1,)."""


class Problem(Protocol):
    """Equations F(u, lambda) = 0 with what is special about their solutions.

    What only some problems have, or is asked for one purpose, are objects of their own, or itself.
    """

    # As it is stored with a branch.
    kind: str
    # All parameters where the branch begins, and which of them, or what along a path, is lambda.
    line: ParameterLine

    @property
    def point_types(self) -> Sequence[PointType]:
        """The kinds of special points of its branches."""

    @property
    def evaluations(self) -> int:
        """Right-hand sides evaluated so far."""

    def linearize(self, z: np.ndarray) -> Linearization:
        """Residual, Jacobian and rounding level at z. z has the shape (N + 1,)."""

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z) without rounding noise, for critical vectors, shape (N, N + 1)."""

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
    ) -> Sample:
        """Everything that is watched at a solution; `before` is the unstable count next to it."""

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch, as fields of `BranchInfo`."""

    @property
    def observed(self) -> Observed:
        """What is measured of solutions: observables, and the state that stands for one."""

    @property
    def diagnosis(self) -> Diagnosis:
        """What is known of places where a branch ends, or cannot go on."""

    @property
    def equivalence(self) -> Equivalence:
        """Which solutions are one, or images of each other."""

    @property
    def anchored(self) -> Anchored | None:
        """What of its equations is made for a place; None where they are the same everywhere."""

    @property
    def meshed(self) -> Meshed | None:
        """How it is discretised; None where the equations are exact."""

    @property
    def limited(self) -> Limited | None:
        """The limits of its solutions, where there are any."""


T = TypeVar("T", bound=Problem)


def equations_at(problem: Any, z: np.ndarray) -> tuple[Any, Linearization]:
    """The problem, remeshed where its discretisation does not reach z, and its equations there.

    They are not finite where no discretisation reaches z.
    """
    here: Linearization = problem.linearize(z)
    if here.remeshed is None:
        return problem, here
    try:
        there = here.remeshed()
    except NotFinite:
        return problem, here
    return there, there.linearize(z)


def at_stored(problem: T, z: np.ndarray, weights: np.ndarray) -> T:
    """The problem for a solution that is taken up again, made for its place where it is for one."""
    there: Any = problem if problem.anchored is None else problem.anchored.at_stored(z, weights)
    return there


def refined(problem: Problem, z: np.ndarray, weights: np.ndarray) -> Problem:
    """The problem for special points near z, discretised for them where it is at all."""
    return problem if problem.meshed is None else problem.meshed.refined(z, weights)


def finest(problem: Problem, z: np.ndarray, weights: np.ndarray) -> Problem | None:
    """The problem on the finest steps there are; None where it has none."""
    return None if problem.meshed is None else problem.meshed.finest(z, weights)
