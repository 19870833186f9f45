"""Orbits of a curve in two parameters: how they are read from its unknowns, and compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Self

import numpy as np

from contwalk.problems.locus.orbit_curve import OrbitCurve
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.problem import Mirror
from contwalk.problems.sample import Sample

# Of two solutions that are one, parameters and periods differ by less than this part of their magnitude, or
# by what they are known to.
SAME_SECOND = 1e-6
# Orbits are known to this, in the metric: a chord may be off by a fiftieth of it, and steps are a hundredth
# long where orbits change fast. Where steps of the walk's tolerance make larger errors they are finer.
KNOWN = 1e-4


class CurveOfOrbits:
    """Unknowns z = (u, v, second, first), shape (N + k + 2,): of the orbit, of the curve, both parameters.

    Parameters
    ----------
    plane : OrbitPlane
    curve : OrbitCurve
    """

    def __init__(self, plane: OrbitPlane, curve: OrbitCurve) -> None:
        self.plane, self.curve = plane, curve

    @property
    def orbit(self) -> Any:
        """The orbit on these steps, at no place of the plane."""
        return self.plane.orbit

    @property
    def size(self) -> int:
        """Number of unknowns without the first parameter."""
        return self.plane.size + self.curve.further + 1

    @property
    def mesh(self) -> Any:
        """The steps of this discretisation."""
        return self.orbit.mesh

    @property
    def method(self) -> str:
        """How motions are integrated, and why so."""
        return str(self.orbit.method)

    @property
    def evaluations(self) -> int:
        """Right-hand sides evaluated so far."""
        return int(self.orbit.evaluations)

    def at_kinks(self, z: np.ndarray) -> Self:
        """Itself: orbits look after their own steps. z has the shape (N + k + 2,)."""
        return self

    def further(self, z: np.ndarray) -> np.ndarray:
        """What z, shape (N + k + 2,), has beside the orbit's unknowns and both parameters, shape (k,)."""
        return z[len(z) - 2 - self.curve.further : len(z) - 2]

    def genuine(self, z: np.ndarray) -> bool:
        """Whether anything bifurcates at z, shape (N + k + 2,): not at neutral saddles."""
        return self.curve.genuine(self.further(z))

    def of_orbit(self, z: np.ndarray) -> np.ndarray:
        """Unknowns of the orbit with the first parameter, shape (N + 1,), of z or of weights like it."""
        return np.append(z[: len(z) - 2 - self.curve.further], z[-1])

    def stored(self, z: np.ndarray) -> tuple[Any, np.ndarray]:
        """As `OrbitPlane.first`, of a stored solution that may have other segments; `finely` fits the orbit.

        z has the shape (N + k + 2,), the unknowns of the orbit (N + 1,).
        """
        return self.plane.on_lines(z)[0], self.of_orbit(z)

    def joined(self, own: np.ndarray, like: np.ndarray) -> np.ndarray:
        """Unknowns of the orbit, shape (N,), with what a vector of the curve has beside them."""
        return np.concatenate([own, like[len(like) - 2 - self.curve.further :]])

    def values_of(self, z: np.ndarray) -> dict[str, float]:
        """All parameters at z, shape (N + k + 2,), by name."""
        return self.plane.values_of(z)

    def reported(self, z: np.ndarray) -> np.ndarray:
        """The state that stands for the orbit, shape (n,)."""
        there, own = self.plane.first(z)
        return np.asarray(there.reported(own))

    def margins(self, z: np.ndarray) -> Any:
        """Values of all limits of the orbit at z, shape (N + k + 2,), which must have some."""
        there, own = self.plane.first(z)
        return there.margins(own)

    def nearest_turn(self, z: np.ndarray, near: np.ndarray) -> np.ndarray:
        """The same solution with its angles turned as near as possible to those of another one.

        All have the shape (N + k + 2,).
        """
        return self.joined(self.orbit.nearest_turn(self.of_orbit(z), self.of_orbit(near))[:-1], z)

    @property
    def whole(self) -> tuple[str, int]:
        """How the orbit closes (`full`, or the name of a symmetry), and how many closures its period has."""
        found: tuple[str, int] = self.orbit.whole
        return found

    def duration(self, z: np.ndarray) -> float:
        """Duration of the closure, seconds.

        z has the shape (N + k + 2,).
        """
        there, own = self.plane.first(z)
        return float(there.duration(own))

    def duration_gradient(self, z: np.ndarray) -> np.ndarray:
        """Derivatives of the duration by the unknowns of an orbit and the first parameter, as z is.

        z has the shape (N + k + 2,).
        """
        there, own = self.plane.first(z)
        gradient, found = there.duration_gradient(own), np.zeros(len(z))
        found[: self.plane.size], found[-1] = gradient[:-1], gradient[-1]
        return found

    def first_state(self, z: np.ndarray) -> np.ndarray:
        """The state at the start, shape (n,)."""
        there, own = self.plane.first(z)
        return np.asarray(there.first_state(own))

    def first_passed(self, z: np.ndarray, points: Sequence[np.ndarray], error: float = 0.0) -> int | None:
        """Number of the first of some states that the orbit of z passes; None if it passes none.

        z has the shape (N + k + 2,), each point (n,). `error` is that of the points, against their size.
        """
        there, own = self.plane.first(z)
        found: int | None = there.first_passed(own, points, error)
        return found

    def same(self, a: Sample, b: Sample) -> bool:
        """Whether two solutions at the same first parameter are one; `b` is on this discretisation.

        Both are known to their errors, and lie apart along the curve by what these make of the parameter.
        """
        way = self.way(b.z, b.tangent, b.weights)
        apart = np.append((b.z - a.z)[-2:] / b.weights[-2:], (b.period - a.period) / b.period)
        ahead = float(apart @ way) / (float(way @ way) or 1.0)
        known = max(SAME_SECOND, float(np.nan_to_num(min(a.error + b.error, KNOWN))))
        if np.linalg.norm(apart - ahead * way) > known:
            return False
        there = self.plane.first(b.z)[0]
        first, second = (replace(s, z=self.of_orbit(s.z), weights=self.of_orbit(s.weights)) for s in (a, b))
        return bool(there.same(first, second, known + abs(ahead)))

    def way(self, z: np.ndarray, tangent: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """How both parameters and the period change along a tangent, shape (3,): in whatever segments orbits
        are.

        z, tangent and weights have the shape (N + k + 2,).
        """
        rate = float(self.duration_gradient(z) @ tangent) / self.duration(z)
        return np.append(tangent[-2:] / weights[-2:], rate)

    def mirror(self, sample: Sample) -> Mirror | None:
        """Both halves of a curve are walked."""
        return None
