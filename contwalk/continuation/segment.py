"""The piece of a branch between two neighbouring solutions, any point of which can be computed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from contwalk.continuation.correction import Correction
from contwalk.continuation.newton import correct
from contwalk.numerics import cubic
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Linearization, Problem, Sample

# Near a branch point solutions are known to rounding over their distance from it, and along a branch that
# turns there eigenvalues move by its square: at this distance, in the metric, that is far more.
APART = 1e-4
# How often a part is halved: a cubic of values and rates at its ends is 16 times as good each time.
HALVINGS = 6
# A solution and its position on a segment.
Placed = tuple[float, Sample]
# What is asked of a solution.
Function = Callable[[Sample], float]


class LostBranch(Exception):
    """A point inside the segment could not be computed."""


class Segment(HermiteCurve):
    """Solutions between samples `a` and `b`, by position theta in 0..1 along the chord.

    `problem` is remeshed where its discretisation does not reach one of them.
    """

    def __init__(self, problem: Problem, a: Sample, b: Sample) -> None:
        super().__init__((a.z, b.z), (a.tangent, b.tangent), a.weights)
        self.problem, self.a, self.b = problem, a, b
        self._known: dict[float, Sample] = {0.0: a, 1.0: b}

    def beside(self, share: float) -> float:
        """How far from a branch point its sides are looked at, in parts of the segment: `share`, or APART."""
        return min(max(share, APART / self.length), 1.0)

    @property
    def places(self) -> list[float]:
        """Positions of the solutions that are known already, in their order."""
        return sorted(self._known)

    @property
    def vertical(self) -> bool:
        """Whether the parameter stands still all along the segment."""
        return self.a.still and self.b.still

    def tangent(self, linearization: Linearization) -> np.ndarray:
        """Tangent of the branch, shape (N + 1,), pointing along the chord, at a solution on it.

        Exactly at a branch point it is not determined; there the chord stands in for it.
        """
        try:
            return linearization.tangent(self.normal, self.weights)
        except np.linalg.LinAlgError:
            return self.chord

    def at(self, theta: float) -> Sample:
        """The solution at theta.

        Raises
        ------
        LostBranch
            If the corrector does not converge there.
        """
        if theta not in self._known:
            near = min(self._known, key=lambda t: abs(t - theta))
            found, linearization = self._corrected(self.problem, self.guess(theta))
            self.problem, tangent = found.problem, self.tangent(linearization)
            unstable = self._known[near].unstable
            self._known[theta] = self.problem.examine(found.z, tangent, self.weights, linearization, unstable)
        return self._known[theta]

    def nearly(self, theta: float) -> Sample:
        """A sample at theta whose z is that of the arc, nearly a solution; all else is another's."""
        if theta in self._known:
            return self._known[theta]
        return replace(self.a, z=self.guess(theta), tangent=self.direction(theta))

    def near(self, theta: float) -> Sample:
        """The solution at theta, or the arc's where the corrector finds none, as beside a branch point."""
        try:
            return self.at(theta)
        except LostBranch:
            return self.nearly(theta)

    def _corrected(self, problem: Problem, guess: np.ndarray) -> tuple[Correction, Linearization]:
        """The solution in the hyperplane across the chord through a guess."""
        correction = correct(problem, guess, self.normal, self.weights)
        if not correction.ok or correction.linearization is None:
            raise LostBranch(correction.sentence)
        return correction, correction.linearization

    def on(self, problem: Problem, theta: float) -> Sample:
        """The solution at theta on another discretisation.

        Raises
        ------
        LostBranch
            If the corrector does not converge there.
        """
        found, linearization = self._corrected(problem, self.at(theta).z)
        tangent = self.tangent(linearization)
        return found.problem.examine(found.z, tangent, self.weights, linearization, None)

    def until(self, theta: float) -> Segment:
        """The part of the segment before theta."""
        there = self.at(theta)
        return Segment(self.problem, self.a, there)

    def since(self, theta: float) -> Segment:
        """The part of the segment behind theta."""
        there = self.at(theta)
        return Segment(self.problem, there, self.b)

    def distance(self, z: np.ndarray, theta: float) -> float:
        """Distance of z from the solution at theta, relative to the length of the segment.

        What is watched at a solution has its price, and is not asked for here.
        """
        known = self._known.get(theta)
        there = self._corrected(self.problem, self.guess(theta))[0].z if known is None else known.z
        return norm_in(there - z, self.weights) / max(self.length, 1e-300)


def dip_between(
    segment: Segment, low: Placed, high: Placed, value: Function, rate: Function, corner: bool = False
) -> float | None:
    """Where between two solutions a function that is positive at both may be least, as `dip` has it.

    Its rate, by arclength, has a price: behind it is asked for only where the function falls before.
    """
    values, rates = [value(sample) for _, sample in (low, high)], list[float]()
    if not min(values) > 0.0:
        return None
    for (_, sample), way in ((low, -1.0), (high, 1.0)):
        rates.append((high[0] - low[0]) * segment.length * rate(sample))
        if not way * rates[-1] > 0.0:
            return None
    return cubic.dip(values, rates, corner)


def looked_for(
    segment: Segment,
    low: Placed,
    high: Placed,
    place: Callable[[Placed, Placed], float | None],
    found: Callable[[Sample], bool],
    halvings: int = HALVINGS,
) -> Iterator[float]:
    """Positions between two solutions at which something is `found`.

    Parameters
    ----------
    place : callable
        Where between two solutions it may be, in parts of what lies between them; None where it cannot be.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    share = place(low, high) if halvings else None
    if share is None:
        return
    theta = low[0] + share * (high[0] - low[0])
    middle = theta, segment.at(theta)
    if found(middle[1]):
        yield theta
        return
    yield from looked_for(segment, low, middle, place, found, halvings - 1)
    yield from looked_for(segment, middle, high, place, found, halvings - 1)
