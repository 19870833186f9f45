"""A closure without events looked at as a leg: samples of its motion, and where states turn."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.memory import computed_once
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.extrema import PARTS, Smooth, with_extrema
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.solution import Curve

# Samples of an orbit that observables are computed from, beside the integrator's own steps.
SAMPLES = 512


class ClosureView:
    """The integrated part of an orbit without events: a `View`.

    Parameters
    ----------
    piece : Piece
        The last of its segments.
    curve : Curve
    values : ndarray
        What the leg's functions depend on: scalars and fixed parameters.
    duration : float
        Seconds.
    """

    start = 0.0

    def __init__(self, piece: Piece, curve: Curve, values: np.ndarray, duration: float) -> None:
        self.piece, self.curve, self.duration, self.values = piece, curve, duration, values

    @computed_once
    def constants(self) -> np.ndarray:
        """What its field takes from them. Shape (c,)."""
        return self.piece.passage.field(PLAIN).constants(self.values)

    @property
    def x(self) -> np.ndarray:
        """State at its start, shape (n,)."""
        return self.curve.nodes[0]

    @property
    def end(self) -> np.ndarray:
        """State at its end, shape (n,)."""
        return self.curve.nodes[-1]

    @property
    def at(self) -> Callable[[np.ndarray], np.ndarray]:
        """States, shape (k, n), at any instants in 0..1 in growing order, a function of these."""
        return self.curve.at

    @computed_once
    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Times in seconds, shape (k,), and states, with the instants at which one is extreme."""
        times, states = with_extrema(self.curve.at, *self.curve.sampled(SAMPLES))
        return self.duration * times, states

    @computed_once
    def smooth(self) -> Smooth:
        """The closure in 0..1."""
        times, states = self.curve.divided(PARTS)
        return Smooth(times, states, self.curve.rates(times, states), self.curve.at, self.curve.rates)

    def sampled(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Instants in 0..1, at least `number` of them evenly spread and the steps' own, and states there.

        Shapes (k,) and (k, n).
        """
        return self.curve.sampled(number)

    def course(self) -> list[Course]:
        """The closure as it is looked at for kinks of its field, where it may have any."""
        passage = self.piece.passage
        if passage.switching is None:
            return []
        course = passage.course(self.values, *self.curve.sampled(SAMPLES), self.curve.at)
        return [] if course is None else [course]

    def full(self, x: np.ndarray) -> np.ndarray:
        """All states exist. Shape (n,) or (k, n)."""
        return x
