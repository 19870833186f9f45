"""Where a step is to end: along the tangent, or at an end of the range that lies before that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.continuation import control
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.problems.problem import Sample


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
        if ahead != 0.0:
            bound = ends[1] if ahead > 0 else ends[0]
            left = (bound - sample.z[place]) / ahead
            nearest = min(nearest, (left, place, bound), key=lambda found: found[0])
    return nearest


def towards_a_bound(sample: Sample, settings: Settings) -> bool:
    """Whether what a branch moves along most is a parameter, towards an end of its range: no running off."""
    moved = np.abs(sample.tangent) / sample.weights
    place = int(np.argmax(moved[:-1])) - len(moved)
    ends = settings.bounds.get(place)
    return ends is not None and bool(np.isfinite(ends[1] if sample.tangent[place] > 0.0 else ends[0]))
