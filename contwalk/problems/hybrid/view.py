"""A leg of an orbit through events looked at: guards and conditions beside its motion, on the same samples.

Where a guard turns shows in the signs of its exact rates, as it does for states.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.memory import computed_once
from contwalk.numerics.linear import EPSILON
from contwalk.problems.orbit.extrema import PARTS, cubics_at, turns
from contwalk.problems.orbit.layout import Segment
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.piece import Piece
from contwalk.problems.orbit.view import LegView
from contwalk.system import Transition

# A guard that leaves zero slowly may turn twice before the first sample: it is looked at earlier too, at
# these parts of that sample's instant. Where it is about to touch zero again at s it is near to t (s - t)^2,
# which turns at s / 3 and s: a factor of two does not pass over both.
EARLY = 2.0 ** -np.arange(4.0, 0.0, -1.0)


# Roundings of the time by which the ends of a leg are known.
INSIDE = 8.0
# The first two samples and the last two.
_ENDS = [0, 1, -2, -1]


class GuardedView(LegView):
    """One leg of a solution, with what is watched on it.

    Parameters
    ----------
    given
        As for `LegView`.
    left : collection of str
        Transitions whose guards are zero where it starts: those of the hard one that leads into it.
    segments : sequence of tuple (Segment, Piece, ndarray, ndarray)
        Its segments with their own pieces, states and scalars.
    """

    def __init__(
        self,
        *given: Any,
        left: Collection[str] = (),
        segments: Sequence[tuple[Segment, Piece, np.ndarray, np.ndarray]] = (),
    ) -> None:
        super().__init__(*given)
        self.segments = segments
        self.left = [k for k, t in enumerate(self.piece.passage.leaving) if t.name in left]

    def stepped(self, share: float) -> np.ndarray:
        """State of the mode at an instant in 0..1 to which the last step is cut: no interpolation.

        Shape (n_i,).
        """
        if len(self.segments) > 1:
            segment, piece, x, scalars = next(own for own in reversed(self.segments) if own[0].begin <= share)
            share = (share - segment.begin) / (segment.end - segment.begin)
            return _stepped(piece, x, scalars, share) if share > 0.0 else x
        return _stepped(self.piece, self.x, self.scalars, share)

    def guard(self, transition: Transition) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Instants in 0..1, a transition's guard there, and its rate over the leg's own time.

        Shape (k,) each.
        """
        k = self.piece.passage.leaving.index(transition)
        times, guards = self._early if k in self.left else (self.times, self._guards)
        return times, guards[:, 2 * k], guards[:, 2 * k + 1]

    @computed_once
    def _guards(self) -> np.ndarray:
        """All guards out of the mode with their rates, at the samples."""
        return self._watched(self.times, self.states, self.rates)

    @computed_once
    def sizes(self) -> list[tuple[float, float]]:
        """Largest moduli of each guard out of the mode and of its rate, at the instants of `guard`."""
        return self._merged(lambda guards: _pairs(np.abs(guards).max(axis=0).tolist()))

    @computed_once
    def ends(self) -> list[list[tuple[float, float]]]:
        """Each guard out of the mode and its rate, at the first two instants of `guard` and the last two."""
        return self._merged(lambda guards: list(zip(*map(_pairs, guards[_ENDS].tolist()), strict=True)))

    def samples(self, k: int) -> int:
        """How many instants of `guard` the k-th guard out of the mode has."""
        return len(self._early[0] if k in self.left else self.times)

    def _merged(self, told: Callable[[np.ndarray], list]) -> list:
        """What is told of each guard, by the samples that are its own."""
        found = told(self._guards)
        if self.left:
            early = told(self._early[1])
            found = [early[k] if k in self.left else own for k, own in enumerate(found)]
        return found

    def size_at_steps(self, transition: Transition) -> float:
        """Largest modulus of a transition's guard at the steps, from the samples that lie there.

        It need not lead out of the mode that the leg is in: the guard of one that does is sampled already.
        """
        leaving = self.piece.passage.leaving
        if transition not in leaving:
            return float(np.abs(self.guard_values(transition)).max())
        return self._sizes_at_steps[2 * leaving.index(transition)]

    @computed_once
    def _sizes_at_steps(self) -> list[float]:
        sizes: list[float] = np.abs(self._guards[::PARTS]).max(axis=0).tolist()
        return sizes

    @computed_once
    def _early(self) -> tuple[np.ndarray, np.ndarray]:
        """The samples with some before the first one, and all guards there."""
        early = self.times[1] * EARLY
        times = np.concatenate([self.times[:1], early, self.times[1:]])
        added = self._watched(early, self.at(early))
        return times, np.concatenate([self._guards[:1], added, self._guards[1:]])

    def _watched(self, times: np.ndarray, states: np.ndarray, rates: np.ndarray | None = None) -> np.ndarray:
        """All guards out of the mode, each with its rate, at some instants, shape (k, 2 g)."""
        passage, times = self.piece.passage, self._inside(times)
        try:
            guards = passage.guards()
        except UnsupportedOperation:  # together they compare too often; each alone does not
            each = [passage.watched(t.name, t.guard) for t in passage.leaving]
            return np.hstack([map_.along(times, states, self.values, rates) for map_ in each])
        return guards.along(times, states, self.values, rates)

    def _inside(self, times: np.ndarray) -> np.ndarray:
        """Instants in 0..1, the ends moved inside by roundings: a sawtooth of the time may begin anew."""
        if not self.piece.passage.forced or self.duration == 0.0:
            return times
        latest = max(abs(self.start), abs(self.start + self.duration))
        edge = min(INSIDE * EPSILON * max(latest / abs(self.duration), 1.0), 0.5)
        return np.clip(times, edge, 1.0 - edge)

    @computed_once
    def turning(self) -> list[list[tuple[int, float, float, float]]]:
        """Where each guard out of the mode turns: after which sample, when, value, rate before."""
        found: list[list[tuple[int, float, float, float]]] = [[] for _ in self.piece.passage.leaving]
        if self.left:
            others = [k for k in range(len(found)) if k not in self.left]
            each = _brackets(self.times, self._guards, others), _brackets(*self._early, self.left)
            brackets = [np.concatenate(parts) for parts in zip(*each, strict=True)]
        else:
            brackets = list(_brackets(self.times, self._guards))
        after, which, before = brackets[0], brackets[1], brackets[6]
        if not len(after):
            return found
        at = turns(*brackets[2:])
        states = self.at(at)
        at_rest = np.zeros_like(states)  # the guards' rates are not asked for
        values = self._watched(at, states, at_rest)[np.arange(len(at)), 2 * which]
        if (np.abs(values - cubics_at(at, brackets[2:])) > np.abs(values)).any():
            self._nearer(at, values, which, np.stack(brackets[2:]))
        entries = zip(after.tolist(), at.tolist(), values.tolist(), before.tolist(), strict=True)
        for number, entry in zip(which.tolist(), entries, strict=True):
            found[number].append(entry)
        return found

    def _nearer(self, at: np.ndarray, values: np.ndarray, which: np.ndarray, ends: np.ndarray) -> None:
        """Turns of some guards again, nearer by, where what a value is off its cubic hides its sign.

        Instants, values and numbers of guards have the shape (k,); `ends`, the times, values and rates before
        and behind, (6, k). Instants and values are replaced in place.
        """
        own, rounding = np.arange(len(at)), EPSILON * np.abs(ends[2:4]).max(axis=0)
        for _ in range(np.finfo(float).nmant):  # a guard with a kink halves its bracket at the best
            off = np.abs(values[own] - cubics_at(at[own], ends[:, own]))
            own = own[off > np.maximum(np.abs(values[own]), rounding[own])]
            if not len(own):
                return
            rates = self._watched(at[own], self.at(at[own]))[np.arange(len(own)), 2 * which[own] + 1]
            side = np.where(rates * ends[4, own] > 0.0, 0, 1)
            ends[side, own], ends[2 + side, own], ends[4 + side, own] = at[own], values[own], rates
            at[own] = turns(*ends[:, own])
            values[own] = self._watched(at[own], self.at(at[own]))[np.arange(len(own)), 2 * which[own]]

    @computed_once
    def conditions(self) -> dict[str, float]:
        """Values of the conditions at the leg's transition, by name."""
        passage, values = self.piece.passage, self.values
        if not passage.conditions:
            return {}
        try:
            maps = [passage.conditioned()]
        except UnsupportedOperation:
            maps = [passage.condition(c) for c in passage.conditions]
        found = np.concatenate([map_(1.0, self.end, map_.constants(values)) for map_ in maps])
        return dict(zip([c.name for c in passage.conditions], found.tolist(), strict=True))

    def guard_values(self, transition: Transition) -> np.ndarray:
        """A guard at the steps, shape (s + 1,)."""
        watched, nodes = self.piece.passage.watched(transition.name, transition.guard), self.nodes
        at_rest = np.zeros_like(nodes)  # its rate is not asked for, nor are theirs
        return watched.along(self.piece.steps, nodes, self.values, at_rest)[:, 0]


def _stepped(piece: Piece, x: np.ndarray, scalars: np.ndarray, share: float) -> np.ndarray:
    """State of a segment at an instant in 0..1 of it."""
    inside = piece.steps[piece.steps < share - 1e-12] / share
    shorter = replace(piece, steps=np.append(inside, 1.0))
    return shorter.before(PLAIN, x, np.concatenate([[scalars[0] * share], scalars[1:]]))


def _brackets(t: np.ndarray, guards: np.ndarray, which: list[int] | None = None) -> tuple[np.ndarray, ...]:
    """Where some guards turn, or all, between two of their samples: after which one, which guard, and the
    times, values and rates of both.

    Times have the shape (k,), guards with their rates (k, 2 g).
    """
    rates = guards[:, 1::2] if which is None else guards[:, [2 * k + 1 for k in which]]
    a, b = rates[:-1], rates[1:]
    k, g = (((a < 0.0) & (b >= 0.0)) | ((a > 0.0) & (b <= 0.0))).nonzero()
    own, after = g if which is None else np.array(which, dtype=g.dtype)[g], k + 1
    value, rate = 2 * own, 2 * own + 1
    ends = guards[k, value], guards[after, value], guards[k, rate], guards[after, rate]
    return k, own, t[k], t[after], *ends


def _pairs(row: list[float]) -> list[tuple[float, float]]:
    """Numbers two by two: each guard with its rate."""
    return list(zip(row[::2], row[1::2], strict=True))
