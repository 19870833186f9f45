"""Where what stands in the vector of unknowns of an orbit, and in its equations.

Unknowns of an orbit of legs: the states at the starts of the legs, each as long as its mode has states; the
legs' durations; of a forced system the time at which the first leg starts; a drift for each pinned direction;
the free parameter.
Equations: each leg's end is the next one's start; each leg ends where its guard is zero; of a forced system
the durations add up to whole periods; each pinned direction is held.

A leg over which deviations grow is cut into segments of equal duration. The states at their starts, but for
the first one's, are unknowns too; that a segment ends where the next one starts are as many equations. Both
stand behind the others, in the same order, before the free parameter: what belongs to whole legs stands where
it does without them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

# Segments at least where times of cuts are chosen after some of equal duration.
LEAST_CHOSEN = 9


@dataclass(frozen=True)
class Segment:
    """A part of a leg, from share `begin` to share `end` of its duration.

    `states` is where its start stands among the unknowns, `ends` where its end among the equations, and
    `following` where the state stands that this end is.
    """

    leg: int
    begin: float
    end: float
    states: slice
    ends: slice
    following: slice

    @property
    def last(self) -> bool:
        """Whether it ends with the leg's event."""
        return self.end == 1.0


class Positions(ABC):
    """Positions of unknowns and equations.

    Attributes
    ----------
    legs, sizes, cuts
        Number of legs, of states of each, and of its segments.
    size
        Number of unknowns without the free parameter, which comes last.
    segments
        All segments, leg by leg.
    states, matches
        Starts of the legs among the unknowns, their ends among the equations.
    durations, drifts, rest
        Durations, drifts along pinned directions, and all that is no state, among the unknowns.
    start
        The time at which the first leg starts, where it is unknown.
    guards, phase, sum, held
        Where the equations of events begin; those of the phase and of the period of a force, if there are
        any; where those of pinned directions begin.
    exact
        The equations that no motion is integrated for.
    inside, times
        Where times of cuts stand, among the unknowns and the equations, and what holds them, if they do.
    """

    legs: int
    sizes: tuple[int, ...]
    cuts: tuple[int, ...]
    size: int
    segments: list[Segment]
    states: list[slice]
    matches: list[slice]
    durations: slice
    drifts: slice
    rest: slice
    exact: slice
    inside: slice
    times: np.ndarray | None = None
    guards: int
    held: int
    start: int | None
    phase: int | None
    sum: int | None

    def segments_of(self, i: int) -> list[Segment]:
        """The segments of a leg."""
        first = sum(self.cuts[:i])
        return self.segments[first : first + self.cuts[i]]

    def filled(
        self,
        other: Positions,
        vector: np.ndarray,
        states: Sequence[np.ndarray],
        inside: np.ndarray | float,
        lasting: np.ndarray | None = None,
    ) -> np.ndarray:
        """Unknowns, or something of each, in these segments, of a vector of the same legs in others.

        Parameters
        ----------
        other : Positions
        vector : ndarray, shape (N + 1,)
            Of `other`.
        states : sequence of ndarray, shape (n_i,)
            What stands at the starts of all segments.
        inside : ndarray or float
            What stands in the place of times of cuts, where these are unknowns.
        lasting : ndarray, optional
            What stands in the place of durations, where the legs are others.
        """
        result = np.zeros(self.size + 1)
        result[self.durations] = vector[other.durations] if lasting is None else lasting
        result[self.drifts] = vector[other.drifts]
        if self.start is not None:
            result[self.start] = vector[other.start]
        if self.times is not None:
            result[self.inside] = inside
        for segment, x in zip(self.segments, states, strict=True):
            result[segment.states] = x
        result[-1] = vector[-1]
        return result

    @abstractmethod
    def inputs(self, i: int, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `inputs_of`, of a whole leg."""

    @abstractmethod
    def inputs_of(self, segment: Segment, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """State and scalars of a segment, of z or of a direction like it.

        Shapes (n_i,) and (k,) of z, shape (N + 1,).
        """

    @abstractmethod
    def along(self, segment: Segment, rows: np.ndarray) -> np.ndarray:
        """Derivatives by a segment's inputs, (r, n_i + k), as derivatives by z, (r, N + 1)."""

    @abstractmethod
    def inside_of(self, segment: Segment, shares: np.ndarray) -> np.ndarray:
        """Instants of a leg, shape (k,), 0 to 1, in the times of a segment's steps."""


class ClosureLayout(Positions):
    """Positions for a smooth orbit: one leg, whose segments are in times of the closure.

    Unknowns: states at the starts of the segments; the period, of autonomous systems; a drift for each pinned
    direction; the free parameter. All but the states belong to all segments alike.

    Parameters
    ----------
    states : int
    forced : bool
    pins : int
    cuts : int
        Number of segments.
    times : ndarray, shape (cuts,), optional
        Times at which they start, if these are chosen. They then stand among the unknowns, but for the
        first, behind the drifts, and are held by an equation each: a stored solution tells what it was solved
        on.
    """

    def __init__(
        self, states: int, forced: bool, pins: int, cuts: int, times: np.ndarray | None = None
    ) -> None:
        total, timed = cuts * states, int(not forced)
        shared = total + timed + pins
        places = [slice(i * states, (i + 1) * states) for i in range(cuts)]
        self.legs, self.sizes, self.cuts, self.size = 1, (states,), (cuts,), shared
        self.others = timed + pins + 1
        self.states, self.matches = places[:1], places[-1:]
        self.scalars: slice | np.ndarray = slice(total, None)
        self.durations, self.drifts = slice(total, total + timed), slice(total + timed, shared)
        self.times, begins = times, np.arange(cuts) / cuts
        if times is not None:
            begins, self.size = times, shared + cuts - 1
            self.scalars = np.append(np.arange(total, shared), self.size)
        self.begins, self.inside = begins, slice(shared, self.size)
        self.rest = self.exact = slice(total, self.size)
        self.guards, self.held = total, total + timed
        self.start, self.sum, self.phase = None, None, None if forced else total
        following = places[1:] + places[:1]
        self.segments = [
            Segment(0, begin, end, own, own, there)
            for (begin, end), own, there in zip(
                pairwise([*begins.tolist(), 1.0]), places, following, strict=True
            )
        ]

    def inputs(self, i: int, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `inputs_of`, of the whole leg. Shapes (n,) and (k,) of z, shape (N + 1,)."""
        return self.inputs_of(self.segments[0], z)

    def inputs_of(self, segment: Segment, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """State and scalars of a segment, of z or of a direction like it.

        Shapes (n_i,) and (k,) of z, shape (N + 1,).
        """
        return z[segment.states], z[self.scalars]

    def along(self, segment: Segment, rows: np.ndarray) -> np.ndarray:
        """Derivatives by a segment's inputs, (r, n + k), as derivatives by z, (r, N + 1)."""
        n, result = segment.states.stop - segment.states.start, np.zeros((len(rows), self.size + 1))
        result[:, segment.states], result[:, self.scalars] = rows[:, :n], rows[:, n:]
        return result

    def inside_of(self, segment: Segment, shares: np.ndarray) -> np.ndarray:
        """The same instants, shape (k,): steps are in times of the closure."""
        return shares

    def joined(self, states: np.ndarray, scalars: np.ndarray, cuts: np.ndarray | float = 0.0) -> np.ndarray:
        """A vector of unknowns, or of something of each, in any number m of segments, from its parts.

        Parameters
        ----------
        states : ndarray, shape (m, n) or (m n,)
        scalars : ndarray, shape (k,)
        cuts : ndarray, shape (m,), or float
            The times at which segments start; or what stands in the place of all these.
        """
        flat = np.ravel(states)
        if self.times is None:
            return np.concatenate([flat, scalars])
        inner = np.broadcast_to(cuts, len(flat) // self.sizes[0])[1:]
        return np.concatenate([flat, scalars[:-1], inner, scalars[-1:]])


def times_chosen(z: np.ndarray, states: int, others: int) -> np.ndarray | None:
    """The times of cuts that stand in an orbit z, (N + 1,), of such states and other unknowns, shape (m,).

    None where its segments are of equal duration: chosen ones are so many that no other solution of this
    length ends in such times, which grow between 0 and 1.
    """
    m, left = divmod(len(z) - others + 1, states + 1)
    if left or m < LEAST_CHOSEN:
        return None
    times = np.append(0.0, z[len(z) - m : -1])
    return times if np.all(np.diff(np.append(times, 1.0)) > 0.0) else None


class Layout(Positions):
    """Positions for an orbit of legs, each in its own time.

    Parameters
    ----------
    sizes : sequence of int
        Number of states of each leg.
    forced : bool
    pins : int
    cuts : sequence of int, optional
        Number of segments of each leg; one by default.
    """

    def __init__(
        self, sizes: Sequence[int], forced: bool, pins: int, cuts: Sequence[int] | None = None
    ) -> None:
        self.sizes, self.forced, self.pins = tuple(sizes), forced, pins
        self.legs = m = len(sizes)
        ends = np.cumsum([0, *sizes])
        total = int(ends[-1])
        self.states = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self.durations = slice(total, total + m)
        self.start = total + m if forced else None
        first = total + m + int(forced)
        self.drifts = slice(first, first + pins)
        self.rest = slice(self.durations.stop, first + pins)
        # Equations: a leg's end has as many as the next leg has states.
        following = [sizes[(i + 1) % m] for i in range(m)]
        rows = np.cumsum([0, *following])
        self.matches = [slice(int(a), int(b)) for a, b in pairwise(rows)]
        self.guards = total
        self.phase = total + m - 1  # of a last leg that no event ends
        self.sum = total + m if forced else None
        self.held = first
        self.exact = slice(total + m, self.rest.stop)
        self.cuts = (1,) * m if cuts is None else tuple(cuts)
        places = np.cumsum([first + pins, *(n * (c - 1) for n, c in zip(sizes, self.cuts, strict=True))])
        self.inner = [self._inner(i, int(places[i])) for i in range(m)]
        self.inside = slice(first + pins, int(places[-1]))
        self.size = self.inside.stop
        self.segments = [segment for i in range(m) for segment in self._segments(i)]

        self._local = [self._positions(i) for i in range(m)]

    def _inner(self, i: int, first: int) -> list[slice]:
        n = self.sizes[i]
        return [slice(first + j * n, first + (j + 1) * n) for j in range(self.cuts[i] - 1)]

    def _segments(self, i: int) -> list[Segment]:
        count, inner = self.cuts[i], self.inner[i]
        starts, ends = [self.states[i], *inner], [*inner, self.matches[i]]
        following = [*inner, self.states[(i + 1) % self.legs]]
        return [
            Segment(i, j / count, (j + 1) / count, *places)
            for j, places in enumerate(zip(starts, ends, following, strict=True))
        ]

    def _positions(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        own = np.concatenate(
            [
                np.arange(self.states[i].start, self.states[i].stop),
                [self.durations.start + i],
                np.arange(self.drifts.start, self.drifts.stop),
                [self.size],
            ]
        ).astype(int)
        before = np.arange(self.durations.start, self.durations.start + i)
        return own, np.append(before, self.start).astype(int) if self.start is not None else before[:0]

    def local(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Positions in z of leg i's own inputs (states, T, drifts, parameter), and of the summands of s."""
        return self._local[i]

    def spread(self, i: int, rows: np.ndarray) -> np.ndarray:
        """Derivatives by a leg's inputs, (r, n_i + k), as derivatives by z, (r, N + 1)."""
        own, before = self.local(i)
        n, result = self.sizes[i], np.zeros((len(rows), self.size + 1))
        kept = np.delete(rows, n + 1, axis=1) if self.forced else rows
        result[:, own] = kept
        if self.forced:
            result[:, before] = rows[:, n + 1, None]
        return result

    def inputs(self, i: int, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A leg's state and scalars (T, s, drifts, parameter), of z or of a direction like it.

        Shapes (n_i,) and (k,) of z, shape (N + 1,).
        """
        own, before = self.local(i)
        n, values = self.sizes[i], z[own]
        if not self.forced:
            return values[:n], values[n:]
        return values[:n], np.concatenate([values[n : n + 1], [z[before].sum()], values[n + 1 :]])

    def along(self, segment: Segment, rows: np.ndarray) -> np.ndarray:
        """Derivatives by a segment's inputs, (r, n_i + k), as derivatives by z, (r, N + 1)."""
        i = segment.leg
        if self.cuts[i] == 1:
            return self.spread(i, rows)
        n, rows = self.sizes[i], rows.copy()
        rows[:, n] *= segment.end - segment.begin
        if self.forced:
            rows[:, n] += segment.begin * rows[:, n + 1]
        result, place = self.spread(i, rows), self.states[i]
        result[:, place] = 0.0
        result[:, segment.states] = rows[:, :n]
        return result

    def inputs_of(self, segment: Segment, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `inputs`, of a segment: its own state, duration, and starting time."""
        i = segment.leg
        x, scalars = self.inputs(i, z)
        if self.cuts[i] == 1:
            return x, scalars
        lasting, scalars = scalars[0], scalars.copy()
        scalars[0] = (segment.end - segment.begin) * lasting
        if self.forced:
            scalars[1] += segment.begin * lasting
        return z[segment.states], scalars

    def inside_of(self, segment: Segment, shares: np.ndarray) -> np.ndarray:
        """Instants of a leg, shape (k,), 0 to 1, in a segment's own time, 0 to 1."""
        cuts = self.cuts[segment.leg]
        return shares if cuts == 1 else (shares - segment.begin) * cuts


def joined(segments: Sequence[Segment], steps: Sequence[np.ndarray]) -> np.ndarray:
    """Times of a leg's steps, 0..1, from those of its segments."""
    parts = [
        own.begin + (own.end - own.begin) * times[:-1] for own, times in zip(segments, steps, strict=True)
    ]
    return np.append(np.concatenate(parts), 1.0)
