"""An attempt at a step: predicted, corrected, and what it passed on its way.

Where equations change their piece within a step, that ends a branch, or is only told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np

from contwalk.continuation import control
from contwalk.continuation.correction import Correction, Explanation
from contwalk.continuation.newton import correct
from contwalk.continuation.segment import Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.problems.kink import Met
from contwalk.problems.problem import Problem, Sample

# Part of a step by which Newton's method begins beside the parameter of a branch point.
ASIDE = 1e-3


@dataclass(frozen=True)
class Attempt:
    """A step of one length: where it was to end, where the corrector led, and the kinks that it passed.

    `smallest`: no shorter one is tried.
    """

    length: float
    smallest: bool
    prediction: Prediction
    correction: Correction
    passed: Sequence[Met]

    @property
    def jump(self) -> Met | None:
        """The first of what it passed beyond which no branch goes on."""
        return first_jump(self.passed)

    @property
    def room(self) -> float:
        """How long it may be, having passed a jump, before a shorter one is none any more.

        Where a slope has no bound what is solved for beside it is rounding: its own distance counts there.
        """
        jump = self.jump
        return self.length * jump.share if jump is not None and jump.kink.order else self.length

    @property
    def _of(self) -> str:
        return "equilibria" if self.correction.problem.meshed is None else "orbits"

    def why_no_further(self, jump: Met) -> str:
        """In a sentence, why no branch goes on beyond what it passed."""
        return jump.kink.refusal(self._of).sentence

    def switchings(self) -> str:
        """In a sentence, the first place that it passed at which equations change; empty if none."""
        return next((met.kink.sentence(self._of) for met in self.passed), "")

    def with_kinks(self, segment: Segment) -> Segment:
        """A segment whose end tells of what is passed on the way to it."""
        if not self.passed:
            return segment
        kinks = (*segment.b.kinks, *(met.kink for met in self.passed))
        there = replace(segment.b, kinks=tuple(dict.fromkeys(kinks)))
        return Segment(segment.problem, segment.a, there)


def first_jump(passed: Sequence[Met]) -> Met | None:
    """The first of what is passed beyond which no branch goes on."""
    return next((met for met in passed if met.kink.refused), None)


class Cause(Enum):
    """What makes an attempt no step: the solution itself, where it lies, or what lies on the way to it."""

    NO_SOLUTION = auto()  # none is found, or its equations have no value
    TURNS = auto()  # the branch turns too much, ends beyond what is allowed, or another branch is met
    PARABOLA = auto()  # it turns as the parabola does that a branch begins as
    BLURRED = auto()  # it turns within the error of where it ends
    PARENT = auto()  # it ends on the branch that this one has left
    UNDECIDED = auto()  # the tests do not agree, or what they see cannot be located


@dataclass(frozen=True)
class Refusal:
    """Why an attempt is none: a cause, and in words; of solutions that are not there, their reason code.

    `instead` is the length to try next, if known.
    """

    cause: Cause
    explanation: Explanation
    reason: str = ""
    instead: float | None = None


def attempt(problem: Problem, state: ContinuationState, length: float, settings: Settings) -> Attempt:
    """The attempt of a length, or of the smallest that there is."""
    smallest = length <= settings.min_step
    length = max(length, settings.min_step)
    prediction = predict(state, length, settings)
    correction = _corrected(problem, state, prediction, settings)
    if prediction.to_bound and not correction.ok:
        # The branch may turn before the end of the range: along its own tangent it is regular.
        prediction = along(state, length)
        correction = _corrected(problem, state, prediction, settings)
    sample = state.sample
    if not correction.ok and sample.orientation == 0.0 and sample.tangent[-1] == 0.0:
        # Where more than two branches meet, equations may be singular all along one at this parameter.
        guess = prediction.guess.copy()
        guess[-1] += ASIDE * length * float(sample.weights[-1])
        correction = _corrected(problem, state, replace(prediction, guess=guess), settings)
    # Newton's method may fail because it is asked for a solution beyond a jump.
    passed = problem.diagnosis.passed(sample.z, correction.z if correction.ok else prediction.guess)
    return Attempt(length, smallest, prediction, correction, passed)


def _corrected(
    problem: Problem, state: ContinuationState, prediction: Prediction, settings: Settings
) -> Correction:
    given = prediction.guess, prediction.normal, state.sample.weights, settings.newton_iterations
    return correct(problem, *given, beside=state.sample.z)


@dataclass(frozen=True)
class Prediction:
    """A guess, the normal of the corrector's hyperplane through it, and how far it is along the tangent."""

    guess: np.ndarray
    normal: np.ndarray
    length: float
    bounded: int | None = None

    @property
    def to_bound(self) -> bool:
        """Whether it is at an end of the range of the parameter that is number `bounded` of z."""
        return self.bounded is not None


def predict(state: ContinuationState, length: float, settings: Settings) -> Prediction:
    """The point at `length` along the tangent; an end of the range that lies before it is met exactly."""
    sample = state.sample
    length = min(length, control.longest(sample, settings))
    left, place, bound = nearest_bound(sample, settings)
    if left > 1.001 * length:  # a remainder of a thousandth of a step is not left over
        return along(state, length)
    guess = sample.z + left * sample.tangent
    guess[place] = bound
    normal = np.zeros(len(guess))
    normal[place] = 1.0 / sample.weights[place]
    return Prediction(guess, normal, left, place)


def along(state: ContinuationState, length: float) -> Prediction:
    """The point at `length` along the tangent."""
    sample = state.sample
    return Prediction(sample.z + length * sample.tangent, sample.tangent / sample.weights**2, length)


def nearest_bound(sample: Sample, settings: Settings) -> tuple[float, int, float]:
    """How far along the tangent the first end of a range is, its parameter's place in z, and its value."""
    nearest = (np.inf, -1, np.nan)
    for place, ends in settings.bounds.items():
        ahead = sample.tangent[place]
        bound = ends[1] if ahead > 0 else ends[0]
        left = (bound - sample.z[place]) / ahead if ahead != 0.0 else np.inf
        nearest = (left, place, bound) if left < nearest[0] else nearest
    return nearest


def towards_a_bound(sample: Sample, settings: Settings) -> bool:
    """Whether what a branch moves along most is a parameter, towards an end of its range: no running off."""
    moved = np.abs(sample.tangent) / sample.weights
    place = int(np.argmax(moved[:-1])) - len(moved)
    ends = settings.bounds.get(place)
    return ends is not None and bool(np.isfinite(ends[1] if sample.tangent[place] > 0.0 else ends[0]))
