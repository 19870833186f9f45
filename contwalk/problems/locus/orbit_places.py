"""Orbits at places of the plane of two parameters, on the lines through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.problems.locus.lines import along_parameter, along_tangent
from contwalk.problems.locus.valued import Valued
from contwalk.problems.orbit.augmented import Augmented
from contwalk.problems.orbit.evaluations import Evaluations

# Places whose lines are kept: a step asks for the same ones several times.
MOST_KEPT = 12


class OrbitPlane:
    """Orbits of one discretisation at all values of two parameters.

    A vector of a curve is z = (u, v, second, first): unknowns of the orbit, shape (N,), further ones of the
    curve, shape (k,), and both parameters.

    Parameters
    ----------
    orbit : PeriodicOrbit or HybridOrbit
        One whose functions are compiled for both parameters moving: see `lines.whole_plane`.
    free : tuple of str
        The first and the second parameter.
    """

    def __init__(self, orbit: Any, free: tuple[str, str]) -> None:
        self.orbit, self.free = orbit, free
        self._known = Evaluations()

    @property
    def size(self) -> int:
        """Number N of unknowns of the orbit."""
        return int(self.orbit.size)

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, by name.

        z has the shape (N + k + 2,).
        """
        first, second = self.free
        return {**self.orbit.parameters, first: float(z[-1]), second: float(z[-2])}

    def on_lines(self, z: np.ndarray) -> tuple[Any, Any]:
        """The orbit on the lines through z along the first and along the second parameter.

        z has the shape (N + k + 2,).
        """
        place = z[[-1, -2]]

        def made() -> tuple[Any, Any]:
            values = self.values_of(z)
            first, second = (self._on(along_parameter(values, self.free, which)) for which in (0, 1))
            return first, second

        return self._known.at("lines", place, MOST_KEPT, made)

    def on_tangent(self, z: np.ndarray, tangent: np.ndarray) -> Any:
        """The orbit on the line through z along which both parameters change as along a tangent, at zero.

        z and the tangent have the shape (N + k + 2,).
        """
        rates = float(tangent[-1]), float(tangent[-2])
        key = np.array([*z[[-1, -2]], *rates])
        return self._known.at(
            "tangents", key, MOST_KEPT, lambda: self._on(along_tangent(self.values_of(z), self.free, rates))
        )

    def _on(self, line: Any) -> Any:
        return self.orbit.varied(line=line, free=line.free)

    def first(self, z: np.ndarray) -> tuple[Any, np.ndarray]:
        """The orbit at z on the line along the first parameter, and its unknowns there, shape (N + 1,)."""
        return self.on_lines(z)[0], np.append(z[: self.size], z[-1])


@dataclass(frozen=True, eq=False)
class Held:
    """A condition, and where its further unknowns stand in the vector that it is evaluated at.

    `further` has the shape (k,).
    """

    system: Augmented | Valued
    further: np.ndarray

    def over(
        self, plane: OrbitPlane, z: np.ndarray, own: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual of the orbit's equations with the condition, and its derivatives as of `Valued.over`.

        z is a vector of the curve, shape (N + j + 2,), `own` are the further unknowns, shape (k,).
        """
        if isinstance(self.system, Valued):
            return self.system.over(plane, z, own)
        n, (first, second) = plane.size, plane.on_lines(z)
        place = np.concatenate([z[:n], z[-1:], own])
        residual, jacobian, other = self.system.over(first, second, place, float(z[-2]))
        return residual, np.column_stack([jacobian[:, :n], other, jacobian[:, n]]), jacobian[:, n + 1 :]


def evaluated(
    plane: OrbitPlane, width: int, y: np.ndarray, held: Sequence[Held]
) -> tuple[np.ndarray, np.ndarray]:
    """Residual and Jacobian of the orbit's equations with conditions, by all of y.

    Parameters
    ----------
    plane : OrbitPlane
    width : int
        How many entries of y are a vector of the curve: further unknowns of a point of it stand behind.
    y : ndarray, shape (width + r,)
    held : sequence of Held
        At least one. The orbit's own equations are those of the first; what others unfold is added to them.
    """
    n, z = plane.size, y[:width]
    places = [*range(n), width - 2, width - 1]
    rows: list[np.ndarray] = []
    values: list[np.ndarray] = []
    for condition in held:
        own = y[condition.further]
        residual, by_place, by_own = condition.over(plane, z, own)
        block = np.zeros((len(residual), len(y)))
        block[:, places], block[:, condition.further] = by_place, by_own
        if not rows:
            rows, values = [block], [residual]
            continue
        if isinstance(condition.system, Valued):
            values[0][:n] += condition.system.unfolding @ own
            rows[0][:n][:, condition.further] = block[:n, condition.further]
        values.append(residual[n:])
        rows.append(block[n:])
    return np.concatenate(values), np.vstack(rows)
