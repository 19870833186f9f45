"""Doubled orbits beside a point of a curve of doublings, and curves of their bifurcations born there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.locus.orbit_curves import CURVES
from contwalk.problems.locus.orbit_locus import OrbitLocus
from contwalk.problems.locus.orbit_places import OrbitPlane
from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.problem import Seed
from contwalk.problems.solving import newton_on

# How far along the curve of doublings the first doubled orbit is looked for, in the metric: last so near that
# those of a map that folds strongly, with periods doubled before, are still small, and that another special
# point of the curve right beside this one is farther away.
ASIDE = (1e-2, 3e-2, 3e-3, 1e-1, 3e-4, 1e-4, 3e-5, 1e-5)
# The amplitude of the first of two orbits, over the root of that.
AMPLITUDE = 0.3
# What is looked for is expected no farther from that amplitude than by these factors; where it is, two other
# orbits are measured, so many times and up to this amplitude, in typical magnitudes.
LEAST, MOST = 0.1, 6.0
MEASURED, FAR = 3, 1.0


class BornOrbits:
    """Orbits that are born at a bifurcation, by their amplitude.

    Parameters
    ----------
    problem : PeriodicOrbit or HybridOrbit
    rest : ndarray, shape (M + 1,)
        What they are born from, as one of them.
    direction : ndarray, shape (M + 1,)
        The way to them.
    sizes : ndarray, shape (M + 1,)
        Typical magnitudes: the amplitude is the length in these.
    free : tuple of str
        Both parameters.
    typical : ndarray, shape (2,)
        Typical magnitudes of the second and the first one.
    """

    # What is found is what is expected where its amplitude is that by these factors.
    within: ClassVar[tuple[float, float]]

    def __init__(
        self,
        problem: Any,
        rest: np.ndarray,
        direction: np.ndarray,
        sizes: np.ndarray,
        free: tuple[str, str],
        typical: np.ndarray,
    ) -> None:
        self.problem, self.rest, self.sizes = problem, rest, sizes
        self.unit = float(np.linalg.norm(direction / sizes))
        self.swing = direction / self.unit
        self.free, self.typical = free, typical

    def place_of(self, z: np.ndarray) -> np.ndarray:
        """The second and the first parameter at an orbit, shape (2,); z has the shape (M + 1,)."""
        raise NotImplementedError

    def of(self, amplitude: float) -> np.ndarray:
        """The orbit of an amplitude, shape (M + 1,).

        Raises
        ------
        ContwalkError, LinAlgError
            If there is none.
        """
        guess = self.rest + amplitude * self.swing
        return newton_on(self.problem, guess, self.sizes, self.swing / self.sizes**2)

    def curve(
        self,
        label: str,
        orbit: np.ndarray,
        expected: float,
        origin: np.ndarray,
        further: Sequence[float] = (),
    ) -> Seed | None:
        """The curve of a bifurcation of these orbits, begun at one of about the expected amplitude.

        `further` are the unknowns that the curve has beside the orbit's, `origin` the second and the first
        parameter at the point that it is born at, shape (2,). None where it has none of that amplitude.

        The orbit has the shape (M + 1,).
        """
        made, n = self.problem.finely(orbit), len(orbit) - 1
        near = np.concatenate([orbit[:-1], further, self.place_of(orbit)])
        weights = np.concatenate([filled_magnitudes(made, orbit)[:-1], np.ones(len(further)), self.typical])
        curve = OrbitLocus(OrbitPlane(made, self.free), CURVES[label], (near, weights))
        held = np.concatenate([self.swing[:-1], np.zeros(len(near) - n)]) / weights**2
        solved = newton_on(curve, near, weights, held)
        amplitude = float(held[:n] @ (solved[:n] - self.rest[:-1])) / float(held[:n] @ self.swing[:-1])
        smaller, larger = self.within
        if not smaller * expected < amplitude < larger * expected:
            return None
        # Towards the point itself the orbits shrink to what they are born from: only the other way is walked.
        away = kernel_direction(curve.jacobian(solved), weights)
        away = away * (np.sign(float((away / weights**2)[-2:] @ (solved[-2:] - origin))) or 1.0)
        return Seed(label, solved, away, None, curve, one_sided=True)


class DoubledOrbits(BornOrbits):
    """The orbits that are born at a doubling.

    Parameters
    ----------
    curve : OrbitLocus
        The curve of doublings.
    z : ndarray, shape (N + 2,)
        One of its solutions.
    """

    within = (0.7, 1.4)

    def __init__(self, curve: Any, z: np.ndarray) -> None:
        orbit, own = curve.plane.first(z)
        (seed,) = orbit.finely(own).doubled_from(own)
        sizes = filled_magnitudes(seed.problem, seed.z)
        sizes[-1] = curve.weights[-1]
        super().__init__(seed.problem, seed.z, seed.tangent, sizes, curve.plane.free, curve.weights[-2:])
        self._second = float(z[-2])

    def place_of(self, z: np.ndarray) -> np.ndarray:
        """The second parameter stays; z has the shape (M + 1,)."""
        return np.array([self._second, z[-1]])


def found_beside(
    problem: Any, point: SpecialPoint, born: Callable[[DoubledOrbits, float, np.ndarray], Seed | None]
) -> Sequence[Seed]:
    """What is born beside a point of a curve of doublings, at the first place that has it; else none.

    `born` is asked with the doubled orbits to both sides of the point, the amplitude to begin at, and both
    parameters of the point, shape (2,).
    """
    z = np.array(point.unknowns)
    there, own = problem.stored(z)
    orbit = there.finely(own)
    weights = np.concatenate([filled_magnitudes(orbit, own)[:-1], problem.weights[-2:]])
    # The borders of the curve's beginning need not fit here.
    curve = problem.on(orbit, z, weights)
    found = lambda beside, r: born(DoubledOrbits(curve, beside), AMPLITUDE * r**0.5, z[-2:])  # noqa: E731
    return born_beside(curve, z, curve.weights, ASIDE, found)


def born_beside(
    problem: Any,
    z: np.ndarray,
    weights: np.ndarray,
    lengths: Sequence[float],
    born: Callable[[np.ndarray, float], Seed | None],
) -> Sequence[Seed]:
    """What is born beside a point z, shape (N + 1,), of a curve, at the first place that has it; else none.

    `born` is asked at solutions to both sides, with how far aside they are in the metric of the weights.
    """
    tangent = kernel_direction(problem.linearize(z).jacobian, weights)
    # One and the same side first, from whichever curve the point is come to.
    tangent = tangent * np.sign(tangent[np.argmax(np.abs(tangent / weights))])
    for aside in lengths:
        for sign in (1.0, -1.0):
            try:
                beside = newton_on(problem, z + sign * aside * tangent, weights, tangent / weights**2)
                found = born(beside, aside)
            except (ContwalkError, np.linalg.LinAlgError):
                continue
            if found is not None:
                return [found]
    return []


def amplitude_of_neutral(growth: Callable[[float], float], r: float) -> float | None:
    """The amplitude at which nu + p r^2, the growth beside orbits of the amplitude r, passes zero."""

    def squared(r: float) -> float:
        near, far = growth(r), growth(2.0 * r)
        p = (far - near) / (3.0 * r**2)
        return r**2 - near / p if p else 0.0

    return amplitude_near(squared, r)


def amplitude_near(squared: Callable[[float], float], r: float) -> float | None:
    """The amplitude that two orbits tell, of amplitudes r and 2 r, which may need to be others than r.

    `squared` is given r and returns its square. None where it is no square, or too far away.
    """
    for _ in range(MEASURED):
        found = squared(r)
        if not 0.0 < found < FAR**2:
            return None
        amplitude = float(np.sqrt(found))
        if LEAST * r < amplitude < MOST * r:
            return amplitude
        r = 0.5 * amplitude
    return None
