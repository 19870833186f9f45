"""Instants at which guards jump, or their slopes do, whatever the states are: resets of ramps, pulses.

A ramp is a function of time alone, and so are the instants at which it begins anew. Steps that end there see
a guard on one smooth piece only, and both sides of it where it jumps: nothing is left to where steps happen
to lie.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from contwalk.fields.parameter_switching import ParameterSwitching
from contwalk.fields.switching import Switching
from contwalk.fields.trace import Program
from contwalk.flow.compiled.traced import PARAMETER, TIME
from contwalk.flow.events.guard import EPSILON

# Parts of a period that are told apart, and those of an interval of them in which a choice changes.
PARTS, PARTS_WITHIN = 1024, 64
MOST_PASSES = 16
# Periods are cut where nothing is likely to jump.
OFFSET = 0.3819660112501051
# Roundings of the time within which an instant is the one of a jump.
COINCIDE = 8.0
# Beside an extremum a number is the same to rounding for this part of a period.
FLAT = 1e-9


@dataclass(frozen=True)
class JumpInstant:
    """The last instant on one side and the first one on the other.

    Parameters
    ----------
    low, high : float
    """

    low: float
    high: float


def room(t: float) -> float:
    """How far an instant is from another one that may be the same."""
    return COINCIDE * EPSILON * abs(t)


class TimeChoices:
    """The choices of some functions that read the time, parameters, and nothing else.

    Parameters
    ----------
    programs : sequence of Program
        Of the time, states and parameters.
    """

    def __init__(self, programs: Sequence[Program]) -> None:
        time = (TIME, 0)
        found = [
            ParameterSwitching(Switching(program, [], time), {time}, {PARAMETER}).parameters
            for program in programs
            if program.reads(TIME)
        ]
        self._switchings = [switching for switching in found if switching.choices]

    def __bool__(self) -> bool:
        return bool(self._switchings)

    def at(self, times: np.ndarray, p: np.ndarray) -> np.ndarray:
        """What they are at instants, shape (k, choices)."""
        inputs = _inputs(times, p)
        return _joined([switching.sides(inputs) for switching in self._switchings], len(times))

    def numbers(self, times: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Numbers whose passing of a whole number changes them, shape (k, choices)."""
        inputs = _inputs(times, p)
        return _joined([switching.numbers(inputs) for switching in self._switchings], len(times))


def _inputs(times: np.ndarray, p: np.ndarray) -> dict[tuple[str, int], Any]:
    return {(PARAMETER, k): value for k, value in enumerate(p.tolist())} | {(TIME, 0): times}


def _joined(found: Sequence[np.ndarray], count: int) -> np.ndarray:
    return np.concatenate([np.broadcast_to(each, (count, each.shape[-1])) for each in found], axis=1)


class JumpInstants:
    """Instants at which choices of time alone change, at given parameters.

    Parameters
    ----------
    choices : TimeChoices
    p : ndarray, shape (m,)
    period : float
        Of the time's part of the machine: what changes for less than a thousandth of it is found where a
        compared number turns back once within that.
    """

    def __init__(self, choices: TimeChoices, p: np.ndarray, period: float) -> None:
        self._choices, self._p, self._period = choices, p, period
        self.within = lru_cache(maxsize=4)(self._found)

    def after(self, t: float, least: float) -> JumpInstant | None:
        """The first one that has its `low` at `least` or later; None if none comes in two periods."""
        number = int(np.floor(t / self._period - OFFSET))
        for window in range(number, number + 3):
            for jump in self.within(window):
                if jump.low >= least:
                    return jump
        return None

    def at(self, t: float) -> JumpInstant | None:
        """The one that is at an instant, but for rounding."""
        jump = self.after(t - 2.0 * room(t), t - room(t))
        return jump if jump is not None and jump.high <= t + room(t) else None

    def _found(self, window: int) -> list[JumpInstant]:
        """Those of one period; what comes at once, but for rounding, is one."""
        times = (window + OFFSET + np.arange(PARTS + 1) / PARTS) * self._period
        sides = self._choices.at(times, self._p)
        between = self._turning_back(times, sides)
        if between:
            times = np.sort(np.concatenate([times, between]))
            sides = self._choices.at(times, self._p)
        found: list[JumpInstant] = []
        for k in np.flatnonzero(np.any(_differ(sides[:-1], sides[1:]), axis=1)).tolist():
            low, end = float(times[k]), float(times[k + 1])
            while len(found) < PARTS * PARTS_WITHIN:
                jump = self._first(low, end)
                if jump is None:
                    break
                if found and jump.low - found[-1].high <= room(jump.low):
                    jump = JumpInstant(found.pop().low, jump.high)
                found.append(jump)
                low = jump.high
        return found

    def _turning_back(self, times: np.ndarray, sides: np.ndarray) -> list[float]:
        """Instants at which a choice is another one than at two neighbouring instants, shape (k,), alike.

        Between these the number that decides turns back beyond a whole number, which is no farther from it
        than it moves in a step.
        """
        numbers = self._choices.numbers(times, self._p)
        signs = np.sign(np.diff(numbers, axis=0))
        steps, off = np.abs(np.diff(numbers, axis=0)), np.abs(numbers - np.round(numbers))[1:-1]
        turns = (signs[:-1] > signs[1:]) | (signs[:-1] < signs[1:])
        turns &= off <= np.maximum(steps[:-1], steps[1:])
        turns &= ~_differ(sides[:-2], sides[1:-1]) & ~_differ(sides[1:-1], sides[2:])
        found = []
        for k, choice in np.argwhere(turns).tolist():
            upwards = float(signs[k, choice] or -signs[k + 1, choice])
            at = self._extremum(float(times[k]), float(times[k + 2]), choice, upwards, sides[k, choice])
            found += [] if at is None else [at]
        return found

    def _extremum(self, low: float, high: float, choice: int, upwards: float, side: float) -> float | None:
        """Where a number is largest between two instants (or least), if the choice is another one there."""
        for _ in range(MOST_PASSES):
            times = np.linspace(low, high, PARTS_WITHIN + 1)
            there = self._choices.at(times, self._p)[:, choice]
            other = np.flatnonzero((there != side) & ~np.isnan(there))
            if len(other):
                return float(times[other[0]])
            best = int(np.argmax(upwards * self._choices.numbers(times, self._p)[:, choice]))
            nearer = float(times[max(best - 1, 0)]), float(times[min(best + 1, PARTS_WITHIN)])
            if nearer == (low, high) or nearer[1] - nearer[0] <= FLAT * self._period:
                return None
            low, high = nearer
        return None

    def _first(self, low: float, high: float) -> JumpInstant | None:
        """The first change between two instants, to neighbouring numbers."""
        for _ in range(MOST_PASSES):
            times = np.minimum(low + (high - low) * (np.arange(PARTS_WITHIN + 1) / PARTS_WITHIN), high)
            times[-1] = high
            sides = self._choices.at(times, self._p)
            apart = np.any(_differ(sides[:1], sides), axis=1)
            if not apart.any():
                return None
            first = int(np.argmax(apart))
            if (low, high) == (times[first - 1], times[first]):
                break
            low, high = float(times[first - 1]), float(times[first])
        return JumpInstant(low, high)


def _differ(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Which choices are not the same; one that is undefined is like any."""
    return np.asarray((a != b) & ~np.isnan(a) & ~np.isnan(b))
