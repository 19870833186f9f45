"""What the continuation engine sees of a problem.

Rules
-----
1. `z` is a vector of N unknowns with the free parameter last.
2. `linearize(z)` gives residual, exact Jacobian and the rounding level of each equation.
3. `examine` computes everything that is stored or watched at a solution, once.
4. Three kinds of test tell neighbouring samples apart: the orientation (branch points), the parameter's
share of
   the tangent (folds), and the stability measures (everything else). `locate` solves a point's defining
   system, `special_point` computes its normal form.
5. `seeds` proposes the branches that leave a special point; each is a start like any other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.errors import NotFinite
from contwalk.memory import computed_once
from contwalk.numerics.linear import EPSILON, Factored, Factorization
from contwalk.problems.event_kinks import Met
from contwalk.problems.kinks import Kink
from contwalk.problems.parameter_line import ParameterLine

# Observables that every problem has: the largest real part of an equilibrium, the largest modulus of an
# orbit.
MAX_RE, MAX_ABS = "max_re", "max_abs"
# `locate` is asked for a fold by this name where the parameter stands still to the errors of the equations.
FLAT_FOLD = "FLAT"
# A relative margin this far below zero is zero still: on the steps of a branch it is not known better.
NO_MARGIN = 1e-7

# Unknowns fitted for a corrector's hyperplane, given with its normal and the metric.
Fitted = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray | None]


class Linearization:
    """The equations at one z: F, shape (N,), and DF, shape (N, N + 1).

    What is only needed near a solution is computed when it is first asked for, by `levels`. `nearby()` begins
    a chain of points near z at which F alone is asked for, where that is far cheaper than DF; else it is
    None. `fitted(z, normal, weights)` tells z with those unknowns solved for that are hard to guess, None
    where there are none. Where the discretisation does not reach z nothing is finite, and `remeshed()` gives
    the problem on one that does as well.
    """

    def __init__(
        self,
        residual: np.ndarray,
        jacobian: np.ndarray,
        levels: Callable[[], tuple[np.ndarray, np.ndarray | None]],
        magnitudes: Callable[[], np.ndarray] | None = None,
        factor: Callable[[np.ndarray, np.ndarray], Factorization] = Factored,
        nearby: Callable[[], Callable[[np.ndarray], np.ndarray]] | None = None,
        fitted: Fitted | None = None,
        remeshed: Callable[[], Problem] | None = None,
    ) -> None:
        self.residual = residual
        self.jacobian = jacobian
        self.nearby, self.fitted, self.remeshed = nearby, fitted, remeshed
        self._factor = factor
        self._bordered: tuple[bytes, Factorization] | None = None
        self._levels = levels
        self._magnitudes = magnitudes

    @computed_once
    def levels(self) -> tuple[np.ndarray, np.ndarray | None]:
        """Rounding level of each residual, shape (N,), and what comes with it of typical magnitudes."""
        return self._levels()

    @computed_once
    def magnitudes(self) -> np.ndarray:
        """Typical magnitudes of z, shape (N + 1,), NaN where neither z nor the equations tell."""
        found = self.levels[1] if self._magnitudes is None else self._magnitudes()
        assert found is not None
        return found

    def bordered(self, row: np.ndarray, weights: np.ndarray) -> Factorization:
        """[DF; row], factored; kept until another row is asked for.

        Raises
        ------
        numpy.linalg.LinAlgError
            If it is exactly singular, here or when it is used.
        """
        key = row.tobytes() + weights.tobytes()
        if self._bordered is None or self._bordered[0] != key:
            self._bordered = key, self._factor(np.vstack([self.jacobian, row]), weights)
        return self._bordered[1]

    def tangent(self, border: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """The null vector t of DF with border . t = 1.

        Raises
        ------
        numpy.linalg.LinAlgError
            Exactly at a branch point, where DF has more than one.
        """
        unit = np.zeros(len(border))
        unit[-1] = 1.0
        return self.bordered(border, weights).solve(unit)

    def orientation_and_error(
        self, tangent: np.ndarray, weights: np.ndarray, levels: np.ndarray
    ) -> tuple[float, float]:
        """Sign of det [DF; tangent], and what errors `levels` of the equations do to the solution at most."""
        try:
            bordered = self.bordered(tangent / weights**2, weights)
            return bordered.orientation(), bordered.error(levels, weights)
        except np.linalg.LinAlgError:
            return 0.0, float("inf")

    @property
    def finite(self) -> bool:
        """Whether residual and Jacobian are."""
        return bool(np.all(np.isfinite(self.residual)) and np.all(np.isfinite(self.jacobian)))

    def excess_in(self, weights: np.ndarray) -> float:
        """As `excess`, where unknowns too are only known to the rounding of their weights."""
        level = self.levels[0] + EPSILON * (np.abs(self.jacobian) @ weights)
        return float(np.max(np.abs(self.residual) / level))

    @computed_once
    def excess(self) -> float:
        """Largest residual in units of its rounding level; at most a few at a solution."""
        ratio = float(np.max(np.abs(self.residual) / self.levels[0]))
        return ratio if np.isfinite(ratio) else float("inf")


class Rates:
    """How fast stability measures change along a branch, each computed when it is first asked for.

    Parameters
    ----------
    count : int
    rate : callable
        Derivative of the measure of a number 0..count-1 by arclength, NaN where none is known.
    """

    def __init__(self, count: int, rate: Callable[[int], float], factor: float = 1.0) -> None:
        self._count, self._rate, self._factor = count, rate, factor

    @classmethod
    def known(cls, values: np.ndarray) -> Rates:
        """Rates that are known already."""
        return cls(len(values), values.tolist().__getitem__)

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, which: int) -> float:
        if not 0 <= which < self._count:
            raise IndexError(which)
        return self._factor * self._rate(which)

    def scaled(self, factor: float) -> Rates:
        """Rates by another arclength."""
        return Rates(self._count, self._rate, self._factor * factor)


@dataclass(frozen=True)
class Sample:
    """A solution with all that is watched along a branch.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    tangent : ndarray, shape (N + 1,)
        Unit in the metric of `weights`, pointing the way the branch is walked.
    weights : ndarray, shape (N + 1,)
        Typical magnitudes; the metric is the Euclidean norm of z / weights.
    orientation : float
        Sign of det [DF; tangent]; changes at a simple branch point and nowhere else.
    eigenvalues, errors : ndarray, shape (m,)
        Spectrum, and its estimated errors.
    rates : Rates
        Of its stability measures along the branch.
    measures : ndarray, shape (m,)
        What must be negative for stability, in descending order (real parts; moduli minus one for orbits).
    unstable : int
    observables : ndarray, shape (o,)
    magnitudes : ndarray, shape (N + 1,)
        Typical magnitudes as z and the equations tell them, NaN where they do not.
    excess : float
        Residual in units of its rounding level.
    critical : float
        What a real eigenvalue is where it changes stability: 0, of orbits 1.
    spectrum_error : float, optional
        Estimated error of the leading eigenvalue, where `errors` are only what blurs its sign along the
        branch.
    spectrum_accuracy : float, optional
        The same for a solution that is known exactly: `spectrum_error` may have what z is not known to.
    sizes : ndarray, shape (N + 1,), optional
        What the weights of the metric grow with along the branch; |z| if not given.
    error : float
        Estimated error of z in the metric, from the errors of the equations.
    margins : ndarray
        What must stay positive for the motion to be the machine's, relative; those of `Problem.limits`.
    reported : ndarray, shape (n,), optional
        The state that stands for the solution, where it depends on the steps it was computed on.
    forbidden : bool
        Whether an event of the machine would happen on it, which these equations do not have.
    still : bool
        Whether the last eigenvalue, out of order, is that of the branch's own direction: zero all along it.
    kinks : tuple of Kink
        Where the field is smooth by pieces only along an orbit.
    period, trivial_error : float
        Of orbits: duration of the closure in seconds, and |M f - f| / |f|.
    """

    z: np.ndarray
    tangent: np.ndarray
    weights: np.ndarray
    orientation: float
    eigenvalues: np.ndarray
    errors: np.ndarray
    rates: Rates
    measures: np.ndarray
    unstable: int
    observables: np.ndarray
    magnitudes: np.ndarray
    excess: float
    iterations: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    critical: float = 0.0
    period: float = float("nan")
    trivial_error: float = float("nan")
    spectrum_error: float | None = None
    spectrum_accuracy: float | None = None
    sizes: np.ndarray | None = None
    error: float = float("nan")
    margins: np.ndarray = field(default_factory=lambda: np.zeros(0))
    reported: np.ndarray | None = None
    forbidden: bool = False
    still: bool = False
    kinks: tuple[Kink, ...] = ()

    @property
    def spectrum(self) -> np.ndarray:
        """The eigenvalues in their order."""
        if not self.still:
            return self.eigenvalues
        return self.eigenvalues[np.lexsort((-self.eigenvalues.imag, -self.eigenvalues.real))]

    @property
    def leading(self) -> int:
        """Number of the first of the eigenvalues in their order."""
        return int(np.argmax(self.eigenvalues.real)) if self.still else 0

    @property
    def parameter(self) -> float:
        """Value of the free parameter."""
        return float(self.z[-1])

    def counted(self, unstable: int) -> Sample:
        """The same with a count that was told on other steps.

        An eigenvalue that these steps put on the other side is not known to its distance from it.
        """
        if unstable == self.unstable:
            return self
        other = (np.arange(len(self.measures)) < unstable) != (self.measures > 0.0)
        doubt = np.where(other, np.abs(self.measures), 0.0)
        known = max(self.spectrum_error or 0.0, float(np.max(doubt, initial=0.0)))
        return replace(self, unstable=unstable, errors=np.maximum(self.errors, doubt), spectrum_error=known)

    @property
    def admissible(self) -> bool:
        """Whether no margin is negative beyond rounding, and no event is passed over."""
        return not self.forbidden and bool(np.all(self.margins >= -NO_MARGIN))


@dataclass(frozen=True)
class Located:
    """A special point that a defining system has been solved for.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    error : float
        Estimated absolute error of the free parameter.
    vectors : mapping
        Null vectors and the like that normal forms and switching need.
    refined : bool
        Whether the point is known to more digits than floats hold.
    refine : callable
        The same point refined in extended precision; None where it turns out not to be one.
    problem : Problem
        The discretisation that it was found on, where there is more than one.
    """

    z: np.ndarray
    error: float
    vectors: Mapping[str, Any] = field(default_factory=dict)
    refined: bool = False
    refine: Callable[[], Located | None] | None = None
    problem: Any = None

    def settled(self) -> Located | None:
        """The refined point, if there is a way to refine it."""
        return self if self.refine is None else self.refine()


@dataclass(frozen=True)
class Seed:
    """A branch that leaves a special point: a solution on it (or the point itself) and its direction.

    `reach(change)` estimates how far each unknown moves along it while the parameter changes so much, shape
    (N + 1,), for unknowns that are zero at the point. `problem` is whose solutions they are. `one_sided`:
    the other direction leads to the same solutions once more.
    """

    label: str
    z: np.ndarray
    tangent: np.ndarray
    reach: Callable[[float], np.ndarray]
    problem: Problem
    one_sided: bool = False


class Mirror(Protocol):
    """What takes one half of a branch to the other, where they are images of each other under symmetries."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the symmetries in the order in which they are applied."""
        ...

    def refuses(self, point: SpecialPoint) -> str:
        """Why the image of a special point has to be located itself; empty where it has not."""
        ...

    def row(self, row: np.void, before: np.void, last: np.void) -> np.ndarray | None:
        """The stored image of a stored solution, shape (1,); None if it does not solve the equations.

        `before` is the regular row from which the walk stepped to it, and `last` that row's image.
        """
        ...

    def sample(self, row: np.void) -> Sample:
        """Place and metric of a stored solution, as a sample that tells no more."""
        ...

    def margin(self, row: np.void) -> Mapping[str, float]:
        """What must stay positive on an image, by name."""
        ...

    def special_point(self, point: SpecialPoint, row: np.void, last: np.void) -> SpecialPoint:
        """The image of a special point, whose row is given; `last` as of `row`."""
        ...


class Limit(Protocol):
    """Something that must stay positive along a branch for its solutions to be what the machine does.

    `label` and `kind` are those of the special point where it passes zero; `name` says what it is; `acts`
    whether something happens there. Of two that pass zero at once for one reason, the lower `rank` tells it.
    """

    label: str
    kind: str | None
    name: str
    acts: bool

    @property
    def rank(self) -> int:
        """Which of several that tell the same is told."""
        ...


class Problem(Protocol):
    """Equations F(u, lambda) = 0 with what is special about them."""

    kind: str
    # Whether solutions are discretised, so that what they tell has errors of steps.
    discretized: bool
    free: str
    # Values of all parameters where the branch begins.
    parameters: dict[str, float]
    line: ParameterLine
    # How far from a branch point that a walk begins at its side is looked at, in parts of the first step.
    beside: float
    # A located point lies on the branch if it is this near, relative to the segment, beside rounding.
    blur: float

    @property
    def size(self) -> int:
        """Number N of unknowns without the free parameter."""
        ...

    @property
    def observable_names(self) -> tuple[str, ...]:
        """Names of the observables, in the order of `Sample.observables`."""
        ...

    @property
    def method(self) -> str:
        """How motions are integrated, and why so; empty where none are."""
        ...

    @property
    def evaluations(self) -> int:
        """Right-hand sides evaluated so far."""
        ...

    @property
    def limits(self) -> Sequence[Any]:
        """The limits whose margins samples tell, each a `Limit`."""
        ...

    def limit_of(self, point: SpecialPoint) -> int:
        """Which of the limits a special point is one of."""
        ...

    def stopped(self, label: str, located: Located, sample: Sample) -> str:
        """In words, why solutions beyond a limit are not the machine's, and what is nearest to it."""
        ...

    def neighbours(self, point: SpecialPoint) -> tuple[Sequence[Seed], str]:
        """The branches beyond a limit, and in words what was found, or tried."""
        ...

    def linearize(self, z: np.ndarray) -> Linearization:
        """Residual, Jacobian and rounding level at z."""
        ...

    def jacobian(self, z: np.ndarray) -> np.ndarray:
        """DF(z) without rounding noise, for critical vectors."""
        ...

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
    ) -> Sample:
        """Everything that is watched at a solution; `before` is the unstable count next to it."""
        ...

    def branch_facts(self) -> dict[str, Any]:
        """What is true of a whole branch, as fields of `BranchInfo`."""
        ...

    def beginnings(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
        ...

    def adapted(self, sample: Sample) -> tuple[Problem, Sample]:
        """The problem discretised anew for what follows a solution, and the solution's sample on it."""
        ...

    def ended(self, a: Sample, b: Sample) -> Outcome | None:
        """Why the branch ends between two neighbouring solutions, if it does."""
        ...

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same parameter are one."""
        ...

    def at_stored(self, z: np.ndarray, weights: np.ndarray) -> Problem:
        """The problem discretised for a solution that is taken up again."""
        ...

    def refined(self, z: np.ndarray, weights: np.ndarray) -> Problem:
        """The problem discretised for special points near z."""
        ...

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Problem | None:
        """The problem on the finest steps there are; None where it is not discretised."""
        ...

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state that stands for a solution, shape (n,)."""
        ...

    def explain(self, z: np.ndarray) -> str:
        """Where in the plugin a residual at z is not finite."""
        ...

    def kinks_between(self, a: Sample, b: Sample) -> Sequence[Kink]:
        """Where the equations are smooth by pieces only: between two solutions, or on the second one."""
        ...

    def passed_at_events(self, a: np.ndarray, b: np.ndarray) -> Sequence[Met]:
        """What jumps at the events of orbits on the way from one to another, which need not be one."""
        ...

    def obstacle(self, z: np.ndarray) -> str:
        """What makes solutions beside z hard to find, and what helps; empty if nothing is known of that."""
        ...

    def locate(self, label: str, sample: Sample, which: int) -> Located | None:
        """The special point near a sample, by its defining system; `which` counts critical eigenvalues."""
        ...

    def locate_mark(self, name: str, level: float, sample: Sample) -> Located | None:
        """The point near a sample at which an observable has the value `level`."""
        ...

    def rate(self, name: str, sample: Sample) -> float:
        """Derivative of an observable along the branch."""
        ...

    def tangent_at(self, label: str, located: Located, near: Sample) -> np.ndarray | None:
        """Tangent of the branch at a special point where DF alone does not determine it; else None."""
        ...

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one."""
        ...

    def many_branches(self, z: np.ndarray) -> bool:
        """Whether more than one branch passes through a solution, to rounding."""
        ...

    def label_of(self, sample: Sample, which: int) -> str | None:
        """Label of the point at which stability measure `which` passes zero; None if other tests see it."""
        ...

    def special_point(self, label: str, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point, with its normal form."""
        ...

    def mirror(self, sample: Sample) -> Mirror | None:
        """What takes one half of the branch that leaves a solution to the other, if a symmetry does."""
        ...

    def seeds(self, point: SpecialPoint) -> Sequence[Seed]:
        """Branches that leave a special point."""
        ...


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
