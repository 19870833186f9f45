"""Where a motion, or a branch of equilibria, crosses a place at which its field is smooth by pieces only.

A field that jumps there carries derivatives of the motion across by a matrix of its own (the saltation
matrix), which its equations do not have: derivatives are wrong, and with them all that is told of an orbit.
Where first derivatives jump, the motion's are right, and second ones are not; and so on
(M. di Bernardo et al., Piecewise-smooth Dynamical Systems, 2008, chapter 2). An instant that no unknown moves
leaves derivatives as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.fields.switching import Inputs, Switching
from contwalk.numerics.linear import EPSILON, SMALLEST
from contwalk.problems.kink import REMEDY, FieldKink, Met

# Parts that an interval is looked at in, and how often, to find where a choice changes in it.
PARTS, PASSES = 64, 5
# How wide a layer is, in parts of what is left of an interval of samples, at most.
WIDTHS = np.geomspace(EPSILON, 1.0, PARTS)
# So many times what a rounding changes is more than rounding.
KNOWN = 16.0
# A jump below this part of the field, and of its first and second derivatives, is rounding or meant as none.
JUMPS = (1e-6, 1e-6, 1e-5)
# How far to either side of an equilibrium that lies on a kink, against its size.
ASIDE = 1e-6
# The last steps of a motion that ends, among which such a place is looked for.
LATELY = 40
# Groups of inputs that are states.
STATES = ("u", "x")
# A change this near to an end of a leg is the event there.
AT_END = 1e-9
Evaluate = Callable[[np.ndarray, np.ndarray], Inputs]
# A time and a state.
Place = tuple[float, np.ndarray]
# The plugin's line, of two places, and of the `parameters` at both where they are not the same.
Where = Callable[..., str]


def inputs(groups: Mapping[str, int], values: np.ndarray, times: np.ndarray, states: np.ndarray) -> Inputs:
    """Inputs of a field over a closure or a leg: its scalars and parameters by their groups."""
    names = [(group, i) for group, size in groups.items() for i in range(size)]
    given: dict[tuple[str, int], Any] = dict(zip(names, values.tolist(), strict=True))
    return {**given, ("t", 0): times, **{("u", i): x for i, x in enumerate(states.T)}}


@dataclass(frozen=True)
class Course:
    """A motion, as it is looked at for kinks.

    Parameters
    ----------
    switching : Switching
    evaluate : callable
        Inputs of the field at times (k,) and states (k, n).
    times, states : ndarray, shapes (k,) and (k, n)
    at : callable
        States at times in growing order.
    where : callable
        The plugin's line.
    ends : bool
        Whether events happen at both ends.
    lines : dict
        Lines that have been told, by all choices on both sides, which they follow from.
    of : str
        What is looked at.
    """

    switching: Switching
    evaluate: Evaluate
    times: np.ndarray
    states: np.ndarray
    at: Callable[[np.ndarray], np.ndarray]
    where: Where
    ends: bool = False
    lines: dict[bytes, str] = field(default_factory=dict)
    of: str = "the field"

    @cached_property
    def sizes(self) -> np.ndarray:
        """How large each state is."""
        largest: np.ndarray = np.abs(self.states).max(axis=0)
        return largest

    @cached_property
    def level(self) -> np.ndarray:
        """How large each output is."""
        outputs = np.abs(self.switching.values(self.evaluate(self.times, self.states)))
        return np.asarray(np.nanmax(outputs, axis=0, initial=0.0))

    def line(self, sides: np.ndarray, times: np.ndarray, states: np.ndarray) -> str:
        """The plugin's line at which these sides, shape (2, choices), of two instants differ."""
        key = sides.tobytes()
        if key not in self.lines:
            self.lines[key] = self.where((times[0], states[0]), (times[1], states[1]))
        return self.lines[key]

    def sides(self, times: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Choices at some instants, shape (k, choices)."""
        found = self.switching.sides(self.evaluate(times, states))
        return np.broadcast_to(found, (len(times), found.shape[-1]))

    def changes(self) -> np.ndarray:
        """Which choices change from one sample to the next, shape (k - 1, choices)."""
        sides = self.sides(self.times, self.states)
        return differ(sides[:-1], sides[1:])


def along(course: Course) -> tuple[FieldKink, ...]:
    """The kinks of a motion."""
    low, high = _crossed(course)
    return tuple(dict.fromkeys(_kinks(course, low, high)))


def bends(course: Course) -> np.ndarray:
    """When choices change along a motion, away from events at its ends, in growing order, shape (k,).

    None of one that meets a jump of the field at an instant that depends on it: nothing is right there.
    """
    low, high = _crossed(course)
    if any(kink.refused for kink in _kinks(course, low, high)):
        return np.zeros(0)
    return 0.5 * (low + high)[_inside(course, low, high)]


def _inside(course: Course, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which of the places between two instants each are no event at an end of the motion."""
    return (high >= AT_END) & (low <= 1.0 - AT_END) if course.ends else np.ones(len(low), dtype=bool)


def differ(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Which choices are not the same on two sides; one that is undefined is like any."""
    return (a != b) & ~np.isnan(a) & ~np.isnan(b)


def located(course: Course, k: int) -> tuple[float, float]:
    """Two instants right beside each other, between which a choice changes in an interval of samples."""
    low, high = _located(course, np.array([k]))
    return float(low[0]), float(high[0])


def _crossed(course: Course) -> tuple[np.ndarray, np.ndarray]:
    """Instants right beside each other between which choices change, shapes (c,).

    In one interval of samples it is the first of them that is passed.
    """
    changed = course.changes()
    crossed = np.flatnonzero(np.any(changed, axis=1))
    if not len(crossed):
        return np.zeros(0), np.zeros(0)
    low, high = _located(course, crossed)
    first = differ(*(course.sides(times, course.at(times)) for times in (low, high)))
    suspect = ~np.any(first & changed[crossed], axis=1)
    places = zip(suspect, crossed.tolist(), low.tolist(), high.tolist(), strict=True)
    kept = np.array([not (odd and _is_layer(course, *place)) for odd, *place in places])
    return low[kept], high[kept]


def _is_layer(course: Course, k: int, low: float, high: float) -> bool:
    """Whether a choice that changes in an interval of samples does so for a layer so thin that it is nothing.

    A formula that is 0/0 at a place has another one beside it, and is the same on both sides.
    """
    end = float(course.times[k + 1])
    times = np.array([course.times[k], low, *(high + (end - high) * WIDTHS)])
    states = course.at(times)
    sides = course.sides(times, states)
    known, key = course.switching.layers, sides[[0, 2, -1]].tobytes()
    if key not in known:
        known[key] = _bearable(course, *(course.evaluate(times[[n]], states[[n]]) for n in (0, 1, 2, -1)))
    out = times[2 + int(np.argmin(np.any(differ(sides[2:], sides[-1:]), axis=1)))]
    return bool(out - low <= known[key] * (course.times[-1] - course.times[0]))


def _bearable(course: Course, before: Inputs, beside: Inputs, within: Inputs, after: Inputs) -> float:
    """The largest part of a motion that a layer is nothing on: what differs in it counts by that part.

    Zero where the field is not the same before and after it. What differs by no more than what it is one
    rounding further on is rounding.
    """
    switching, along_ = course.switching, directions(course.switching, before, course.sizes)
    one, other = switching.beside_each(before, before, after, along_, 1)
    moved = {name: value * (1.0 + EPSILON) for name, value in beside.items()}
    pieces, again = (switching.beside_each(at, beside, within, along_, 1)[:, 0] for at in (beside, moved))
    if not (np.array_equal(one, other) and np.all(np.isfinite(pieces))):
        return 0.0
    apart = np.abs(pieces[0] - pieces[1]) - KNOWN * np.abs(again - pieces).sum(axis=0)
    level = np.maximum(course.level, np.abs(pieces[:, 1]).max(axis=0))
    worst = float(np.max(apart / (np.array(JUMPS)[:, None] * np.maximum(level, SMALLEST))))
    return 1.0 / worst if worst > 0.0 else np.inf


def _located(course: Course, intervals: np.ndarray, backwards: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """As `located`, in several intervals of samples at once, in their order; `backwards` from their ends."""
    low, high = course.times[intervals], course.times[intervals + 1]
    if backwards:
        low, high = high, low
    every = np.arange(len(intervals))
    for _ in range(PASSES):
        times = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
        times = np.minimum(times, high[:, None])  # in growing order, rounding included
        sides = course.sides(times.ravel(), course.at(times.ravel())).reshape(*times.shape, -1)
        apart = np.any(differ(sides[:, :1], sides), axis=2)
        first = np.argmax(apart, axis=1)  # 0 where nothing changes any more
        high = np.where(first > 0, times[every, first], high)
        low = np.where(first > 0, times[every, first - 1], low)
    return low, high


def at_the_end(course: Course) -> str:
    """A sentence where a motion that could not go on went to and fro across a place of this kind."""
    last = slice(-LATELY, None)
    times, states = course.times[last], course.states[last]
    sides = course.sides(times, states)
    apart = np.flatnonzero(np.any(differ(sides[:-1], sides[1:]), axis=1)).tolist()
    if not apart:
        return ""
    k = apart[-1]
    where = course.where((times[k], states[k]), (times[k + 1], states[k + 1]))
    return (
        f" It crosses a place there at which the field is smooth by pieces only, or slides along it: {where}."
        f" {REMEDY} A motion that slides along it is a third mode."
    )


def between(
    switching: Switching,
    evaluate: Evaluate,
    ends: tuple[np.ndarray, np.ndarray],
    sizes: np.ndarray,
    where: Where,
) -> tuple[FieldKink, ...]:
    """The kinks that solutions cross between two of them, or that the second one lies on.

    `evaluate`: inputs of the equations at any numbers and unknowns z, shape (k, N + 1).
    """
    on_the_way = (met.kink for met in passed(switching, evaluate, ends, where))
    return tuple(dict.fromkeys([*on_the_way, *lying(switching, evaluate, ends[1], sizes, where)]))


def passed(
    switching: Switching, evaluate: Evaluate, ends: tuple[np.ndarray, np.ndarray], where: Where
) -> tuple[Met[FieldKink], ...]:
    """The kinks on the straight way between two solutions, shape (N + 1,), in their order; `evaluate` as of
    `between`.
    """
    course = straight(switching, evaluate, *ends, where)
    low, high = _crossed(course)
    return tuple(Met(kink, float(low[0])) for kink in _kinks(course, low, high))


def lying(
    switching: Switching, evaluate: Evaluate, at: np.ndarray, sizes: np.ndarray, where: Where
) -> tuple[FieldKink, ...]:
    """The kinks that a solution, shape (N + 1,), lies on; `evaluate` as of `between`."""
    aside = ASIDE * sizes * np.cos(1.0 + np.arange(len(at)))
    return tuple(met.kink for met in passed(switching, evaluate, (at - aside, at + aside), where))


def straight(
    switching: Switching, evaluate: Evaluate, begin: np.ndarray, end: np.ndarray, where: Where, parts: int = 1
) -> Course:
    """The straight way between two places, shape (n,), its parts in place of instants."""

    def at(shares: np.ndarray) -> np.ndarray:
        return begin + shares[:, None] * (end - begin)

    shares = np.linspace(0.0, 1.0, parts + 1)
    return Course(switching, evaluate, shares, at(shares), at, where)


def _kinks(course: Course, low: np.ndarray, high: np.ndarray) -> Iterator[FieldKink]:
    """What jumps between neighbouring instants, where something does that matters."""
    inside = _inside(course, low, high)
    low, high = low[inside], high[inside]
    count, switching = len(low), course.switching
    if not count:
        return
    times = np.stack([low, high], axis=1)
    states = course.at(times.ravel()).reshape(count, 2, -1)
    before, after = (course.evaluate(times[:, i], states[:, i]) for i in range(2))
    along_ = directions(switching, before, course.sizes)
    pieces = switching.beside_each(before, before, after, along_, count)
    sides = course.sides(times.ravel(), states.reshape(2 * count, -1)).reshape(count, 2, -1)
    for k in range(count):
        order = jumping(pieces[:, k], course.level)
        if order is None:
            continue
        moves = order > 0
        if not moves:
            changed = np.flatnonzero(differ(*sides[k])).tolist()
            moves = switching.moves(course.evaluate(times[k, :1], states[k, :1]), changed, along_)
        yield FieldKink(order, course.line(sides[k], times[k], states[k]), moves=moves)


def jumping(pieces: np.ndarray, level: np.ndarray) -> int | None:
    """The lowest derivative that differs on two sides, of shape (2, 3, outputs), against these levels."""
    if not np.all(np.isfinite(pieces)):
        return None
    level = np.maximum(level, np.abs(pieces[:, 1]).max(axis=0))
    apart = np.abs(pieces[0] - pieces[1])
    jumps = np.any(apart > np.array(JUMPS)[:, None] * level, axis=1)
    return int(np.argmax(jumps)) if jumps.any() else None


def directions(switching: Switching, at: Inputs, sizes: np.ndarray) -> Mapping[tuple[str, int], float]:
    """A direction in which every unknown moves, by a part of its size that differs from the others'."""
    result = {}
    for k, (group, i) in enumerate(switching.unknowns):
        size = sizes[i] if group in STATES else abs(float(np.ravel(at[group, i])[0]))
        result[group, i] = (float(size) or 1.0) * float(np.cos(1.0 + k))
    return result
