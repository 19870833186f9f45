"""What must stay positive for a solution to be one that the machine moves on, recomputed along its motion.

A leg goes on up to its own event, so no other guard may pass zero on it, nor its own before: a guard that
acts at a passage only may not come down from above zero to below it, and any other may not be below it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contwalk.system import Transition
from contwalk.verification.branching import Unfolded
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import AGREES, CANNOT_TELL, DISAGREES, SLACK
from contwalk.verification.limits import extremes, with_rate
from contwalk.verification.orbit import Leg, OrbitEquations
from contwalk.verification.passage import EPSILON
from contwalk.verification.solving import Solution


@dataclass(frozen=True)
class Kept:
    """A number that must be positive, to an error; one that is not judged is only told under its name.

    Parameters
    ----------
    name : str
        As margins of records are called.
    """

    name: str
    value: float
    error: float
    judged: bool = True


@dataclass(frozen=True)
class _Seen:
    """A guard, and its rate, at a state x, shape (n,); `turns` where it is extreme, or at an end."""

    transition: Transition
    time: float
    x: np.ndarray
    value: float
    error: float
    rate: float
    rate_error: float
    turns: bool = False


def kept(equations: Equations, found: Solution) -> list[Kept]:
    """All that must be positive of a solution; it is as far from the record as it has moved."""
    off, at = np.abs(found.moved) + found.error, found.at
    if isinstance(equations, Unfolded):
        at, off, equations = equations.inner(at), np.delete(off, equations.own), equations.equations
    if isinstance(equations, EquilibriumEquations):
        return list(_of_mode(equations, at, off))
    return list(_Orbit(equations, at, off).all()) if isinstance(equations, OrbitEquations) else []


def judged(stored: bool, numbers: Sequence[Kept], at_limit: bool) -> tuple[str, str]:
    """A verdict and its reason on whether a record is admissible.

    Parameters
    ----------
    at_limit : bool
        Whether one of the numbers is zero by what the record is.
    """
    own = [each for each in numbers if each.judged]
    passed = [each for each in own if each.value < -each.error]
    unclear = [] if at_limit else [each for each in own if abs(each.value) <= each.error]
    if stored and passed:
        return DISAGREES, f"it says admissible, and {passed[0].name} is {passed[0].value:.6g}"
    if not stored and not passed and not unclear:
        return (CANNOT_TELL, "a limit is there") if at_limit else (DISAGREES, "it passes no limit")
    if unclear and not passed:
        return CANNOT_TELL, f"whether it is admissible: {unclear[0].name} is zero to its error"
    return AGREES, ""


def margins_agree(stored: Mapping[str, float], numbers: Sequence[Kept], claim: float) -> tuple[str, str]:
    """A verdict and its reason on the margins that a record tells: each is one of the solution's numbers.

    They are told by cubics between steps, without an error: to a quarter of the digits.

    Parameters
    ----------
    claim : float
        How many times the errors of the numbers the record's own are.
    """
    missing = ""
    for name, value in stored.items():
        own = [each for each in numbers if each.name == name]
        size = EPSILON**0.25 * max((abs(each.value) for each in own), default=0.0)
        off = [abs(each.value - value) - (1.0 + claim) * each.error - size for each in own]
        if not off:
            missing = missing or f"its margin {name} is not recomputed"
        elif min(off) > np.spacing(abs(value)):
            nearest = own[int(np.argmin(off))].value
            return DISAGREES, f"its margin {name} is {value:.6g}, and {nearest:.6g} is the nearest to it"
    return (CANNOT_TELL, missing) if missing else (AGREES, "")


def _of_mode(equations: EquilibriumEquations, at: Evaluation, off: np.ndarray) -> Iterator[Kept]:
    """The guards of the mode of an equilibrium, on the mode's side. off has the shape (N + k,)."""
    n, functions = equations.size, equations.functions
    p = functions.parameters.at(at.z[n:])
    for each in functions.system.leaving(equations.mode):
        if each.direction != "both":
            value, slope = functions.guard(each)(0.0, at.z[:n], p)
            yield Kept(each.name, _side(each) * float(value[0]), SLACK * float(np.abs(slope[0, 1:]) @ off))


def _side(transition: Transition) -> float:
    return -1.0 if transition.direction == "rising" else 1.0


class _Orbit:
    """The numbers of one orbit.

    Parameters
    ----------
    off : ndarray, shape (N + k,)
        How far it may be from the record.
    """

    def __init__(self, equations: OrbitEquations, at: Evaluation, off: np.ndarray) -> None:
        self.equations, self.functions, self.at = equations, equations.functions, at
        self.p = self.functions.parameters.at(at.z[equations.size :])
        self.off, self.free = off, off[equations.size :]
        self.lasting = off[equations.size - equations.count - 1 : equations.size - 1]
        self.when = float(off[equations.size - 1] + self.lasting.sum())  # of all instants

    def all(self) -> Iterator[Kept]:
        """Those of all legs."""
        place = 0
        for number, leg in enumerate(self.at.legs):
            n = len(leg.pieces[0].end)
            starts = [self.off[place + k * n : place + (k + 1) * n] for k in range(len(leg.pieces))]
            place += n * len(leg.pieces)
            yield from self._of_leg(number, leg, starts)

    def _of_leg(self, number: int, leg: Leg, starts: list[np.ndarray]) -> Iterator[Kept]:
        system, momentary = self.functions.system, self.equations.momentary[number]
        own = system.transition(leg.event, leg.pieces[-1].mode) if leg.event else None
        yield from self._conditions(number, leg, starts)
        if momentary:
            yield from self._past(leg, starts[0], own)
        if momentary or self._still(number):
            return
        if own is not None and own.role == "hard":
            yield Kept(f"{own.name}_duration", leg.duration, SLACK * float(self.lasting[number]))
        modes = dict.fromkeys(mode for piece in leg.pieces for mode in (*piece.modes, piece.mode))
        guards = [each for mode in modes for each in system.leaving(mode) if each.role != "soft"]
        for name in dict.fromkeys(each.name for each in guards):
            yield from self._of_guard(number, leg, starts, name)

    def _past(self, leg: Leg, start: np.ndarray, own: Transition | None) -> Iterator[Kept]:
        """Of a leg of no time: its own guard is past zero, and none is that would act before it."""
        x = leg.pieces[0].states[0]
        for each in self.functions.system.leaving(leg.mode):
            value, slope = self.functions.guard(each)(leg.start, x, self.p)
            error = SLACK * float(np.abs(slope[0]) @ np.concatenate([[self.when], start, self.free]))
            if each == own:
                yield Kept(f"{each.name}_past", -_side(each) * float(value[0]), error)
                return
            if each.level:
                yield Kept(each.name, _side(each) * float(value[0]), error)

    def _conditions(self, number: int, leg: Leg, starts: list[np.ndarray]) -> Iterator[Kept]:
        """The conditions at the end of a leg."""
        for each in self.functions.system.conditions:
            if each.at != leg.event:
                continue
            piece, following = leg.pieces[-1], self.at.legs[(number + 1) % len(self.at.legs)]
            n, mode, x = len(piece.end), piece.mode, piece.end
            off = np.abs(piece.derivative[:, 1 : 1 + n]) @ starts[-1]
            off = off + np.abs(piece.rate) * self.lasting[number]
            if each.side == "after":
                mode, x = following.mode, following.pieces[0].states[0]
                off = np.abs(leg.jump) @ off
            made = self.functions.number(("condition", each.name), mode, each.function)
            value, slope = made(leg.start + leg.duration, x, self.p)
            off = np.concatenate([[self.when], off, self.free])
            yield Kept(each.name, float(value[0]), SLACK * float(np.abs(slope[0]) @ off))

    def _of_guard(self, number: int, leg: Leg, starts: list[np.ndarray], name: str) -> Iterator[Kept]:
        """Those of the guard of a name on one leg."""
        for part in self._parts(number, leg, starts, name):
            transition, own = part[-1].transition, part[-1].transition.name == leg.event
            sign = self._sign(number, transition, own, part)
            turns = [(sign * each.value, each.error) for each in part if each.turns]
            yield from (Kept(name, way * v, error, False) for v, error in turns for way in (1.0, -1.0))
            if own and transition.role == "hard":
                last = part[-1]
                yield Kept(f"{name}_rate", -sign * last.rate, last.rate_error)
            # One that begins, or ends, at zero is judged by where it goes from there, or has come from.
            zero = [abs(value) <= error for value, error in turns]
            while len(turns) > 2 and zero[0] and zero[1]:
                del turns[0], zero[0]
            if transition.role == "hard" and not transition.at_entry and transition.direction != "both":
                begun = zero[0] and self._begun(number, transition)
                yield from _drops(name, turns, begun, zero[-1])
            else:
                inner = turns[int(zero[0]) : len(turns) - int(zero[-1])]
                yield from (Kept(name, value, error) for value, error in inner)

    def _begun(self, number: int, guard: Transition) -> bool:
        """Whether the event before a leg leaves a guard where it is zero: it is its own, or the event's."""
        own, legs, system = self.equations, self.at.legs, self.functions.system
        if number == 0 and own.image:  # names may be swapped at it
            return True
        for back in range(1, len(legs) + 1):
            leg, name = legs[number - back], legs[number - back].event
            if name and system.transition(name, leg.pieces[-1].mode).guard == guard.guard:
                return True
            if name == guard.name or not (own.momentary[number - back] or own.together[number - back]):
                return name == guard.name
        return False

    def _still(self, number: int) -> bool:
        """Whether a leg lasts no time, as the one before it ends at both of their events."""
        off = SLACK * float(self.lasting[number])
        return self.equations.together[number] and abs(self.at.legs[number].duration) <= off

    def _sign(self, number: int, transition: Transition, own: bool, part: Sequence[_Seen]) -> float:
        """The sign with which a guard is positive before it is passed."""
        if transition.direction != "both":
            return _side(transition)
        if own:
            return 1.0 if self.equations.falls[number] else -1.0
        return 1.0 if max((each.value for each in part), key=abs) >= 0.0 else -1.0

    def _parts(self, number: int, leg: Leg, starts: list[np.ndarray], name: str) -> Iterator[list[_Seen]]:
        """A guard along the parts of a leg whose modes have it: at each step, and where it is extreme."""
        part, lasting = list[_Seen](), float(self.lasting[number])
        for piece, start in zip(leg.pieces, starts, strict=True):
            for k, mode in enumerate((*piece.modes, piece.mode)):
                known = [each for each in self.functions.system.leaving(mode) if each.name == name]
                if not known:
                    if part:
                        yield _ended(part)
                    part = []
                    continue
                tangent = np.abs(piece.tangents[k])
                n = len(start)
                off = tangent[:, 1 : 1 + n] @ start + tangent[:, 1 + n :] @ self.free
                seen = self._seen(known[0], float(piece.times[k]), piece.states[k], off, lasting)
                if part and seen.time != part[-1].time:
                    part += self._extremes(part[-1], seen, part[-1].transition.source)
                part.append(seen)
        if part:
            yield _ended(part)

    def _seen(
        self, transition: Transition, t: float, x: np.ndarray, off: np.ndarray, lasting: float
    ) -> _Seen:
        """A guard at a state that is known to off, both of shape (n,)."""
        guard, field = self.functions.guard(transition), self.functions.field(transition.source)
        value, rate = with_rate(guard, field, t, x, self.p)
        off = off + np.abs(field(t, x, self.p)[0]) * lasting
        by_free, beside = self.functions.parameters.slopes @ self.free, list[float]()
        for way in (1.0, -1.0):
            there = t + way * self.when, x + way * off, self.p + way * by_free
            beside.append(abs(with_rate(guard, field, *there)[1] - rate))
        _, slope = guard(t, x, self.p)
        by_x = np.abs(slope[0, 1 : 1 + len(x)])
        error = by_x @ (off + np.spacing(np.abs(x))) + np.abs(slope[0, 1 + len(x) :]) @ self.free
        own = SLACK * (float(error) + abs(float(slope[0, 0])) * self.when)
        return _Seen(transition, t, x, value, own, rate, SLACK * max(beside))

    def _extremes(self, before: _Seen, seen: _Seen, mode: str) -> list[_Seen]:
        """A guard where it turns between two steps."""
        ends = [(each.time, each.value, each.rate) for each in (before, seen)]
        guard = self.functions.guard(before.transition)
        found = extremes(self.equations, mode, guard, before.x, ends[0], ends[1], self.p)
        return [replace(seen, time=time, value=value, turns=True) for time, value, _ in found]


def _ended(part: list[_Seen]) -> list[_Seen]:
    """A part whose ends count as places where the guard turns."""
    return [replace(part[0], turns=True), *part[1:-1], replace(part[-1], turns=True)]


def _drops(name: str, turns: Sequence[tuple[float, float]], begun: bool, arrives: bool) -> Iterator[Kept]:
    """Of a guard that acts at passages, with values and errors where it turns: that no way down passes zero.

    What `begun` its leg is not passed once more; what `arrives` at zero in the end comes from above.
    """
    ways = list(pairwise(turns))
    for k, ((top, known), (bottom, error)) in enumerate(ways):
        if bottom >= top or (begun and k == 0):
            continue
        if arrives and k == len(ways) - 1:
            yield Kept(name, top, known)
        else:
            yield Kept(name, *((bottom, error) if bottom >= -top else (-top, known)))
