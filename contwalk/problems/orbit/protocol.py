"""What orbits of both kinds, smooth and hybrid, offer to the algorithms that they share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, Self

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.numerics.linear import Factorization
from contwalk.numerics.permutations import Permutation
from contwalk.problems.kink import Kink
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.normal_forms import SectionMap
from contwalk.problems.orbit.section import Section
from contwalk.problems.orbit.shooting import Mesh
from contwalk.problems.orbit.slow_place import SlowPlace
from contwalk.problems.problem import (
    Diagnosis,
    Equivalence,
    Linearization,
    Located,
    Meshed,
    Observed,
    Problem,
    Sample,
    Seed,
    Test,
)
from contwalk.system import Neutral, System


class OrbitKind(Protocol):
    """A kind of special point of orbits, as they see it: `points.point` says what each member is."""

    @property
    def label(self) -> str:
        """As it is stored."""

    @property
    def test(self) -> Test:
        """What tells it."""

    @property
    def multiplier(self) -> float | None:
        """The real multiplier that is critical there."""

    def system(self, problem: Any, sample: Sample, which: int) -> Any:
        """The augmented system whose solution near a sample is such a point."""

    def form(self, problem: Any, located: Located, sample: Sample) -> Any:
        """Kind, criticality, coefficients and note of a located point."""

    def form_of_pair(self, problem: Any, located: Located, sample: Sample) -> Any:
        """As `form`, where the critical multiplier is double."""

    def branches(self, problem: Any, z: np.ndarray, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a point, on fine steps. z has the shape (N + 1,)."""


class OrbitDiagnosis(Diagnosis, Protocol):
    """What is known of places where a branch of orbits ends, or cannot go on."""

    def without_value(self, z: np.ndarray) -> str:
        """The plugin's line at which the motion of z, shape (N + 1,), has no value; empty if none is."""


class EquationsOfOrbit(Problem, Protocol):
    """The equations of an orbit, and what is computed of them."""

    @property
    def equation_scales(self) -> np.ndarray:
        """Units of the equations, shape (N,)."""

    def examine(
        self,
        z: np.ndarray,
        tangent: np.ndarray,
        weights: np.ndarray,
        linearization: Linearization,
        before: int | None,
        known: Sample | None = None,
    ) -> Sample:
        """Everything that is watched at a solution; of `known`, its sample on other steps, what does not
        depend on these is taken over.

        z, tangent and weights have the shape (N + 1,).
        """

    def factored(self, matrix: np.ndarray, weights: np.ndarray) -> Factorization:
        """A matrix of these equations and unknowns, and of borders that come last, factored.

        The matrix has the shape (m, m), the weights (m,).

        Raises
        ------
        numpy.linalg.LinAlgError
            If it is exactly singular, here or when it is used.
        """

    def residual(self, z: np.ndarray) -> np.ndarray:
        """F(z), shape (N,), for far less than with its derivatives."""

    def multipliers(self, z: np.ndarray, jacobian: np.ndarray) -> Multipliers:
        """Multipliers of the closure. z has the shape (N + 1,), the jacobian (N, N + 1)."""

    def at_kinks(self, z: np.ndarray) -> Self:
        """The same orbit on steps that end where its field bends. z has the shape (N + 1,)."""

    def return_map(self, z: np.ndarray) -> SectionMap:
        """The map that takes the section once round the orbit. z has the shape (N + 1,)."""

    def kept_directions(
        self, z: np.ndarray, multiplier: float, count: int
    ) -> tuple[list[np.ndarray], list[Permutation]]:
        """Directions of so many critical multipliers that symmetries keep. z has the shape (N + 1,)."""

    def magnitudes_near(self, z: np.ndarray) -> np.ndarray:
        """Typical magnitudes of z, NaN where nothing tells. Both have the shape (N + 1,)."""

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivative of the closure's duration by unknowns and free parameter, shape (N + 1,)."""


class Orbit(EquationsOfOrbit, Meshed, Observed, Equivalence, Protocol):
    """A periodic orbit, discretised: what the engine asks of it, and the algorithms that all orbits share."""

    system: System
    free: str
    pins: tuple[Neutral, ...]
    discretization: Discretization
    forced: bool
    section: Section | None

    @property
    def diagnosis(self) -> OrbitDiagnosis:
        """What is known of places where a branch ends, or cannot go on."""

    @property
    def mesh(self) -> Mesh:
        """The steps of this discretisation."""

    @property
    def rounds(self) -> int:
        """Closures of the motion that `max_abs` is of."""

    @property
    def whole(self) -> tuple[str, int]:
        """How the orbit closes (`full`, or the name of a symmetry), and how many closures its period has."""

    def refined(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> Any:
        """The same problem on steps for located points. z and weights have the shape (N + 1,)."""

    def finest(self, z: np.ndarray, weights: np.ndarray) -> Any:
        """The same problem on the finest steps that rounding allows.

        z and weights have the shape (N + 1,).
        """

    def returned_to_parent(self, z: np.ndarray, tangent: np.ndarray) -> bool:
        """Whether the orbit of a branch with this tangent has become its parent again.

        z and tangent have the shape (N + 1,).
        """

    def observables(self, z: np.ndarray, found: Multipliers) -> np.ndarray:
        """Values of `observable_names`. z has the shape (N + 1,), the values (o,)."""

    def observable(self, name: str, z: np.ndarray) -> float:
        """The value of one observable that is not `max_abs`. z has the shape (N + 1,)."""

    def motion_of(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The whole motion: times and states. Shapes (k,) and (k, n)."""

    def errors_at(self, z: np.ndarray) -> np.ndarray:
        """Estimated error of each equation at a solution. z has the shape (N + 1,), the errors (N,)."""

    def locate(self, kind: OrbitKind, sample: Sample, which: int) -> Located | None:
        """The special point of a kind near a sample."""

    def tangent_at(self, located: Located, near: Sample) -> np.ndarray | None:
        """At a branch point, the tangent of the branch that `near` is on. Shape (N + 1,)."""

    def special_point(self, kind: OrbitKind, located: Located, sample: Sample, s: float) -> SpecialPoint:
        """The record of a located point of a kind."""

    def leaving(self, kind: OrbitKind, point: SpecialPoint) -> Sequence[Seed]:
        """The branches that leave a special point of a kind."""

    def doubled_from(self, z: np.ndarray, count: int = 1) -> Sequence[Seed]:
        """The orbits of twice the closure that leave where so many multipliers are -1. z: shape (N + 1,)."""

    def unfolded_from(self, z: np.ndarray, count: int = 1) -> Sequence[Seed]:
        """The whole orbits without their symmetry that leave where so many multipliers of a half are -1.

        z has the shape (N + 1,).
        """

    def admissible_at(self, z: np.ndarray) -> bool:
        """Whether a solution is one that the machine can move on. z has the shape (N + 1,)."""

    def slow_places(self, z: np.ndarray) -> list[SlowPlace]:
        """Where the orbit is slower than beside, and the field there; the slowest place first.

        z has the shape (N + 1,).
        """

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds. z has the shape (N + 1,)."""

    def velocity(self, z: np.ndarray) -> np.ndarray:
        """dx/dt at the start. z has the shape (N + 1,)."""

    def courses(self, z: np.ndarray) -> list[Course]:
        """The parts of the motion as they are looked at for kinks. z has the shape (N + 1,)."""

    def kinks_at_events(self, z: np.ndarray) -> tuple[Kink, ...]:
        """Jumps of guards and resets that events lie on, and of guards through zero on the way.

        z has the shape (N + 1,).
        """

    def adapted_to(self, z: np.ndarray, weights: np.ndarray, tolerance: float | None = None) -> Any:
        """The problem on steps for the orbit of z. z and weights have the shape (N + 1,)."""

    def into_section(self, z: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """A tangent moved along the flow into the section. All have the shape (N + 1,)."""
