"""Curves of orbits whose conditions are values: branch points that persist, and marked values."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar

import numpy as np

from contwalk import quantities
from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.numerics.linear import Factorization
from contwalk.problems.locus import second_derivatives
from contwalk.problems.locus.flips import Flips
from contwalk.problems.locus.orbit_conditions import At
from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.persistence import not_followed
from contwalk.problems.locus.valued import Valued, Values, in_plane
from contwalk.quantities import PERIOD

# A curve of branch points is parallel to a parameter's axis where one of the slopes of its condition is less
# than this part of the other one.
ASLANT = 0.1
# What is left of the condition along the other parameter, against its terms, where branch points persist.
PERSISTS = 1e-4


class NamedCurve(OrbitCurve):
    """One of several kinds of curves with one label.

    `name` is as it is stored.
    """

    name: ClassVar[str]

    def facts(self) -> dict[str, Any]:
        """What is stored of it, as plain JSON values."""
        return {"of": self.of, "curve": {"name": self.name, **asdict(self)}}  # type: ignore[call-overload]


@dataclass(frozen=True)
class SymmetryBreakings(NamedCurve, Flips):
    """Half a symmetric orbit has a multiplier minus one: the whole loses its symmetry."""

    of, name = "BP", "symmetry-breaking"


@dataclass(frozen=True)
class BranchPoints(NamedCurve):
    """Branch points that persist, as in an invariant subspace."""

    of, name = "BP", "crossing"
    further = 1
    unfolds = by_values = True

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Valued:
        """[F_u F_parameter] has deficient rank, and F + mu b stands for F.

        It is singular where the curve is parallel to that parameter's axis: then it is the second one.
        `further` has the shape (1,).
        """
        by_first = _crossing(near, 0)
        slopes = _sizes(by_first, near)
        if slopes[-1] >= ASLANT * slopes[0]:
            return by_first
        by_second = _crossing(near, 1)
        persists = float(np.max(np.abs(by_second.values(near.plane, near.place)))) < PERSISTS
        return by_second if persists and _sizes(by_second, near)[-1] > slopes[-1] else by_first

    def critical(self, further: np.ndarray) -> np.ndarray:
        """One.

        `further` has the shape (k,).
        """
        return np.ones(1, dtype=complex)


@dataclass(frozen=True)
class ObservableAt(NamedCurve):
    """An observable of the orbit, or its period, at a value."""

    observable: str
    level: float
    of, name, by_values = "UZ", "observable", True

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Valued:
        """The observable is at its value.

        `further` has the shape (k,).
        """
        unit = abs(self.level) or 1.0

        def values(plane: Any, place: np.ndarray) -> np.ndarray:
            there, own = plane.first(place)
            return np.array([(measured(there, own, self.observable) - self.level) / unit])

        return vanishing(values, near)


@dataclass(frozen=True)
class ParameterAt(NamedCurve):
    """One of both parameters at a value; `place` is where it stands in z, from the end."""

    parameter: str
    place: int
    level: float
    of, name, by_values = "UZ", "parameter", True

    def system(self, orbit: Any, near: At, further: np.ndarray) -> Valued:
        """The parameter is at its value.

        `further` has the shape (k,).
        """

        def values(plane: Any, place: np.ndarray) -> np.ndarray:
            return np.array([plane.values_of(place)[self.parameter] - self.level])

        slopes = np.zeros((1, len(near.z) + 1))
        slopes[0, self.place] = 1.0
        return replace(vanishing(values, near), slopes=slopes)


KINDS: dict[str, Any] = {
    curve.name: curve for curve in (SymmetryBreakings, BranchPoints, ObservableAt, ParameterAt)
}


def _crossing(near: At, which: int) -> Valued:
    """Branch points along the first parameter, 0, or along the second one, 1, near a place."""
    size, place = len(near.z) - 1, near.place

    def jacobian(plane: Any, at: np.ndarray) -> tuple[Any, np.ndarray]:
        there = plane.on_lines(at)[which]
        return there, there.linearize(np.append(at[:size], at[-1 - which])).jacobian

    there, matrix = jacobian(near.plane, place)
    rows, weights = there.equation_scales, np.append(near.weights[:-1], near.in_plane[-1 - which])
    left, _, right = np.linalg.svd(matrix / rows[:, None] * weights)
    b, c = left[:, -1], right[-2:]

    def bordered(there: Any, matrix: np.ndarray) -> Factorization:
        whole = np.zeros((size + 2, size + 2))
        whole[:size, : size + 1] = matrix / rows[:, None] * weights
        whole[:size, -1], whole[size:, : size + 1] = b, c
        factored: Factorization = there.factored(whole, np.ones(size + 2))
        return factored

    def values(plane: Any, at: np.ndarray) -> np.ndarray:
        corner = bordered(*jacobian(plane, at)).solve_adjoint(np.eye(size + 2)[:, -1])
        return corner[size:]

    def exactly(plane: Any, at: np.ndarray) -> np.ndarray | None:
        there, matrix = jacobian(plane, at)
        if not second_derivatives.known(there, np.append(at[:size], at[-1 - which])):
            return None
        factored = bordered(there, matrix)
        vs = factored.solve(np.eye(size + 2)[:, size:])[: size + 1] * weights[:, None]
        psi = factored.solve_adjoint(np.eye(size + 2)[:, -1])[:size] / rows
        return -second_derivatives.of_products(plane, at, which, psi, vs.T, near.in_plane[-2:])

    return replace(vanishing(values, near, np.zeros(1), (b * rows)[:, None]), exactly=exactly)


def steepest_crossing(near: At) -> Valued:
    """The condition of a branch point somewhere near a place, along the parameter that tells it better."""
    return max((_crossing(near, which) for which in (0, 1)), key=lambda found: _sizes(found, near)[-1])


def _sizes(condition: Valued, near: At) -> np.ndarray:
    """How fast the values of a condition change along the solutions of F = 0: singular values, shape (2,)."""
    place = near.place
    slopes = condition.along(near.plane, place, in_plane(near.plane, place)[1])
    return np.linalg.svd(slopes * near.in_plane, compute_uv=False)


def measured(orbit: Any, z: np.ndarray, name: str) -> float:
    """The value of an observable of an orbit with the unknowns z, shape (N + 1,), or its period, seconds."""
    if name == PERIOD:
        return float(orbit.duration(z))
    if name == orbit.observable_names[-1]:
        return float(orbit.observables(z, orbit.multipliers(z, orbit.jacobian(z)))[-1])
    return float(orbit.observable(name, z))


def marked_at(orbit: Any, point: SpecialPoint, free: tuple[str, str]) -> OrbitCurve:
    """The curve through a marked value of orbits.

    Raises
    ------
    StartError
        If there is none.
    """
    name, level = point.mark.get("name"), point.mark.get("value")
    if name is not None and level is not None:
        if name in free:
            return ParameterAt(str(name), -1 - free.index(str(name)), float(level))
        if name == PERIOD or quantities.known(str(name), orbit.observable_names):
            return ObservableAt(str(name), float(level))
    raise StartError(
        f"No curve in two parameters can be followed from {point.name or point.label}: "
        f"{not_followed(point, free)}",
        "Mark a value of an observable, of the period, or of one of both parameters.",
    )


def vanishing(
    values: Values, near: At, further: np.ndarray | None = None, unfolding: np.ndarray | None = None
) -> Valued:
    """The condition that values vanish, made near a place; nobody has their derivatives.

    Parameters
    ----------
    values : callable
        See `Values`.
    near : At
    further : ndarray, shape (k,), optional
        Further unknowns, none by default.
    unfolding : ndarray, shape (N, k), optional
        Their columns b in F + b mu = 0.
    """
    own = np.zeros(0) if further is None else further
    columns = np.zeros((len(near.z) - 1, 0)) if unfolding is None else unfolding
    start, scale = np.append(near.z, own), np.append(near.weights, np.ones(len(own)))
    return Valued(values, near.in_plane, start, scale, columns)
