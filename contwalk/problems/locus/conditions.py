"""Defining systems of curves in two parameters and of their special points: F = 0, conditions on eigenvalues.

| solution | unknowns beside x, drifts, second, first | equations beside F = 0 |
|---|---|---|
| LP curve | | g(z, 0) = 0 |
| HB curve | kappa | alpha = beta = 0 |
| BP curve | mu | both values of DF by states and one parameter = 0, and F + mu b for F |
| UZ curve | | observable, or first parameter, at its value; or an eigenvalue of F_u - sigma E as above |
| cusp | | g(z, 0) = 0, p.B(q, q) = 0 |
| Bogdanov-Takens | | alpha = beta = 0 for kappa = 0 |
| generalized Hopf | kappa | alpha = beta = 0, l1 = 0 |
| zero-Hopf | kappa | g(z, 0) = 0, alpha = beta = 0 |
| double Hopf | kappa, kappa' | alpha = beta = 0 for both pairs |

The conditions are those of `bordered`: minimally augmented systems (Griewank & Reddien 1984, SIAM J. Numer.
Anal. 21, 176; Govaerts, Kuznetsov & Sijnave 2000, SIAM J. Sci. Comput. 22, 62; Kuznetsov 2004, section 10.3).
The unknowns stand in the order x, drifts, kappas or mu, second, first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.numerics.refine import DefiningSystem
from contwalk.problems.locus import bordered
from contwalk.problems.locus.bordered import Borders, Critical
from contwalk.problems.locus.plane import ExactPlace, FloatPlace, Place, Plane

# How far along the curve a function without derivatives of its own is looked at for its slope, in the metric.
BESIDE = 1e-5


class Told(Protocol):
    """What a condition tells of a place: the numbers that vanish, beside what they were computed with."""

    @property
    def values(self) -> tuple[Any, ...]:
        """The numbers that vanish where the condition holds."""


class Condition(Protocol):
    """What holds along a curve, or at a special point, beside F = 0.

    `unknowns` is 1 where it has an unknown of its own: a pair its kappa, a branch point the unfolding mu of
    F + mu b = 0, with the vector `unfolding`, b, shape (N,).
    """

    @property
    def unknowns(self) -> int:
        """How many unknowns of its own it has."""

    @property
    def unfolding(self) -> np.ndarray | None:
        """By what F is moved as its own unknown grows, shape (N,); None where F does not know it."""

    def told(self, place: Place, own: Any) -> Any:
        """Its values at a place, with what they were computed with."""

    def gradients(self, place: Place, told: Any, own: Any) -> np.ndarray:
        """Derivatives of c values by z and its own unknown, shape (c, N + 2) or (c, N + 3)."""

    def levels(self, place: FloatPlace, told: Any, own: float) -> np.ndarray:
        """Rounding of its values, shape (c,)."""


class _Eigenvalue:
    """What conditions on eigenvalues share."""

    unfolding = None

    def gradients(self, place: Place, told: Critical, own: Any) -> np.ndarray:
        """Derivatives of the values, shape (1, N + 2), or of alpha and beta by kappa as well, (2, N + 3)."""
        return bordered.gradients(place, told, own)

    def levels(self, place: FloatPlace, told: Critical, own: float) -> np.ndarray:
        """Rounding of the values, shape (1,) or (2,)."""
        return bordered.levels(place, told, own)


@dataclass(frozen=True)
class Zero(_Eigenvalue):
    """A real eigenvalue sigma."""

    borders: Borders
    sigma: float = 0.0
    unknowns: int = 0

    def told(self, place: Place, own: Any) -> Critical:
        """g(z, sigma), and its vectors."""
        return bordered.zero_condition(place, self.borders, self.sigma)


@dataclass(frozen=True)
class DoubleZero(_Eigenvalue):
    """A double zero eigenvalue with one vector."""

    borders: Borders
    unknowns: int = 0

    def told(self, place: Place, own: Any) -> Critical:
        """alpha and beta at kappa = 0."""
        return bordered.pair_condition(place, self.borders, 0.0)

    def gradients(self, place: Place, told: Critical, own: Any) -> np.ndarray:
        """Derivatives of both by z, shape (2, N + 2)."""
        return bordered.gradients(place, told, 0.0)[:, :-1]


@dataclass(frozen=True)
class Pair(_Eigenvalue):
    """A pair of eigenvalues sigma + s and sigma - s, s^2 = -kappa."""

    borders: Borders
    sigma: float = 0.0
    unknowns: int = 1

    def told(self, place: Place, own: Any) -> Critical:
        """alpha and beta for kappa."""
        return bordered.pair_condition(place, self.borders, own, self.sigma)


@dataclass(frozen=True)
class Values:
    """Numbers that vanish, with their derivatives by z, shape (c, N + 2)."""

    values: tuple[Any, ...]
    slopes: np.ndarray


@dataclass(frozen=True)
class Level:
    """A declared observable has a value."""

    name: str
    level: float
    unknowns: int = 0
    unfolding: None = None

    def told(self, place: Place, own: Any) -> Values:
        """The observable less its value."""
        value, slopes = place.measured(self.name)
        return Values((value - self.level,), slopes[None, :])

    def gradients(self, place: Place, told: Values, own: Any) -> np.ndarray:
        """Its derivatives by z, shape (1, N + 2)."""
        return told.slopes

    def levels(self, place: FloatPlace, told: Values, own: float) -> np.ndarray:
        """Rounding of its terms, as far as value and slopes tell them, shape (1,)."""
        terms = abs(self.level) + abs(float(told.values[0])) + float(np.abs(told.slopes[0]) @ np.abs(place.z))
        return np.array([EPSILON * terms])


@dataclass(frozen=True)
class ParameterAt:
    """The parameter that is number `place` of z has a value."""

    place: int
    level: float
    unknowns: int = 0
    unfolding: None = None

    def told(self, place: Place, own: Any) -> Values:
        """The parameter less its value."""
        slopes = np.zeros((1, place.plane.size + 2))
        slopes[0, self.place] = 1.0
        return Values((place.z[self.place] - self.level,), slopes)

    def gradients(self, place: Place, told: Values, own: Any) -> np.ndarray:
        """One by the parameter, shape (1, N + 2)."""
        return told.slopes

    def levels(self, place: FloatPlace, told: Values, own: float) -> np.ndarray:
        """Half an ulp, shape (1,)."""
        return np.array([EPSILON * abs(self.level)])


# A function of a place, what the first condition tells of it, and its own unknown, that a special point has
# beside the conditions.
Function = Callable[[Place, Any, Any], Any]


@dataclass(frozen=True)
class Augmented:
    """F = 0 with conditions, as functions of U = (x, drifts, own unknowns of conditions, second, first)."""

    plane: Plane
    conditions: tuple[Condition, ...]

    @property
    def own(self) -> int:
        """How many of the unknowns are those of conditions."""
        return sum(condition.unknowns for condition in self.conditions)

    @property
    def unfoldings(self) -> tuple[int, ...]:
        """The numbers of those unknowns that unfold F: zero at solutions but for rounding."""
        owns = (condition for condition in self.conditions if condition.unknowns)
        return tuple(
            self.plane.size + k for k, condition in enumerate(owns) if condition.unfolding is not None
        )

    def split(self, u: Any) -> tuple[Any, list[Any]]:
        """z of the plane, and the unknown of each condition, 0 of one that has none."""
        size, count = self.plane.size, self.own
        own = iter(u[size : size + count])
        z = [*u[:size], *u[size + count :]]
        owns = [next(own) if condition.unknowns else 0.0 for condition in self.conditions]
        return (np.array(z) if isinstance(u, np.ndarray) else z), owns

    def joined(self, z: np.ndarray, owns: Sequence[float]) -> np.ndarray:
        """U of a z of the plane, shape (N + 2,), and the unknowns of the conditions that have one.

        With k of these it has the shape (N + 2 + k,).
        """
        size = self.plane.size
        return np.concatenate([z[:size], owns, z[size:]])

    def told(self, place: Place, owns: Sequence[Any]) -> list[Any]:
        """What all conditions tell of a place."""
        return [one.told(place, own) for one, own in zip(self.conditions, owns, strict=True)]

    def residual(self, place: Place, told: Sequence[Told], owns: Sequence[Any]) -> list[Any]:
        """F, moved by what unfolds it, and the values of the conditions, N + c numbers."""
        moved = place.residual
        for condition, own in zip(self.conditions, owns, strict=True):
            if condition.unfolding is not None:
                moved = moved + condition.unfolding * own
        return [*moved, *(value for one in told for value in one.values)]

    def jacobian(self, place: Place, told: Sequence[Told], owns: Sequence[Any]) -> np.ndarray:
        """Derivatives of the residual by U, shape (N + c, N + 2 + k)."""
        size, count = self.plane.size, self.own
        first = place.jacobian
        rows = size + sum(len(one.values) for one in told)
        jacobian = np.zeros((rows, size + 2 + count), dtype=first.dtype)
        outside = [*range(size), *range(size + count, size + 2 + count)]
        jacobian[:size, outside] = first
        row, own_column = size, size
        for condition, one, own in zip(self.conditions, told, owns, strict=True):
            here = slice(row, row + len(one.values))
            slopes = condition.gradients(place, one, own)
            jacobian[here, outside] = slopes[:, : size + 2]
            if condition.unknowns:
                jacobian[here, own_column] = slopes[:, -1]
                if condition.unfolding is not None:
                    jacobian[:size, own_column] = condition.unfolding
                own_column += 1
            row = here.stop
        return jacobian

    def with_unfoldings(self, scale: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Magnitudes of U with such of unfoldings as matter to equations, which have the derivatives `rows`.

        Their own are those of rounding, and beside a solution all that moves would be they. The shapes are
        (k,) and (j, k).
        """
        units = scale.copy()
        for place in self.unfoldings:
            units[place] = 1.0 / float(np.abs(rows[:, place]).max())
        return units

    def values(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, its Jacobian by U, and the rounding of the conditions.

        With N equations F and c numbers that vanish beside them, at U of shape (k,), the shapes are (N + c,),
        (N + c, k) and (c,).

        Raises
        ------
        numpy.linalg.LinAlgError
            Where the borders do not fit.
        """
        z, owns = self.split(u)
        place = FloatPlace(self.plane, z)
        told = self.told(place, owns)
        known = [
            condition.levels(place, one, own)
            for condition, one, own in zip(self.conditions, told, owns, strict=True)
        ]
        residual = np.array(self.residual(place, told, owns))
        return residual, self.jacobian(place, told, owns), np.concatenate(known)

    def exactly(self, u: Sequence[Any]) -> tuple[list[Any], ExactPlace, list[Any], list[Any]]:
        """The residual with more digits, and with what it was computed."""
        z, owns = self.split(list(u))
        place = ExactPlace(self.plane, z)
        told = self.told(place, owns)
        return self.residual(place, told, owns), place, told, owns


def defining_system(
    augmented: Augmented, scale: np.ndarray, start: np.ndarray, function: Function | None = None
) -> DefiningSystem:
    """The equations of a point: conditions that are as many as the unknowns, or one fewer and a function.

    The slope of the function is taken along the curve on which the conditions hold: the others do not matter
    where they do. Its value is exact, so that refinement goes to the last digit.

    `scale` and `start` have the shape of U, (k,).
    """
    if function is None:
        return DefiningSystem(
            scale,
            lambda u: augmented.values(u)[0],
            lambda u: augmented.values(u)[1],
            lambda u: augmented.exactly(u)[0],
        )

    def value(u: np.ndarray) -> float:
        z, owns = augmented.split(u)
        place = FloatPlace(augmented.plane, z)
        return float(function(place, augmented.told(place, owns)[0], owns[0]))

    def residual(u: np.ndarray) -> np.ndarray:
        return np.append(augmented.values(u)[0], value(u))

    def jacobian(u: np.ndarray) -> np.ndarray:
        matrix = augmented.values(u)[1]
        largest = np.abs(matrix * scale).max(axis=1, keepdims=True)
        rows = matrix / np.where(largest > 0.0, largest, 1.0)
        units = augmented.with_unfoldings(scale, rows)
        tangent = np.linalg.svd(rows * units)[2][-1]
        ahead, behind = (value(u + sign * BESIDE * units * tangent) for sign in (1.0, -1.0))
        return np.vstack([matrix, (ahead - behind) / (2.0 * BESIDE) * tangent / units])

    def exactly(u: Sequence[Any]) -> list[Any]:
        values, place, told, owns = augmented.exactly(u)
        return [*values, function(place, told[0], owns[0])]

    return DefiningSystem(scale, residual, jacobian, exactly)
