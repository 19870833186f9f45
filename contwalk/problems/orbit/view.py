"""A solution looked at leg by leg: samples of its motion, the instants at which states turn.

Everything that is told of an orbit (margins, observables, the reported state) comes from the same samples.
Between two of them a turn shows in the signs of exact rates; where it lies the cubic through both ends
tells, and the state there is that of the integrator's own interpolation.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk import flow
from contwalk.memory import computed_once
from contwalk.numerics.distinct import distinct
from contwalk.problems.kinks import Course
from contwalk.problems.orbit.extrema import Smooth, sampled, turns, with_extrema
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece

# Samples of a closure that is one leg that observables are computed from, beside the integrator's own steps.
SAMPLES = 512


class LegView:
    """One leg of a solution, as it is integrated.

    Parameters
    ----------
    piece : Piece
        On all its steps, in times 0..1. Where one is repeated another segment begins, at a state of its own.
    x : ndarray, shape (n_i,)
        State of its mode at its start.
    scalars : ndarray, shape (k,)
    start, duration : float
        When it starts, and how long it lasts. Seconds.
    nodes : callable
        Its states at the steps, shape (s + 1, n_i).
    evenly : int
        Evenly spread instants at which its motion is looked at, beside the steps' own; 0 for parts of these.
    """

    def __init__(
        self,
        piece: Piece,
        x: np.ndarray,
        scalars: np.ndarray,
        start: float,
        duration: float,
        nodes: Callable[[], np.ndarray],
        evenly: int = 0,
    ) -> None:
        self.piece, self.x, self.scalars, self.start, self.duration = piece, x, scalars, start, duration
        self._integrated, self._evenly = nodes, evenly

    @computed_once
    def nodes(self) -> np.ndarray:
        """States at the steps, shape (s + 1, n_i); where two segments meet, that of the later one."""
        return self._integrated()

    @computed_once
    def values(self) -> np.ndarray:
        """What its functions depend on, shape (q,): scalars, the free parameter last, and fixed ones."""
        return self.piece.values(self.scalars)

    @computed_once
    def constants(self) -> np.ndarray:
        """What its field takes from them. Shape (c,)."""
        return self.piece.passage.field(PLAIN).constants(self.values)

    @computed_once
    def times(self) -> np.ndarray:
        """Sampled instants in 0..1, the steps' own among them. Shape (k,)."""
        return sampled(distinct(self.piece.steps))

    @computed_once
    def states(self) -> np.ndarray:
        """States of the mode at `times`, shape (k, n_i)."""
        return self.at(self.times)

    @computed_once
    def rates(self) -> np.ndarray:
        """Rates of the states over the leg's own time, shape (k, n_i)."""
        return self.rates_at(self.times, self.states)

    @computed_once
    def at(self) -> Callable[[np.ndarray], np.ndarray]:
        """States of the mode at any instants in 0..1 in growing order, a function of these.

        Times have the shape (k,), states (k, n_i).
        """
        field = self.piece.passage.field(PLAIN)
        return flow.interpolation(field, self.constants, self.piece.steps, self.nodes, self.piece.method)

    def rates_at(self, times: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Rates over the leg's own time at instants (k,) and states of the mode there, (k, n_i)."""
        return self.piece.passage.field(PLAIN).along(times, states, self.constants)

    @property
    def end(self) -> np.ndarray:
        """State of the mode at the end, before the transition. Shape (n_i,)."""
        return self.nodes[-1]

    def full(self, x: np.ndarray) -> np.ndarray:
        """States of the mode as states of the system. Shape (n_i,) or (k, n_i), and (n,) or (k, n)."""
        return self.piece.passage.full(x)

    @computed_once
    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Times in seconds and full states, with the instants at which a state is extreme.

        Shapes (k,) and (k, n).
        """
        times, states = self._seen()
        if self._evenly:
            times, states = with_extrema(self.at, times, states)
        elif len(extreme := _extrema(times, states, self.rates)):
            times = np.concatenate([times, extreme])
            states = np.concatenate([states, self.at(extreme)])
            order = np.argsort(times, kind="stable")
            times, states = times[order], states[order]
        return self.start + self.duration * times, self.full(states)

    @computed_once
    def smooth(self) -> Smooth:
        """The leg in 0..1 with full states."""

        def at(times: np.ndarray) -> np.ndarray:
            return self.full(self.at(times))

        def rate_at(times: np.ndarray, states: np.ndarray) -> np.ndarray:
            own = np.ascontiguousarray(states[:, list(self.piece.passage.states)])
            return self.full(self.rates_at(times, own))

        return Smooth(self.times, self.full(self.states), self.full(self.rates), at, rate_at)

    def sampled(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Instants in 0..1, at least `number` of them evenly spread and the steps' own, and states there.

        Shapes (k,) and (k, n_i).
        """
        steps, even = self.piece.steps, np.linspace(0.0, 1.0, number + 1)
        even = even[even != steps[np.searchsorted(steps, even)]]
        times, states = np.concatenate([steps, even]), np.concatenate([self.nodes, self.at(even)])
        order = np.argsort(times, kind="stable")
        return times[order], states[order]

    def course(self) -> list[Course]:
        """The leg as it is looked at for kinks of its field, where it may have any and lasts."""
        passage = self.piece.passage
        if passage.switching is None or not self.duration > 0.0:
            return []
        course = passage.course(self.values, *self._seen(), self.at)
        return [] if course is None else [course]

    def _seen(self) -> tuple[np.ndarray, np.ndarray]:
        """Instants in 0..1 at which its motion is looked at, and states there."""
        return self.sampled(self._evenly) if self._evenly else (self.times, self.states)


def _extrema(t: np.ndarray, x: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Instants at which a state turns, in growing order, from times (k,), states and rates (k, n)."""
    k, j = np.nonzero(r[:-1] * r[1:] < 0.0)
    return distinct(turns(t[k], t[k + 1], x[k, j], x[k + 1, j], r[k, j], r[k + 1, j]))
