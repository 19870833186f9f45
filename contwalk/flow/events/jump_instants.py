"""Instants at which guards jump, or their slopes do, whatever the states are: resets of ramps, pulses.

A ramp is a function of time alone, and so are the instants at which it begins anew. Steps that end there see
a guard on one smooth piece only, and both sides of it where it jumps: nothing is left to where steps happen
to lie.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

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
        inputs = {(PARAMETER, k): value for k, value in enumerate(p.tolist())} | {(TIME, 0): times}
        found = [switching.sides(inputs) for switching in self._switchings]
        return np.concatenate([np.broadcast_to(each, (len(times), each.shape[-1])) for each in found], axis=1)


class JumpInstants:
    """Instants at which choices of time alone change, at given parameters.

    Parameters
    ----------
    choices : TimeChoices
    p : ndarray, shape (m,)
    period : float
        Of the time's part of the machine: what changes for less than a thousandth of it may be missed.
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
