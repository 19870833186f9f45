"""Where watched numbers pass zero along a computed path, to rounding.

A path gives its steps; between their ends the dense output only says where to look. There the step is
taken anew with the length that ends at a trial instant, so that an event has the accuracy of the steps
themselves and not that of an interpolation. Within a step the guard is sampled. A crossing shows as a change
of sign; a pair of crossings as a guard that nears zero on one side and leaves it on the other (rates are
exact).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.events.guard import EPSILON, Guard, just_after
from contwalk.flow.integrate import along, dense

PARTS = 8  # of a step: a guard has at most one extremum in each
MOST_TRIALS = 80
LEFT = 2.0  # a guard has left zero where it is so many times what it began with of rounding
EXTREMUM = 1e-8  # of a part: the guard is then off its extremum by the square of it, that is by rounding
NONE_LEAVING: Mapping[int, int] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Crossing:
    """A guard passes zero.

    Parameters
    ----------
    guard : int
        Its position among those watched.
    step : int
        The step of the path that it lies in: from `times[step]` to `times[step + 1]`.
    time : float
    state : ndarray, shape (n,)
    rising : bool
        Which way the guard passes zero as time grows.
    rate : float
        Its rate there; zero to rounding where it only grazes.
    """

    guard: int
    step: int
    time: float
    state: np.ndarray
    rising: bool
    rate: float


@dataclass(frozen=True, eq=False)
class Event:
    """What happened at an instant of a motion.

    Parameters
    ----------
    name : str
    time : float
    rising : bool
    before, after : ndarray, shape (n,)
        The state on both sides; the same where nothing is reset.
    mode : str
        The mode after it.
    """

    name: str
    time: float
    rising: bool
    before: np.ndarray
    after: np.ndarray
    mode: str


@dataclass(frozen=True, eq=False)
class _Trial:
    """A guard at an instant within a step; `side` is the sign that it has just after it."""

    time: float
    state: np.ndarray
    value: float
    rate: float
    noise: float

    @property
    def side(self) -> int:
        sign = np.sign(self.value if self.value != 0.0 else self.rate)
        return int(sign) if sign == sign else 0  # none at a pole

    def towards(self, forward: int) -> bool:
        """Whether the guard nears zero as time goes forward (1) or back (-1)."""
        return self.value * self.rate * forward < 0.0


def crossings(
    field: CompiledField,
    c: np.ndarray,
    p: np.ndarray,
    times: np.ndarray,
    states: np.ndarray,
    guards: Sequence[Guard],
    method: str,
    leaving: Mapping[int, int] = NONE_LEAVING,
) -> list[Crossing]:
    """All crossings of the guards, in their directions, along the steps of a path, in the order of time.

    Parameters
    ----------
    field, c, p
        The field, its constants, and the parameters that they were made from.
    times : ndarray, shape (s + 1,)
        Growing.
    states : ndarray, shape (s + 1, n)
    guards : sequence of Guard
    method : str
        The one that made the path.
    leaving : mapping
        Guards that are zero but for rounding where the path begins, as after their own event: position ->
        the sign that they have just after it.
    """
    if len(times) < 2 or not guards:
        return []
    shares = np.arange(1, PARTS) / PARTS
    inner = times[:-1, None] + np.diff(times)[:, None] * shares
    between = dense(field, c, times, states, inner.ravel(), method).reshape(len(inner), PARTS - 1, -1)
    at = np.concatenate([times[:-1, None], inner, times[1:, None]], axis=1)
    x = np.concatenate([states[:-1, None], between, states[1:, None]], axis=1)
    instants = at.flatten(), x.reshape(at.size, -1)
    velocities = field.along(*instants, c)  # at instants that are common to all guards
    instants[0][0] = just_after(float(times[0]))
    found: list[Crossing] = []
    for number, guard in enumerate(guards):
        sampled = guard.along(*instants, p, velocities).reshape(*at.shape, 3)
        zero = _Zero()
        if number in leaving:
            zero = _held(leaving[number], at, sampled)
        suspects = _suspects(sampled)
        for step in np.flatnonzero(suspects.any(axis=1)):
            ends = (float(times[step]), float(times[step + 1])), (states[step], states[step + 1])
            locator = _Locator(_Step(field, c, p, method, *ends), guard, zero)
            found += [
                Crossing(number, int(step), trial.time, trial.state, rising, trial.rate)
                for trial, rising in locator.found(at[step], suspects[step])
                if guard.direction in (0, 1 if rising else -1)
            ]
    return sorted(found, key=lambda crossing: (crossing.time, crossing.guard))


@dataclass(frozen=True)
class _Zero:
    """What a guard that leaves zero begins with of rounding: its sign right after, how far that reaches, and
    the instant until which it has not left it.
    """

    side: int = 0
    band: float = 0.0
    until: float = -np.inf

    def holds(self, t: float, value: float) -> bool:
        return t <= self.until and abs(value) <= self.band


def _held(side: int, at: np.ndarray, sampled: np.ndarray) -> _Zero:
    """It, of a guard's samples: those that have not left it become zero, on their way to the side."""
    rows, band = sampled.reshape(-1, 3), LEFT * abs(float(sampled[0, 0, 0]))
    left = np.flatnonzero(~(np.abs(rows[:, 0]) <= band))
    count = max(int(left[0]), 1) if len(left) else len(rows)
    rows[:count, 0], rows[:count, 1] = 0.0, side
    return _Zero(side, band, float(at.ravel()[min(count, at.size - 1)]))


def _suspects(sampled: np.ndarray) -> np.ndarray:
    """For each step and part, whether a guard may pass zero: it changes its sign, or turns away from zero.

    The samples err a little, and so parts beside these may be the ones.
    """
    value, rate = sampled[..., 0], sampled[..., 1]
    side = np.sign(np.where(value != 0.0, value, rate))
    with np.errstate(all="ignore"):  # of a guard that is infinite somewhere
        changes = side[:, :-1] * side[:, 1:] <= 0.0
        turns = (value[:, :-1] * rate[:, :-1] < 0.0) & (value[:, 1:] * rate[:, 1:] > 0.0)
    suspect = changes | turns
    found = suspect.copy()
    found[:, 1:] |= suspect[:, :-1]
    found[:, :-1] |= suspect[:, 1:]
    return found


@dataclass(frozen=True, eq=False)
class _Step:
    """One step of a path: of which field at which parameters, by which method, and its ends."""

    field: CompiledField
    c: np.ndarray
    p: np.ndarray
    method: str
    times: tuple[float, float]
    states: tuple[np.ndarray, np.ndarray]

    def state(self, t: float) -> np.ndarray:
        """The state at an instant: the step is taken anew with the length that ends there."""
        for end, state in zip(self.times, self.states, strict=True):
            if t == end:
                return state
        return along(self.field, self.c, np.array([self.times[0], t]), self.states[0], self.method)[-1]


class _Locator:
    """Looks for the zeros of one guard within one step, by taking that step anew."""

    def __init__(self, step: _Step, guard: Guard, zero: _Zero) -> None:
        self._step, self._guard, self._held = step, guard, zero

    def _trial(self, t: float) -> _Trial:
        step, state = self._step, self._step.state(t)
        velocity = step.field.along(np.array([t]), state[None], step.c)
        instant = just_after(t) if t == step.times[0] else t
        value, rate, noise = self._guard.along(np.array([instant]), state[None], step.p, velocity)[0].tolist()
        if self._held.holds(t, value):
            value, rate = 0.0, float(self._held.side)
        return _Trial(t, state, value, rate, noise)

    def found(self, at: np.ndarray, suspects: np.ndarray) -> list[tuple[_Trial, bool]]:
        """The crossings in the parts that are suspect, each with whether the guard rises."""
        ends = np.append(suspects, False) | np.append(False, suspects)
        trials = [self._trial(float(t)) if end else None for t, end in zip(at, ends, strict=True)]
        result = []
        for (a, b), suspect in zip(pairwise(trials), suspects, strict=True):
            if not suspect or a is None or b is None:
                continue
            if a.side * b.side < 0:
                result.append((self._zero(a, b), b.side > 0))
            elif a.towards(1) and b.towards(-1):
                middle = self._beyond(a, b)
                if middle is not None:
                    result.append((self._zero(a, middle), middle.side > 0))
                    result.append((self._zero(middle, b), b.side > 0))
        return result

    def _zero(self, a: _Trial, b: _Trial) -> _Trial:
        """The zero between instants on different sides: Newton's method, bisection where it leaves them."""
        best = a if abs(a.value) < abs(b.value) else b
        for _ in range(MOST_TRIALS):
            if abs(best.value) <= best.noise and best.value != 0.0:
                break
            room = 2.0 * EPSILON * max(abs(a.time), abs(b.time))
            if b.time - a.time <= room:
                break
            t = best.time - best.value / best.rate if best.rate != 0.0 else np.nan
            if not a.time + room / 4 < t < b.time - room / 4:
                t = a.time + 0.5 * (b.time - a.time)
            new = self._trial(t)
            if abs(new.value) <= new.noise or not np.isfinite(new.value):  # or a pole has been met
                return new
            a, b = (new, b) if new.side == a.side else (a, new)
            best = min((a, b, new), key=lambda trial: abs(trial.value))
        return best

    def _beyond(self, a: _Trial, b: _Trial) -> _Trial | None:
        """An instant on the other side of zero between two that near it; None if the guard turns before."""
        narrow = EXTREMUM * (b.time - a.time)
        side = a.side
        share = 0.5
        for _ in range(MOST_TRIALS):
            if b.time - a.time <= narrow or _cannot(a, b):
                return None
            new = self._trial(a.time + share * (b.time - a.time))
            if new.side != side:
                return new
            if new.towards(1):
                a = new
            else:
                b = new
            # where the rate passes zero if it changes evenly, kept off the ends
            share = min(0.9, max(0.1, a.rate / (a.rate - b.rate))) if a.rate != b.rate else 0.5
        return None


def _cannot(a: _Trial, b: _Trial) -> bool:
    """Whether a guard that turns once between two instants is too far from zero for its rates there."""
    reach = 2.0 * max(abs(a.rate), abs(b.rate)) * (b.time - a.time)
    return min(abs(a.value), abs(b.value)) > reach
