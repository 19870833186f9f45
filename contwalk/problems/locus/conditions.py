"""Defining systems of curves in two parameters and of their special points: F = 0, conditions on eigenvalues.

| solution | unknowns beside x, drifts, second, first | equations beside F = 0 |
|---|---|---|
| LP curve | | g(z, 0) = 0 |
| HB curve | kappa | alpha = beta = 0 |
| cusp | | g(z, 0) = 0, p.B(q, q) = 0 |
| Bogdanov-Takens | | alpha = beta = 0 for kappa = 0 |
| generalized Hopf | kappa | alpha = beta = 0, l1 = 0 |
| zero-Hopf | kappa | g(z, 0) = 0, alpha = beta = 0 |
| double Hopf | kappa, kappa' | alpha = beta = 0 for both pairs |

The conditions are those of `bordered`: minimally augmented systems (Griewank & Reddien 1984, SIAM J. Numer.
Anal. 21, 176; Govaerts, Kuznetsov & Sijnave 2000, SIAM J. Sci. Comput. 22, 62; Kuznetsov 2004, section 10.3).
The unknowns stand in the order x, drifts, kappas, second, first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from contwalk.numerics.refine import DefiningSystem
from contwalk.problems.locus import bordered
from contwalk.problems.locus.bordered import Borders, Critical
from contwalk.problems.locus.plane import ExactPlace, FloatPlace, Place, Plane

# How far along the curve a function without derivatives of its own is looked at for its slope, in the metric.
BESIDE = 1e-5


class Condition(Protocol):
    """A condition on eigenvalues; `unknowns` is 1 where it has a kappa of its own."""

    @property
    def unknowns(self) -> int:
        """How many kappas it has."""
        ...

    def critical(self, place: Place, kappa: Any) -> Critical:
        """Its values and vectors."""
        ...


@dataclass(frozen=True)
class Zero:
    """A zero eigenvalue."""

    borders: Borders
    unknowns: int = 0

    def critical(self, place: Place, kappa: Any) -> Critical:
        """g(z, 0), and its vectors."""
        return bordered.zero_condition(place, self.borders)


@dataclass(frozen=True)
class DoubleZero:
    """A double zero eigenvalue with one vector."""

    borders: Borders
    unknowns: int = 0

    def critical(self, place: Place, kappa: Any) -> Critical:
        """alpha and beta at kappa = 0."""
        return bordered.pair_condition(place, self.borders, 0.0)


@dataclass(frozen=True)
class Pair:
    """A pair of eigenvalues s and -s, s^2 = -kappa."""

    borders: Borders
    unknowns: int = 1

    def critical(self, place: Place, kappa: Any) -> Critical:
        """alpha and beta."""
        return bordered.pair_condition(place, self.borders, kappa)


# A function of place, critical vectors and kappa of the first condition that a special point has beside it.
Function = Callable[[Place, Critical, Any], Any]


@dataclass(frozen=True)
class Augmented:
    """F = 0 with conditions, as functions of U = (x, drifts, kappas, second, first)."""

    plane: Plane
    conditions: tuple[Condition, ...]

    @property
    def pairs(self) -> int:
        """How many of the unknowns are kappas."""
        return sum(condition.unknowns for condition in self.conditions)

    def split(self, u: Any) -> tuple[Any, list[Any]]:
        """z of the plane, and the kappa of each condition, 0 of one that has none."""
        size, pairs = self.plane.size, self.pairs
        own = iter(u[size : size + pairs])
        z = [*u[:size], *u[size + pairs :]]
        kappas = [next(own) if condition.unknowns else 0.0 for condition in self.conditions]
        return (np.array(z) if isinstance(u, np.ndarray) else z), kappas

    def joined(self, z: np.ndarray, kappas: Sequence[float]) -> np.ndarray:
        """U of a z of the plane, shape (N + 2,), and the kappas of the conditions that have one.

        With k of these it has the shape (N + 2 + k,).
        """
        size = self.plane.size
        return np.concatenate([z[:size], kappas, z[size:]])

    def criticals(self, place: Place, kappas: Sequence[Any]) -> list[Critical]:
        """Values and vectors of all conditions."""
        return [one.critical(place, kappa) for one, kappa in zip(self.conditions, kappas, strict=True)]

    def values(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, its Jacobian by U, and the rounding of the conditions.

        With N equations F and c numbers that vanish beside them, at U of shape (k,), the shapes are (N + c,),
        (N + c, k) and (c,).

        Raises
        ------
        numpy.linalg.LinAlgError
            Where the borders do not fit.
        """
        z, kappas = self.split(u)
        place = FloatPlace(self.plane, z)
        found = self.criticals(place, kappas)
        residual = np.concatenate([place.residual, *(np.array(one.values) for one in found)])
        size, pairs = self.plane.size, self.pairs
        jacobian = np.zeros((len(residual), len(u)))
        outside = [*range(size), *range(size + pairs, len(u))]
        jacobian[:size, outside] = place.jacobian
        row, own = size, size
        for condition, one, kappa in zip(self.conditions, found, kappas, strict=True):
            rows = slice(row, row + len(one.values))
            slopes = bordered.gradients(place, one, kappa)
            jacobian[rows, outside] = slopes[:, : size + 2]
            if condition.unknowns:
                jacobian[rows, own] = slopes[:, -1]
                own += 1
            row = rows.stop
        known = [bordered.levels(place, one, kappa) for one, kappa in zip(found, kappas, strict=True)]
        return residual, jacobian, np.concatenate(known)

    def exactly(self, u: Sequence[Any]) -> tuple[list[Any], ExactPlace, list[Critical], list[Any]]:
        """The residual with more digits, and with what it was computed."""
        z, kappas = self.split(list(u))
        place = ExactPlace(self.plane, z)
        found = self.criticals(place, kappas)
        return [*place.residual, *(v for one in found for v in one.values)], place, found, kappas


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
        z, kappas = augmented.split(u)
        place = FloatPlace(augmented.plane, z)
        return float(function(place, augmented.criticals(place, kappas)[0], kappas[0]))

    def residual(u: np.ndarray) -> np.ndarray:
        return np.append(augmented.values(u)[0], value(u))

    def jacobian(u: np.ndarray) -> np.ndarray:
        matrix = augmented.values(u)[1]
        scaled = matrix * scale
        tangent = np.linalg.svd(scaled / np.abs(scaled).max(axis=1, keepdims=True))[2][-1]
        ahead, behind = (value(u + sign * BESIDE * scale * tangent) for sign in (1.0, -1.0))
        return np.vstack([matrix, (ahead - behind) / (2.0 * BESIDE) * tangent / scale])

    def exactly(u: Sequence[Any]) -> list[Any]:
        values, place, found, kappas = augmented.exactly(u)
        return [*values, function(place, found[0], kappas[0])]

    return DefiningSystem(scale, residual, jacobian, exactly)
