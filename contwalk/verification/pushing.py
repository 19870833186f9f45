"""A stored solution pushed once more, by motions that SciPy follows: how they end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON, SMALLEST
from contwalk.system import Transition
from contwalk.system.falling import FALLEN
from contwalk.verification.finding import MOVED, CannotTell
from contwalk.verification.forward import Course, Forward, Standing, root
from contwalk.verification.functions import Functions
from contwalk.verification.passage import COARSER, TIGHT, CannotIntegrate, soft
from contwalk.verification.solving import ROUGH

# Codes of how motions end, as they are stored.
SURVIVED, ENDED, ACCUMULATED = "survived", "ended", "events_accumulate"
LEFT, AWAY, BEYOND = "left_sequence", "did_not_return", "beyond_guard"


@dataclass(frozen=True)
class Rule:
    """What surviving means, and how exactly it was asked.

    Parameters
    ----------
    duration, period : float
        Seconds to survive, and of the whole orbit; the period of an equilibrium is not a number.
    sequence : bool
        Whether the orbit's events are to be in order at the end.
    returns : float, optional
        How near to the solution the end is to be, in units of magnitudes.
    near : float
        How near to a solution what comes to it is.
    tolerance, accuracy : float
        Of the motions, and of the borders, in their parts.
    neutral : tuple of int
        States that do not count.
    most : int
        How many times the hard events of a period may happen within one.
    together : float
        How near to each other events of one group are, in parts of the period.
    laps : float
        In so many periods at the end the events are in order once.
    settling : float
        What settles is followed for so many more times that it survives for.
    """

    duration: float
    period: float
    sequence: bool
    returns: float | None
    near: float
    tolerance: float
    accuracy: float
    neutral: tuple[int, ...]
    most: int
    together: float
    laps: float
    settling: float


@dataclass
class Pushing:
    """One solution that is pushed, by motions of one tolerance.

    Parameters
    ----------
    functions, p
        Of the machine, with its parameters, shape (p,).
    instant : mapping
        `time`, `mode`, `state` (a list of N numbers), as they are stored.
    """

    functions: Functions
    p: np.ndarray
    rule: Rule
    instant: Mapping[str, Any]
    relative: float
    unpushed: Course = field(init=False)

    def __post_init__(self) -> None:
        state = np.abs(np.array(self.instant["state"], dtype=float))
        declared = np.array([each.scale or 0.0 for each in self.functions.system.states])
        sizes = np.where(declared > 0.0, declared, state.max() or 1.0)
        self.motion = Forward(self.functions, self.p, sizes, self.relative)
        lasts = 0.0 if np.isnan(self.rule.period) else self.rule.period
        self.unpushed = self.motion.followed(self._begun(), lasts, self.rule.most, lasts)
        self.motion.sizes = self.magnitudes

    def _begun(self) -> Standing:
        """The instant; an event that has led there has left its guard at zero."""
        mode = str(self.instant["mode"])
        state = np.array(self.instant["state"], dtype=float)
        x, t = state[list(self.functions.system.states_of(mode))], float(self.instant["time"])
        for each in self.motion.acting(mode):
            found = self.motion.guard(each, t, x)
            if abs(found.value) <= ROUGH * max(abs(found.rate) * self._time, found.noise):
                return Standing(t, mode, x, each.name)
        return Standing(t, mode, x)

    @property
    def _time(self) -> float:
        return self.rule.duration if np.isnan(self.rule.period) else self.rule.period

    @cached_property
    def course(self) -> np.ndarray:
        """States all over the solution, shape (k, N)."""
        return np.array(self.unpushed.states)

    @cached_property
    def magnitudes(self) -> np.ndarray:
        """Half the range of each state over the solution, or what the plugin declares, shape (N,)."""
        there = np.isfinite(self.course)
        low = np.where(there, self.course, np.inf).min(axis=0)
        high = np.where(there, self.course, -np.inf).max(axis=0)
        half, size = 0.5 * (high - low), np.maximum(np.abs(low), np.abs(high))
        sizes = np.nan_to_num(np.where(half > ROUGH * size, half, size), posinf=0.0)
        zero = sizes <= EPSILON * sizes.max(initial=0.0)
        declared = np.array([each.scale or np.nan for each in self.functions.system.states])
        return np.where(np.isfinite(declared), declared, np.where(zero, 1.0, sizes))

    def pushed(self, push: np.ndarray) -> Standing | None:
        """Where a motion sets out that is pushed, (N,); nowhere where the machine cannot be there.

        A guard that is carried past zero is where the machine may be if its event lets it go on there.
        """
        begun = self._begun()
        t, mode, x = begun.time, begun.mode, begun.x
        there = x + push[list(self.functions.system.states_of(mode))]
        joined = [mode]
        for name in joined:
            joined += [s.target for s in soft(self.functions, name) if s.target not in joined]
        for name in joined:
            for each in self.functions.system.leaving(name):
                if each.role == "hard" and each.level and self._carried(each, begun, there, name == mode):
                    return self.motion.after(each, t, there)
        for each in self.functions.system.leaving(mode):
            if each.name == begun.last and each.role == "hard" and self._turned_back(each, begun, there):
                return self.motion.after(each, t, there)
            past = each.role == "hard" and self._carried(each, begun, there, True)
            if past and not (each.target == each.source and self._goes_on(each, t, x, there)):
                return None
        return Standing(t, mode, there, begun.last)

    def _carried(self, each: Transition, begun: Standing, there: np.ndarray, same: bool) -> bool:
        """Whether a push carries a guard past zero, beyond rounding; x is the state without it."""
        before, after = (self.motion.guard(each, begun.time, x) for x in (begun.x, there))
        old = 0.0 if begun.last == each.name else before.value
        new = after.value - (before.value if begun.last == each.name else 0.0)
        noise = before.noise + after.noise
        if each.direction == "both":
            return old * new < 0.0 and abs(old) > noise
        sign = 1.0 if each.direction == "rising" else -1.0
        if each.level:
            return sign * new > noise and (not same or sign * (new - old) > noise)
        return sign * old <= noise < sign * new

    def _turned_back(self, each: Transition, begun: Standing, there: np.ndarray) -> bool:
        """Whether an event that has just happened does so again at a state, (n,), to which it is pushed: its
        guard is zero still, and goes where it came from, as it does not without the push."""
        before, after = (self.motion.guard(each, begun.time, x) for x in (begun.x, there))
        way = {"rising": 1.0, "falling": -1.0, "both": -float(np.sign(before.rate))}[each.direction]
        still = abs(after.value - before.value) <= before.noise + after.noise
        return still and way * after.rate > 0.0 >= way * before.rate

    def _goes_on(self, each: Transition, t: float, x: np.ndarray, there: np.ndarray) -> bool:
        """Whether a motion that meets a guard between two states, (n,), goes on past it after its event."""
        motion, ahead = self.motion, there - x
        side = float(np.sign(motion.guard(each, t, there).value))
        share = root(lambda s: motion.guard(each, t, x + s * ahead).value, 0.0, 1.0)
        met = there if share is None else x + share * ahead
        rate, size = motion.guard(each, t, met).rate, np.linalg.norm(ahead)
        if side * rate <= 0.0:  # it is met by another motion, faster in what changes the rate alone
            steps = ROUGH * np.maximum(np.abs(met), size)
            beside = [
                [motion.guard(each, t, met + way * step) for way in (1.0, -1.0)] for step in np.diag(steps)
            ]
            across, along = (
                np.array([getattr(up, name) - getattr(down, name) for up, down in beside]) / (2.0 * steps)
                for name in ("value", "rate")
            )
            along = along - across * (along @ across) / max(float(across @ across), SMALLEST)
            steepness = float(np.linalg.norm(along))
            if not steepness > ROUGH * abs(rate) / size:
                return False
            met = met + side * (abs(rate) / steepness + size) / steepness * along
        after = motion.guard(each, t, motion.after(each, t, met).x)
        return side * after.value > after.noise or (
            abs(after.value) <= after.noise and side * after.rate > 0.0
        )

    def followed(self, push: np.ndarray) -> tuple[str, Course | None]:
        """How a motion ends early that is pushed, (N,), or that it survives, and the motion."""
        begin = self.pushed(push)
        if begin is None:
            return BEYOND, None
        cycle = sum(len(group) for group in self.cycle)
        try:
            most, within = self.rule.most * max(cycle, 1), np.nan_to_num(self.rule.period, nan=0.0)
            course = self.motion.followed(begin, self.rule.duration, most, within)
        except CannotIntegrate:
            return ENDED, None
        code = ACCUMULATED if course.accumulates else FALLEN if course.ended else SURVIVED
        return code, course

    def verdict(self, push: np.ndarray) -> str:
        """The code of how a motion ends that is pushed, (N,)."""
        code, course = self.followed(push)
        if code != SURVIVED or course is None:
            return code
        end = float(self.instant["time"]) + self.rule.duration
        if self.rule.sequence and self.cycle and not self._keeps(course, end):
            return LEFT
        if (
            self.rule.returns is not None
            and not self.distance(self.motion.full(course.at)) <= self.rule.returns
        ):
            return AWAY
        return SURVIVED

    @cached_property
    def cycle(self) -> list[Counter[str]]:
        """The hard events of the solution in groups of those that happen together."""
        groups, before = list[Counter[str]](), -np.inf
        events, apart = self.unpushed.events, self.rule.together * self.rule.period
        for name, time in events:
            if groups and time - before <= apart:
                groups[-1][name] += 1
            else:
                groups.append(Counter([name]))
            before = time
        if (
            len(groups) > 1
            and events[0][1] + self.rule.period - before <= self.rule.together * self.rule.period
        ):
            groups[0] += groups.pop()
        return groups

    def _keeps(self, course: Course, end: float) -> bool:
        """Whether the events of the solution happen in their order once in the last periods."""
        late = [name for name, time in course.events if time >= end - self.rule.laps * self.rule.period]
        length = sum(sum(group.values()) for group in self.cycle)
        for first in range(len(late) - length + 1):
            for k in range(len(self.cycle)):
                place = first
                for group in (*self.cycle[k:], *self.cycle[:k]):
                    count = sum(group.values())
                    if Counter(late[place : place + count]) != group:
                        break
                    place += count
                else:
                    return True
        return False

    def distance(self, state: np.ndarray, course: np.ndarray | None = None) -> float:
        """How far a state, (N,), is from the nearest one of a course, (k, N), in units of magnitudes."""
        off = (self.course if course is None else course) - state
        for place, declared in enumerate(self.functions.system.states):
            if place in self.rule.neutral:
                off[:, place] = 0.0
            elif declared.period:
                off[:, place] -= declared.period * np.round(off[:, place] / declared.period)
        off = np.nan_to_num(off / self.magnitudes, nan=0.0)
        ahead = np.diff(off, axis=0)
        lengths = np.maximum((ahead**2).sum(axis=1), SMALLEST)
        shares = np.clip(-(off[:-1] * ahead).sum(axis=1) / lengths, 0.0, 1.0)
        nearest = np.concatenate([off, off[:-1] + shares[:, None] * ahead])
        return float(np.sqrt((nearest**2).sum(axis=1).min()))


class Twice:
    """The same of an instant by two tolerances, a factor of ten apart: it is told where both say so.

    Parameters
    ----------
    make : callable
        A `Pushing` of a tolerance.
    """

    def __init__(self, make: Callable[[float], Pushing], tolerance: float) -> None:
        finer = max(tolerance / MOVED, TIGHT)
        self.fine, self.coarse = make(finer), make(COARSER * finer)
        self.tolerance = tolerance

    def told(self, push: np.ndarray, asked: Callable[[Pushing, np.ndarray], str]) -> str:
        """What both say of a push, shape (N,).

        Raises
        ------
        CannotTell
            If they do not say the same.
        """
        fine, coarse = asked(self.fine, push), asked(self.coarse, push)
        if fine != coarse:
            raise CannotTell(f"motions of two tolerances end as {fine} and as {coarse}")
        return fine

    def beside(self, push: np.ndarray, asked: Callable[[Pushing, np.ndarray], str]) -> set[str]:
        """What motions come to that begin beside a push, (N,), by what the run's tolerance makes of it."""
        size, found = MOVED * self.tolerance * self.fine.magnitudes, set[str]()
        for k in range(4):
            found.add(asked(self.coarse, push + size * np.cos(k * np.pi / 2.0 + np.arange(len(push)))))
        return found
