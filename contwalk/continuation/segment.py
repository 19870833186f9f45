"""The piece of a branch between two neighbouring solutions, any point of which can be computed."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property

import numpy as np

from contwalk.continuation.correction import Correction
from contwalk.continuation.newton import correct
from contwalk.numerics.hermite_curve import HermiteCurve
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Linearization, Problem, Sample

# Near a branch point solutions are known to rounding over their distance from it, and along a branch that
# turns there eigenvalues move by its square: at this distance, in the metric, that is far more.
APART = 1e-4
# A solution and its position on a segment.
Placed = tuple[float, Sample]


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

    @cached_property
    def error(self) -> float:
        """The larger error of its ends, in the metric; that of a branch point is not known."""
        return max((each.error for each in (self.a, self.b) if math.isfinite(each.error)), default=0.0)

    @cached_property
    def size(self) -> float:
        """Of the solution at its beginning, in the metric."""
        return norm_in(self.a.z, self.weights)

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

    def between(self, low: float, high: float) -> Segment:
        """The part of the segment between two positions."""
        a, b = self.at(low), self.at(high)
        return Segment(self.problem, a, b)

    def distance(self, z: np.ndarray, theta: float) -> float:
        """Distance of z from the solution at theta, relative to the length of the segment.

        What is watched at a solution has its price, and is not asked for here.
        """
        known = self._known.get(theta)
        there = self._corrected(self.problem, self.guess(theta))[0].z if known is None else known.z
        return norm_in(there - z, self.weights) / max(self.length, 1e-300)
