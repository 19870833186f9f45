"""Motions of a machine followed forward by SciPy, events searched for, with nothing of the engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.numerics.linear import SMALLEST
from contwalk.system import Transition
from contwalk.system.falling import falls, name_of_fall
from contwalk.verification import budget
from contwalk.verification.finding import CannotTell
from contwalk.verification.functions import Functions
from contwalk.verification.lengths import QUARTERS
from contwalk.verification.limits import with_rate
from contwalk.verification.passage import MOST_CALLS, TIGHT, CannotIntegrate
from contwalk.verification.solving import ROUGH


@dataclass(frozen=True)
class Standing:
    """Where a motion is: its time, its mode, the states that exist there, (n,), and what has led there."""

    time: float
    mode: str
    x: np.ndarray
    last: str = ""


@dataclass(frozen=True)
class Course:
    """A motion that was followed.

    Parameters
    ----------
    ended : str
        The name of the event that ends motions, or empty where the time is up.
    accumulates : bool
        Whether more events happen within a time than may.
    at : Standing
    events : list of (str, float)
        Hard events and their times.
    states : list of ndarray, shape (N,)
        At steps, of full length; what does not exist is not a number.
    """

    ended: str
    accumulates: bool
    at: Standing
    events: list[tuple[str, float]]
    states: list[np.ndarray]


@dataclass(frozen=True)
class _At:
    """A guard at an instant: value, rate, and what the tightest tolerance makes of its terms."""

    time: float
    value: float
    rate: float
    noise: float


@dataclass
class Forward:
    """Motions of one machine with its parameters, (p,), by a relative tolerance; `sizes` of states, (N,)."""

    functions: Functions
    p: np.ndarray
    sizes: np.ndarray
    relative: float
    falling: str = field(init=False)

    def __post_init__(self) -> None:
        self.falling = name_of_fall(self.functions.system)
        self._falls = {each.source: each for each in falls(self.functions.system)}

    def acting(self, mode: str) -> list[Transition]:
        """What may happen in a mode: what ends motions as well."""
        own = [each for each in self.functions.system.leaving(mode) if each.role != "watched"]
        return own + [each for each in (self._falls.get(mode),) if each is not None]

    def full(self, at: Standing) -> np.ndarray:
        """The state of full length, (N,)."""
        whole = np.full(len(self.functions.system.states), np.nan)
        whole[list(self.functions.system.states_of(at.mode))] = at.x
        return whole

    def guard(self, each: Transition, t: float, x: np.ndarray) -> _At:
        """The guard of a transition at a state of its source, (n,)."""
        made = self.functions.number(("guard", each.name), each.source, each.guard)
        value, rate = with_rate(made, self.functions.field(each.source), t, x, self.p)
        _, slope = made(t, x, self.p)
        terms = float(np.abs(slope[0, 1 : 1 + len(x)]) @ np.abs(x) + abs(value) + abs(t * rate))
        return _At(t, value, rate, TIGHT * terms)

    def after(self, each: Transition, t: float, x: np.ndarray) -> Standing:
        """Where an event leads from a state of its source, (n,)."""
        jump = self.functions.jump(each, each.source, each.target, "", 0)
        return Standing(t, each.target, jump(t, x, self.p)[0], each.name)

    def followed(self, begin: Standing, lasts: float, most: int, within: float) -> Course:
        """A motion from where it stands, for a time.

        Parameters
        ----------
        most, within : int, float
            Events are said to accumulate where more than so many hard ones happen within this time.

        Raises
        ------
        CannotTell
            If SciPy does not follow it, or it changes its mode again and again.
        """
        at, until, events, states = begin, begin.time + lasts, list[tuple[str, float]](), [self.full(begin)]
        for _ in range(MOST_CALLS):
            each = self._at_once(at)
            if each is None:
                at, each = self._until_event(at, until, states)
            if each is None or each.name == self.falling:
                return Course("" if each is None else self.falling, False, at, events, states)
            at = self.after(each, at.time, at.x)
            if each.role == "hard":
                events.append((each.name, at.time))
                if len(events) > most and events[-1][1] - events[-1 - most][1] < within:
                    return Course("", True, at, events, states)
        raise CannotTell("The motion changes its mode again and again.")

    def _at_once(self, at: Standing) -> Transition | None:
        """What happens where a motion stands: what acts at entry and is past zero, or passes it from zero."""
        for each in self.acting(at.mode):
            found, sign = self.guard(each, at.time, at.x), 1.0 if each.direction == "rising" else -1.0
            zero = abs(found.value) <= found.noise
            if each.at_entry and not zero and sign * found.value > 0.0:
                return each
            meets = zero and each.name != at.last and each.direction != "both"
            if meets and sign * found.rate > 0.0:
                return each
        return None

    def _until_event(
        self, at: Standing, until: float, states: list[np.ndarray]
    ) -> tuple[Standing, Transition | None]:
        """Where the first event after this happens, and which; none where the time is up."""
        from scipy.integrate import DOP853

        rates, own = self.functions.field(at.mode), list(self.functions.system.states_of(at.mode))
        if not at.time < until:
            return at, None
        rates.at(self.p)

        def right(t: float, x: np.ndarray) -> np.ndarray:
            budget.ask()
            return rates.linear(t, x)[0].copy()

        tolerance = {"rtol": self.relative, "atol": self.relative * self.sizes[own]}
        with np.errstate(all="ignore"):  # what is not finite shows in what comes out
            solver, acting = DOP853(right, at.time, at.x, until, **tolerance), self.acting(at.mode)
            before = [self._leaving(each, at) for each in acting]
            while solver.status == "running":
                rates.at(self.p)
                solver.step()
                if solver.status == "failed" or not np.isfinite(solver.y).all():
                    raise CannotIntegrate("SciPy's DOP853 does not follow the motion.")
                if solver.nfev > MOST_CALLS:
                    raise CannotIntegrate("SciPy's DOP853 takes too many steps.")
                inside = solver.dense_output()
                times = solver.t_old + (solver.t - solver.t_old) * QUARTERS[1:]
                found = list[tuple[float, int]]()
                for k, each in enumerate(acting):
                    seen = [before[k], *(self.guard(each, t, inside(t)) for t in times)]
                    before[k] = seen[-1]
                    found += [(t, k) for t in self._passes(each, inside, seen)]
                if found:
                    t, k = min(found)
                    there = Standing(t, at.mode, np.asarray(inside(t)), at.last)
                    states.append(self.full(there))
                    return there, acting[k]
                states.append(self.full(Standing(solver.t, at.mode, solver.y)))
        return Standing(solver.t, at.mode, solver.y), None

    def _leaving(self, each: Transition, at: Standing) -> _At:
        """A guard where a motion begins: where it is zero, on the side to which it goes."""
        found = self.guard(each, at.time, at.x)
        if each.name == at.last and abs(found.value) <= ROUGH * found.noise / TIGHT:
            return _At(found.time, float(np.copysign(SMALLEST, found.rate)), found.rate, found.noise)
        if abs(found.value) <= found.noise:
            return _At(found.time, float(np.copysign(SMALLEST, found.rate)), found.rate, found.noise)
        return found

    def _passes(
        self, each: Transition, inside: Callable[[float], np.ndarray], seen: Sequence[_At]
    ) -> Iterator[float]:
        """When a guard passes zero in its direction first between instants: where it turns between two, and
        passes twice, as well."""
        ways = {"falling": (-1.0,), "rising": (1.0,), "both": (-1.0, 1.0)}[each.direction]

        def at(t: float) -> _At:
            return self.guard(each, t, inside(t))

        for first, last in pairwise(seen):
            for way in ways:
                ends = first
                if first.rate * last.rate < 0.0 and way * first.value < 0.0:
                    turn = root(lambda t: at(t).rate, first.time, last.time)
                    if turn is not None:
                        inner = at(turn)
                        if way * inner.value > 0.0 > way * at(first.time).value:
                            last = inner
                        elif way * inner.value <= 0.0:
                            ends = inner
                if way * ends.value < 0.0 <= way * last.value:
                    found = root(lambda t: at(t).value, ends.time, last.time)
                    yield last.time if found is None else found
                    return


def root(function: Callable[[float], float], begin: float, end: float) -> float | None:
    """Where a function passes zero; nowhere where both ends have one sign."""
    from scipy.optimize import brentq

    first, last = function(begin), function(end)
    if first == 0.0 or last == 0.0:
        return begin if first == 0.0 else end
    if first * last > 0.0:
        return None
    found: Any = brentq(function, begin, end, xtol=float(np.spacing(max(abs(begin), abs(end)))))
    return float(found)
