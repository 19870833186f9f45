"""What became of a guess that was corrected, and how much effort it took."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contwalk.numerics.linear import EPSILON
from contwalk.problems.problem import Linearization, Problem

# Corrections by the same Jacobian that cost about one by a new one.
CHORDS = 3

Explanation = str | Callable[[], str]
"""A sentence, or what makes it: most steps that fail are taken again, shorter, and nobody asks why."""


def text_of(explanation: Explanation) -> str:
    """The sentence itself."""
    return explanation if isinstance(explanation, str) else explanation()


@dataclass(frozen=True)
class Correction:
    """What became of a guess. `reason` is empty where it converged, else a reason code with a sentence.

    `problem` is whose solution it is: the given one, on a discretisation that reaches it. `sizes` are those
    of the first two corrections, in the metric; `chords` says whether the second was by the first one's
    Jacobian.
    """

    problem: Problem
    z: np.ndarray
    linearization: Linearization | None
    iterations: int
    reason: str = ""
    explanation: Explanation = ""
    sizes: tuple[float, ...] = ()
    chords: bool = False

    @property
    def sentence(self) -> str:
        """Why it did not converge."""
        return text_of(self.explanation)

    @property
    def ok(self) -> bool:
        """Whether z is a solution."""
        return not self.reason

    def tangent(self, normal: np.ndarray, weights: np.ndarray) -> np.ndarray | None:
        """The branch's tangent at the solution, shape (N + 1,) as the normal and the weights.

        None where there is no solution, or where its tangent is not determined, as at a branch point.
        """
        if not self.ok or self.linearization is None:
            return None
        try:
            return self.linearization.tangent(normal, weights)
        except np.linalg.LinAlgError:
            return None

    @property
    def effort(self) -> float:
        """How many corrections lead from the guess to the rounding unit, as a real number.

        The count itself hangs on last bits: whether one more is made is decided by rounding. The first two
        sizes d0 and d1 tell what follows. By one Jacobian each correction is d1 / d0 of the last one; by new
        ones the k-th is d0 (d1 / d0)^(2^k - 1) (P. Deuflhard, Newton Methods for Nonlinear Problems, 2004,
        section 2.1). It is never more than the count: near a singular point the first two hardly shrink.
        """
        count = float(self.iterations)
        first, second = self.sizes if len(self.sizes) == 2 else (0.0, 0.0)
        if not max(second, EPSILON) < first:
            return count
        contractions = math.log(EPSILON / first) / math.log(max(second, EPSILON) / first)
        newton = math.log2(1.0 + contractions)
        return min(count, newton, contractions / (1.0 + CHORDS) if self.chords else newton)
