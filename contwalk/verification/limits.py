"""What is zero where an orbit meets a limit: a guard that is touched, its rate, a duration, a condition."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.verification.equations import Evaluation
from contwalk.verification.finding import CannotTell
from contwalk.verification.functions import Function
from contwalk.verification.orbit import Leg, OrbitEquations
from contwalk.verification.passage import EPSILON, TIGHT, passed, zero_between
from contwalk.verification.solving import Condition

TOUCH, RATE, DURATION, START, END, CONDITION = "touch", "rate", "duration", "start", "end", "condition"
# Which numbers a label is about.
KINDS = {
    "GR": (TOUCH, RATE),
    "OC": (DURATION, START, END, TOUCH),
    "AZ": (CONDITION, TOUCH, START, END),
}
# The numbers that a stored curve of limits is of, by its test.
TESTS = {
    "dip": TOUCH,
    "rate": RATE,
    "duration": DURATION,
    "start": START,
    "end": END,
    "condition": CONDITION,
}
INSTANT = re.compile(r"touched ([-+.0-9e]+)")
_MODE = re.compile(r"in mode ([^:;,. ]+)")


@dataclass(frozen=True)
class Number:
    """One number of an orbit: of which kind, on which leg, so long after its start, and its size there.

    A guard is least there where its rate rises, by `way` 1, and largest by -1.
    """

    kind: str
    leg: int
    instant: float
    value: float
    scale: float
    way: float = 0.0


def limit(label: str, point: SpecialPoint, equations: OrbitEquations, begin: Evaluation) -> Condition:
    """The condition of a limit: the number that the record names, on its leg, at its instant.

    Parameters
    ----------
    label : str
        That of the limit, which may be a part of the point's.
    point : SpecialPoint
        Its kind, or its note, names a guard or a condition.
    """
    name, found = named(label, point, equations, begin)
    if not found:
        raise CannotTell(f"The orbit has no number '{name}' that could be zero.")
    told, mode = INSTANT.search(point.note or ""), _MODE.search(point.note or "")
    if mode:
        legs = [{leg.mode, leg.pieces[-1].mode} for leg in begin.legs]
        found = [each for each in found if mode[1] in legs[each.leg]] or found
    instant, total = float(told[1]) if told else None, sum(leg.duration for leg in begin.legs)

    def away(number: Number) -> float:
        late = 0.0 if instant is None else abs(number.instant - instant) / total
        return late + abs(number.value) / number.scale

    return _kept_zero(equations, min(found, key=away), name)


def named(
    label: str, point: SpecialPoint, equations: OrbitEquations, begin: Evaluation
) -> tuple[str, list[Number]]:
    """The name of the guard or condition that a record is about, and the orbit's numbers of that name."""
    quoted = re.findall(r"'([^']+)'", point.note or "")
    name = quoted[0] if quoted else str(point.kind)
    kinds = (RATE,) if "no rate" in (point.note or "") else KINDS[label]
    return name, [each for kind in kinds for each in numbers(equations, begin, name, kind)]


def limit_of_curve(stored: Mapping[str, Any], equations: OrbitEquations, begin: Evaluation) -> Condition:
    """The condition of all points of a curve of limits: the number that the curve is stored with."""
    kind, name = TESTS.get(str(stored["test"])), str(stored["name"])
    if kind is None:
        raise CannotTell(f"What '{name}' does where it is entered past zero is not recomputed.")
    found = list(numbers(equations, begin, name, kind))
    if not found:
        raise CannotTell(f"The orbit has no number '{name}' that could be zero.")
    of_leg = [each for each in found if each.leg == int(stored["leg"])]
    return _kept_zero(equations, min(of_leg or found, key=lambda each: abs(each.value) / each.scale), name)


def _kept_zero(equations: OrbitEquations, best: Number, name: str) -> Condition:
    """That a number is zero, beside the place where it was found."""

    def condition(at: Evaluation) -> float:
        same = [
            each
            for each in numbers(equations, at, name, best.kind)
            if (each.leg, each.way) == (best.leg, best.way)
        ]
        if not same:
            raise CannotTell(f"'{name}' has no such number beside the point.")
        return min(same, key=lambda each: abs(each.instant - best.instant)).value / best.scale

    return condition


def numbers(equations: OrbitEquations, at: Evaluation, name: str, kind: str) -> Iterator[Number]:
    """All numbers of a kind and a name on an orbit."""
    system, functions = equations.functions.system, equations.functions
    p = functions.parameters.at(at.z[equations.size :])
    total = sum(leg.duration for leg in at.legs)
    for number, leg in enumerate(at.legs):
        if kind == DURATION and leg.event == name:
            yield Number(kind, number, 0.0, leg.duration, total)
        if kind == CONDITION:
            yield from _conditions(equations, at, number, name, p)
        for mode in dict.fromkeys([leg.mode, leg.pieces[-1].mode]):
            for transition in system.leaving(mode):
                if transition.name == name:
                    guard = functions.guard(transition)
                    own = leg.event == name  # which is zero where the leg ends, on every orbit
                    yield from _guarded(equations, leg, number, kind, guard, mode, p, own)


def _guarded(
    equations: OrbitEquations,
    leg: Leg,
    number: int,
    kind: str,
    guard: Function,
    mode: str,
    p: np.ndarray,
    own: bool,
) -> Iterator[Number]:
    """Numbers of one guard on one leg."""
    times = np.concatenate([piece.times for piece in leg.pieces])
    states = np.vstack([piece.states for piece in leg.pieces])
    field = equations.functions.field(mode)
    told = np.array([with_rate(guard, field, t, x, p) for t, x in zip(times, states, strict=True)])
    values, rates = told.T
    scale, fastest = max(np.abs(values).max(), 1e-300), max(np.abs(rates).max(), 1e-300)
    if kind == RATE:
        yield Number(kind, number, times[-1] - leg.start, rates[-1], fastest)
    if kind == START:
        yield Number(kind, number, 0.0, values[0], scale)
    if kind == END and not own:
        yield Number(kind, number, times[-1] - leg.start, values[-1], scale)
    if kind != TOUCH:
        return
    for k in np.flatnonzero(np.diff(times) != 0.0):
        ends = [(float(times[j]), float(values[j]), float(rates[j])) for j in (k, k + 1)]
        for t, value, way in extremes(equations, mode, guard, states[k], ends[0], ends[1], p):
            yield Number(kind, number, t - leg.start, value, scale, way)
    if abs(rates[-1]) <= EPSILON**0.5 * fastest:  # it is touched where the leg ends
        yield Number(kind, number, times[-1] - leg.start, values[-1], scale)


def with_rate(
    guard: Function, field: Function, t: float, x: np.ndarray, p: np.ndarray
) -> tuple[float, float]:
    """A guard and its rate at a state, (n,), and parameters, (p,)."""
    value, slope = guard(t, x, p)
    return float(value[0]), float(slope[0, 0] + slope[0, 1 : 1 + len(x)] @ field(t, x, p)[0])


# A guard at an instant: this, its value and its rate.
_At = tuple[float, float, float]


def extremes(
    equations: OrbitEquations,
    mode: str,
    guard: Function,
    x: np.ndarray,
    begin: _At,
    end: _At,
    p: np.ndarray,
) -> Iterator[_At]:
    """Instants, values and ways of a guard where it turns between two steps: its value there is known to the
    square of how exactly the instant is. From a state x, (n,), with parameters (p,).
    """
    functions, scale = equations.functions, equations._scale(mode)
    field, t = functions.field(mode), begin[0]

    def at(tau: float) -> tuple[float, float]:
        there = x if tau == t else passed(functions, mode, t, x, tau - t, p, scale, TIGHT).end
        return with_rate(guard, field, tau, there, p)

    for first, last in pairwise([begin, *_inside(at, begin, end), end]):
        if first[2] * last[2] < 0.0:
            tau = zero_between(lambda tau: at(tau)[1], first[0], last[0])
            yield tau, at(tau)[0], float(np.sign(last[2]))


def _inside(at: Callable[[float], tuple[float, float]], begin: _At, end: _At, depth: int = 3) -> list[_At]:
    """Instants inside of a step, of rates of one sign at both ends, at which a guard may have turned twice.

    That is where the rate of the cubic through both ends is least, and so on in both parts.
    """
    (t, value, rate), (later, then, fast) = begin, end
    if not depth or rate * fast <= 0.0 or later == t:
        return []
    mean = (then - value) / (later - t)
    b, a = 2.0 * (3.0 * mean - 2.0 * rate - fast), 3.0 * (rate + fast - 2.0 * mean)
    share = -0.5 * b / a if a else 0.0
    if not 0.0 < share < 1.0 or abs(rate + share * (b + a * share)) >= min(abs(rate), abs(fast)):
        return []
    tau = t + share * (later - t)
    inner = (tau, *at(tau))
    return [*_inside(at, begin, inner, depth - 1), inner, *_inside(at, inner, end, depth - 1)]


def _conditions(
    equations: OrbitEquations, at: Evaluation, number: int, name: str, p: np.ndarray
) -> Iterator[Number]:
    """The conditions of a name that hold at the end of a leg."""
    functions, leg = equations.functions, at.legs[number]
    for each in functions.system.conditions:
        if each.name != name or each.at != leg.event:
            continue
        piece, time = leg.pieces[-1], leg.start + leg.duration
        mode, x = piece.mode, piece.end
        if each.side == "after":
            following = at.legs[(number + 1) % len(at.legs)]
            mode, x = following.mode, following.pieces[0].states[0]
        value, slope = functions.number(("condition", name), mode, each.function)(time, x, p)
        yield Number(
            CONDITION,
            number,
            0.0,
            float(value[0]),
            max(float(np.abs(slope[0, 1 : 1 + len(x)]) @ np.abs(x)), 1e-300),
        )
