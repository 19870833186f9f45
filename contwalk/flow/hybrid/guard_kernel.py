"""Where a guard passes zero within one step, for numba.

Where values and rates at both ends fit one cubic polynomial that only rises or only falls, the guard does so
too. Where it cannot come near zero with twice its largest rate of late, it does not matter. On all other
steps it is sampled by the method's own interpolation; if cubic polynomials through every second sample miss
those between, the guard is not resolved, and the step has to be shorter. So it has to be where a guard has no
value: that is not the other side of zero. The instant of an event is located by taking the step anew with the
length that ends there, as in `events.crossings`.

A guard's rate takes the velocity. At the ends of steps that is the method's first stage. Samples take that of
the interpolation, of whose values it is the exact rate, at instants that are common to all guards. Where an
event is located the field is asked.
"""

from __future__ import annotations

import math
from ctypes import sizeof
from typing import Any

from contwalk.flow.compiled.calling import caller, doubles, inlined, integers, record
from contwalk.flow.events.polynomial_kernel import draw, side_of
from contwalk.flow.explicit.drivers import EPSILON, copy, explicit_call, first_stage, place, step
from contwalk.flow.explicit.stages import FIRST, NEXT, Y
from contwalk.flow.hybrid.event_records import PARTS, GuardOnStep, ModeRecord

REACH = 2.0  # times step length and largest rate of late: as far as a guard may go and come back
FORGOTTEN = 0.7  # of a rate that was large, after each step
LEAST_SLOPE, MOST_SLOPE = 0.3, 2.5  # at an end, in units of the mean slope: a cubic polynomial is monotone
# By how much a sample and its slope may miss a cubic polynomial, in units of the guard's variation. Samples
# at one phase of a fast oscillation agree with each other, but their slopes do not with their differences.
MISSED, MISSED_SLOPE = 0.1, 0.3
ROUNDED = 8.0  # in units of a sample's uncertainty
MOST_TRIALS = 60
NARROW = 1e-8  # of a part: the guard is then off its extremum by rounding

CLEAR, MONOTONE, SUSPECT = range(3)
NONE, UNRESOLVED = -1.0, -2.0

_guard_on_step, _LENGTH = record(GuardOnStep), sizeof(GuardOnStep)
_call_step = caller("v", "ddqqqq")
_call_guard = caller("v", "dqqqq")
_evaluate = caller("v", "qdqq")


@inlined
def measured(m: ModeRecord, guard: int, t: float, state: int, velocity: int) -> tuple[float, float, float]:
    """Value, rate and uncertainty of a guard."""
    _call_guard(integers(m.addresses, guard + 1)[guard], t, state, velocity, m.parameters, m.measured)
    out = doubles(m.measured, 3)
    return out[0], out[1], out[2] * EPSILON


@inlined
def sided(at: GuardOnStep, t: float, value: float, rate: float) -> float:
    """The sign just after an instant of the step; of a guard that has not left zero, that it leaves to."""
    held = at.begins != 0.0 and t <= at.left_at and abs(value) <= at.band
    return at.begins if held else side_of(value, rate)


@inlined
def standing(m: ModeRecord, guard: int) -> Any:
    """How a guard stands on the step: a `GuardOnStep`."""
    return _guard_on_step(m.standing + guard * _LENGTH)


@inlined
def begins_on(at: GuardOnStep) -> float:
    """The side on which a guard begins the step."""
    return at.begins if at.begins != 0.0 else side_of(at.value, at.rate)


@inlined
def looks(m: ModeRecord, guard: int, h: float, value: float, rate: float) -> int:
    """How a step of length h looks that ends with this value and rate of a guard."""
    at = standing(m, guard)
    at.fastest = max(abs(at.rate), abs(rate), FORGOTTEN * at.fastest)
    at.left_at = math.inf
    same = begins_on(at) == sided(at, 0.0, value, rate)
    change = value - at.value
    if h * at.fastest < MOST_SLOPE * abs(change):
        first, last = h * at.rate / change, h * rate / change
        if min(first, last) > LEAST_SLOPE:
            return CLEAR if same else MONOTONE
    if same and abs(at.value) + abs(value) > REACH * h * at.fastest:
        return CLEAR
    return SUSPECT


# -- the step taken anew ------------------------------------------------------------------------------------


@inlined
def begin_trials(m: ModeRecord, t: float) -> None:
    """The plan to try begins where the one that moves does."""
    p, moving = explicit_call(m.trial), explicit_call(m.moving)
    copy(place(moving, Y), place(p, Y), m.size)
    first_stage(p, t, Y)
    m.drawn = 0


@inlined
def _retake(m: ModeRecord, guard: int, t: float, end: float) -> tuple[float, float]:
    """Value and uncertainty of a guard at the end of a step of another length."""
    p = explicit_call(m.trial)
    step(p, t, end - t)
    value, _, noise = measured(m, guard, end, place(p, NEXT), m.speed)  # a velocity of some other instant
    return value, noise


@inlined
def _retaken_rate(m: ModeRecord, guard: int, end: float) -> float:
    """Rate of a guard at the end of the step that was taken anew: the field is asked for the velocity."""
    p = explicit_call(m.trial)
    _evaluate(p.evaluate, p.problem, end, place(p, NEXT), m.speed)
    _, rate, _ = measured(m, guard, end, place(p, NEXT), m.speed)
    return rate


@inlined
def _interpolate(m: ModeRecord, t: float, h: float) -> None:
    """The polynomial of the step (Hairer, Norsett, Wanner, II.6): seven rows of n; and its samples."""
    p = explicit_call(m.trial)
    n, length = m.size, p.length
    step(p, t, h)
    _call_step(p.extend, t, h, length, p.work, p.evaluate, p.problem)
    stages, given = doubles(place(p, FIRST), m.stages * length), doubles(m.coefficients, 4 * m.stages)
    rows, y, end = doubles(m.dense, 7 * n), doubles(place(p, Y), length), doubles(place(p, NEXT), length)
    last = p.last_stage + 1 - FIRST  # the first of the further stages: the field at the end
    for i in range(n):
        change = end[i] - y[i]
        rows[i] = change
        rows[n + i] = h * stages[i] - change
        rows[2 * n + i] = 2.0 * change - h * (stages[i] + stages[last * length + i])
        for row in range(4):
            total = 0.0
            for stage in range(m.stages):
                total += given[row * m.stages + stage] * stages[stage * length + i]
            rows[(3 + row) * n + i] = h * total
    for part in range(1, PARTS):
        _draw(m, h, part / PARTS, _sample(m, part), _sample(m, part) + 8 * n)
    m.drawn = 1


@inlined
def _sample(m: ModeRecord, part: int) -> int:
    """Address of the state that a part of the step begins with; its velocity comes after it."""
    return m.between + 16 * (part - 1) * m.size


@inlined
def _draw(m: ModeRecord, h: float, share: float, state: int, velocity: int) -> None:
    """State and velocity at a share of the step, by its polynomial."""
    n, p = m.size, explicit_call(m.trial)
    rows, y = doubles(m.dense, 7 * n), doubles(place(p, Y), n)
    x, f = doubles(state, n), doubles(velocity, n)
    draw(n, rows, y, h, share, x, f)


@inlined
def _between(m: ModeRecord, guard: int, t: float, h: float, share: float) -> tuple[float, float]:
    """Value and rate of a guard at a share of the step, by its polynomial."""
    _draw(m, h, share, m.spare, m.speed)
    value, rate, _ = measured(m, guard, t + share * h, m.spare, m.speed)
    return value, rate


# -- zeros --------------------------------------------------------------------------------------------------


@inlined
def _located(
    m: ModeRecord, guard: int, t: float, low: float, high: float, guess: float, side: float
) -> float:
    """The instant between two at which the guard is zero: Newton's method, bisection where it leaves them.

    `side` is that of the guard before it. `UNRESOLVED` where it has no value at a trial.
    """
    end, best, smallest = guess, guess, math.inf
    at = standing(m, guard)
    for _ in range(MOST_TRIALS):
        if not low < end < high:
            end = low + 0.5 * (high - low)
        value, noise = _retake(m, guard, t, end)
        if not abs(value) < math.inf:
            return UNRESOLVED
        if abs(value) < smallest:
            best, smallest = end, abs(value)
        if abs(value) <= noise:
            break
        rate = _retaken_rate(m, guard, end)
        if sided(at, end, value, rate) == side:
            low = end
        else:
            high = end
        new = end - value / rate if rate != 0.0 else math.nan
        if new == end or high - low <= 2.0 * EPSILON * max(abs(low), abs(high)):
            break
        end = new
    return best


@inlined
def _cubic_zero(a: float, slope_a: float, b: float, slope_b: float) -> float:
    """The zero in 0..1 of the cubic polynomial with these values and slopes at its ends."""
    low, high, share = 0.0, 1.0, 0.5
    c2, c3 = 3.0 * (b - a) - 2.0 * slope_a - slope_b, 2.0 * (a - b) + slope_a + slope_b
    share = a / (a - b)
    for _ in range(8):
        value = a + share * (slope_a + share * (c2 + share * c3))
        slope = slope_a + share * (2.0 * c2 + 3.0 * share * c3)
        if (value > 0.0) == (a > 0.0):
            low = share
        else:
            high = share
        new = share - value / slope if slope != 0.0 else -1.0
        share = new if low <= new <= high else 0.5 * (low + high)
    return share


@inlined
def passes_once(m: ModeRecord, guard: int, t: float, h: float, value: float, rate: float) -> float:
    """The instant at which a guard that only rises or only falls passes zero; `NONE` if the other way."""
    at, wanted = standing(m, guard), integers(m.directions, guard + 1)[guard]
    side = begins_on(at)
    if wanted != 0 and -side != wanted:
        return NONE
    share = _cubic_zero(at.value, h * at.rate, value, h * rate) if at.value != 0.0 else 0.5
    return _located(m, guard, t, t, t + h, t + share * h, side)


@inlined
def _near(m: ModeRecord, guard: int, t: float, h: float, a: float, b: float, side: float) -> float:
    """Where the guard on the step's polynomial is zero between two shares."""
    share, at = 0.5 * (a + b), standing(m, guard)
    for _ in range(MOST_TRIALS):
        value, rate = _between(m, guard, t, h, share)
        if sided(at, t + share * h, value, rate) == side:
            a = share
        else:
            b = share
        new = share - value / (rate * h) if rate != 0.0 else -1.0
        if not a <= new <= b:
            new = 0.5 * (a + b)
        done = abs(new - share) <= 1e-11
        share = new
        if done:
            break
    return share


@inlined
def _beyond(m: ModeRecord, guard: int, t: float, h: float, part: int, side: float) -> float:
    """A share beyond zero in a part where the guard nears it and turns; `NONE` if it turns before.

    `UNRESOLVED` where it has no value at a trial.
    """
    samples, stands = doubles(m.samples, 2 * (PARTS + 1)), standing(m, guard)
    a, b = part / PARTS, (part + 1) / PARTS
    rate_a, rate_b = samples[2 * part + 1], samples[2 * part + 3]
    least = min(abs(samples[2 * part]), abs(samples[2 * part + 2]))
    for _ in range(MOST_TRIALS):
        # At twice the rates that it has at the ends it would not get to zero.
        if (b - a) * PARTS <= NARROW or least > REACH * h * (b - a) * max(abs(rate_a), abs(rate_b)):
            break
        share = 0.5
        if rate_a != rate_b:
            share = min(0.9, max(0.1, rate_a / (rate_a - rate_b)))
        at = a + share * (b - a)
        value, _ = _retake(m, guard, t, t + at * h)
        if not abs(value) < math.inf:
            return UNRESOLVED
        rate = _retaken_rate(m, guard, t + at * h)
        if sided(stands, t + at * h, value, rate) != side:
            return at
        least = min(least, abs(value))
        if value * rate < 0.0:
            a, rate_a = at, rate
        else:
            b, rate_b = at, rate
    return NONE


@inlined
def _sampled(m: ModeRecord, guard: int, t: float, h: float, value: float, rate: float) -> bool:
    """Fill the samples; whether they resolve the guard."""
    at, samples = standing(m, guard), doubles(m.samples, 2 * (PARTS + 1))
    samples[0], samples[1], rounded = at.value, at.rate, at.band
    samples[2 * PARTS], samples[2 * PARTS + 1] = value, rate
    for part in range(1, PARTS):
        state, at_part = _sample(m, part), t + part / PARTS * h
        value, rate, noise = measured(m, guard, at_part, state, state + 8 * m.size)
        samples[2 * part], samples[2 * part + 1] = value, rate
        rounded = max(rounded, ROUNDED * noise)
        if at.left_at == math.inf and abs(value) > at.band:
            at.left_at = at_part
    d, resolved = 2.0 * h / PARTS, True
    for part in range(1, PARTS + 1):
        if not abs(samples[2 * part]) < math.inf:
            return False
    for part in range(1, PARTS, 2):
        va, ra = samples[2 * part - 2], samples[2 * part - 1]
        vb, rb = samples[2 * part + 2], samples[2 * part + 3]
        inside, sloping = samples[2 * part], samples[2 * part + 1]
        variation = abs(vb - va) + d * max(abs(ra), abs(rb), abs(sloping))
        off = abs(inside - 0.5 * (va + vb) - 0.125 * d * (ra - rb))
        off_slope = d * abs(sloping - 1.5 * (vb - va) / d + 0.25 * (ra + rb))
        near = min(abs(va), abs(vb), abs(inside)) <= REACH * variation
        if near and (off > MISSED * variation + rounded or off_slope > MISSED_SLOPE * variation + rounded):
            resolved = False
    return resolved


@inlined
def resolves(m: ModeRecord, guard: int, t: float, h: float, value: float, rate: float) -> bool:
    """Whether a step with this end resolves a guard."""
    if m.drawn == 0:
        _interpolate(m, t, h)
    return _sampled(m, guard, t, h, value, rate)


@inlined
def passes(m: ModeRecord, guard: int, t: float, h: float, value: float, rate: float) -> float:
    """The instant of a guard's first event in a step with this end; `NONE`, or `UNRESOLVED`."""
    if not resolves(m, guard, t, h, value, rate):
        return UNRESOLVED
    samples, wanted = doubles(m.samples, 2 * (PARTS + 1)), integers(m.directions, guard + 1)[guard]
    at = standing(m, guard)
    before = begins_on(at)
    for part in range(PARTS):
        va, ra = samples[2 * part], samples[2 * part + 1]
        vb, rb = samples[2 * part + 2], samples[2 * part + 3]
        a, b = part / PARTS, (part + 1) / PARTS
        after = sided(at, t + b * h, vb, rb)
        # The interpolation errs: the zero may be a little outside of its part.
        low, high = t + h * max(0.0, a - 1.0 / PARTS), t + h * min(1.0, b + 1.0 / PARTS)
        if before != after:
            if wanted == 0 or after == wanted:
                guess = t + h * _near(m, guard, t, h, a, b, before)
                return _located(m, guard, t, low, high, guess, before)
        elif va * ra < 0.0 and vb * rb > 0.0:
            middle = _beyond(m, guard, t, h, part, before)
            if middle == UNRESOLVED:
                return UNRESOLVED
            if middle >= 0.0:
                turn = t + h * middle
                if wanted == 0 or before != wanted:
                    return _located(m, guard, t, low, turn, 0.5 * (low + turn), before)
                return _located(m, guard, t, turn, high, 0.5 * (turn + high), -before)
        before = after
    return NONE
