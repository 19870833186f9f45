"""Doubled orbits beside a point of a curve of doublings, and curves of their bifurcations born there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.numerics.linear import kernel_direction
from contwalk.problems.locus.orbit_curves import CURVES
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
# orbits are measured, so many times and up to this amplitude, in typical magnitudes;
LEAST, MOST = 0.1, 6.0
MEASURED, FAR = 3, 1.0
# and what is found is what is expected where its amplitude is that by these.
SMALLER, LARGER = 0.7, 1.4


class DoubledOrbits:
    """The orbits that are born at a doubling, by their amplitude.

    Parameters
    ----------
    problem : OrbitLocus
        The curve of doublings.
    z : ndarray, shape (N + 2,)
        One of its solutions.
    origin : ndarray, shape (2,)
        The second and the first parameter at the point that a curve is born at.
    """

    def __init__(self, problem: Any, z: np.ndarray, origin: np.ndarray) -> None:
        self._curve, self._z, self._origin = problem, z, origin
        orbit, own = problem.plane.first(z)
        (self._seed,) = orbit.finely(own).doubled_from(own)
        self.problem: Any = self._seed.problem
        self._sizes = filled_magnitudes(self.problem, self._seed.z)
        self._sizes[-1] = problem.weights[-1]
        assert self._seed.tangent is not None
        self._swing = self._seed.tangent / np.linalg.norm(self._seed.tangent / self._sizes)

    @property
    def free(self) -> float:
        """The first parameter at the doubling."""
        return float(self._seed.z[-1])

    def of(self, amplitude: float) -> np.ndarray:
        """The doubled orbit of an amplitude, shape (M + 1,).

        Raises
        ------
        ContwalkError, LinAlgError
            If there is none.
        """
        guess = self._seed.z + amplitude * self._swing
        return newton_on(self.problem, guess, self._sizes, self._swing / self._sizes**2)

    def curve(self, label: str, expected: float, further: Sequence[float] = ()) -> Seed | None:
        """The curve of a bifurcation of the doubled orbits, begun at that of the expected amplitude.

        `further` are the unknowns that the curve has beside the orbit's. None if there is none of about that
        amplitude.
        """
        guess = self.of(expected)
        first = np.concatenate([guess[:-1], [self._z[-2]], guess[-1:]])
        there, place = OrbitPlane(self.problem, self._curve.plane.free).first(first)
        made = there.finely(place)
        near = np.concatenate([guess[:-1], further, first[-2:]])
        sizes = [filled_magnitudes(made, place)[:-1], np.ones(len(further)), self._curve.weights[-2:]]
        weights = np.concatenate(sizes)
        curve = self._curve.on(made, near, weights, CURVES[label])
        swing, n = self._swing[:-1], len(guess) - 1
        held = np.concatenate([swing, np.zeros(len(near) - n)]) / weights**2
        solved = newton_on(curve, near, weights, held)
        amplitude = float(held[:n] @ (solved[:n] - self._seed.z[:-1])) / float(held[:n] @ swing)
        if not SMALLER * expected < amplitude < LARGER * expected:
            return None
        # Towards the point itself doubled orbits shrink to the single one: only the other way is walked.
        away = kernel_direction(curve.jacobian(solved), weights)
        away = away * (np.sign(float((away / weights**2)[-2:] @ (solved[-2:] - self._origin))) or 1.0)
        return Seed(label, solved, away, None, curve, one_sided=True)


def found_beside(
    problem: Any, point: SpecialPoint, born: Callable[[DoubledOrbits, float], Seed | None]
) -> Sequence[Seed]:
    """What is born beside a point of a curve of doublings, at the first place that has it; else none.

    `born` is asked with the doubled orbits to both sides of the point, and the amplitude to begin at.
    """
    z = np.array(point.unknowns)
    there, own = problem.stored(z)
    orbit = there.finely(own)
    weights = np.concatenate([filled_magnitudes(orbit, own)[:-1], problem.weights[-2:]])
    # The borders of the curve's beginning need not fit here.
    curve = problem.on(orbit, z, weights)

    def of_doubled(beside: np.ndarray, aside: float) -> Seed | None:
        return born(DoubledOrbits(curve, beside, z[-2:]), AMPLITUDE * aside**0.5)

    return born_beside(curve, z, curve.weights, ASIDE, of_doubled)


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
