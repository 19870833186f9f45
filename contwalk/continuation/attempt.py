"""An attempt at a step: predicted, corrected, and what it passed on its way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from contwalk.continuation import kinks_passed
from contwalk.continuation.correction import Correction, Explanation
from contwalk.continuation.newton import correct
from contwalk.continuation.prediction import Prediction, along, predict
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.problems.kink import Met
from contwalk.problems.problem import Problem

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
        return kinks_passed.jump(self.passed)


@dataclass(frozen=True)
class Refusal:
    """Why an attempt is none: a reason code, in words; `instead`, the length to try next, if known."""

    reason: str
    explanation: Explanation
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
    passed = kinks_passed.between(problem, state, correction.z if correction.ok else prediction.guess)
    return Attempt(length, smallest, prediction, correction, passed)


def _corrected(
    problem: Problem, state: ContinuationState, prediction: Prediction, settings: Settings
) -> Correction:
    given = prediction.guess, prediction.normal, state.sample.weights, settings.newton_iterations
    return correct(problem, *given, beside=state.sample.z)
