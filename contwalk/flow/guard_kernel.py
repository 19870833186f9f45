"""Where a guard passes zero within one step, for numba: found on the step's polynomial, located by re-stepping.

As `events` does it for paths that are there already. A step whose guard cannot come near zero is not looked
at: its value at both ends is larger than what twice the largest rate of late could take away. On the others
the guard is sampled. If cubic polynomials through every second sample miss those between, it is not resolved, and
the step has to be shorter.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow import plan
from contwalk.flow.calling import call_rhs, caller, doubles, inlined, integers
from contwalk.flow.explicit_drivers import EPSILON, copy, first_stage, place, step
from contwalk.flow.hybrid_plan import (
    ADDRESSES,
    COEFFICIENTS,
    DENSE,
    DIRECTIONS,
    MEASURED,
    MOVING,
    PARAMETERS,
    SAMPLES,
    SPARE,
    STAGES,
    TRIAL,
)
from contwalk.flow.stages import FIRST, NEXT, Y

PARTS = 8  # of a step: a guard has at most one extremum in each
REACH = 1.0  # of step length times rate: as far as a guard may go, half of it there and half back
MISSED = 0.1  # of its variation: by how much a sample may miss a cubic polynomial
MOST_TRIALS = 60
NARROW = 1e-8  # of a part: the guard is then off its extremum by rounding
NONE, UNRESOLVED = -1.0, -2.0

_call_step = caller("v", "ddqqqq")


@inlined
def measured(m: Any, guard: int, t: float, state: int) -> tuple[float, float, float]:
    """Value, rate and uncertainty of a guard."""
    address = integers(m[ADDRESSES], guard + 1)[guard]
    call_rhs(address, t, state, m[PARAMETERS], m[MEASURED])
    out = doubles(m[MEASURED], 3)
    return out[0], out[1], out[2] * EPSILON


@inlined
def side_of(value: float, rate: float) -> float:
    """The sign just after an instant."""
    at = value if value != 0.0 else rate
    return 1.0 if at > 0.0 else -1.0


@inlined
def tried(m: Any, t: float, h: float) -> None:
    """Take the step anew in the plan to try, with its polynomial (Hairer, Norsett, Wanner, II.6)."""
    p, moving = integers(m[TRIAL], plan.PLAN_LENGTH), integers(m[MOVING], plan.PLAN_LENGTH)
    n, length = p[plan.N], p[plan.LENGTH]
    copy(place(moving, Y), place(p, Y), n)
    first_stage(p, t, Y)
    step(p, t, h)
    _call_step(p[plan.EXTEND], t, h, length, p[plan.WORK], p[plan.EVALUATE], p[plan.PROBLEM])
    stages, given = doubles(place(p, FIRST), m[STAGES] * length), doubles(m[COEFFICIENTS], 4 * m[STAGES])
    rows, y, end = doubles(m[DENSE], 7 * n), doubles(place(p, Y), length), doubles(place(p, NEXT), length)
    last = p[plan.LAST_STAGE] + 1 - FIRST  # the first of the further stages: the field at the end
    for i in range(n):
        change = end[i] - y[i]
        rows[i] = change
        rows[n + i] = h * stages[i] - change
        rows[2 * n + i] = 2.0 * change - h * (stages[i] + stages[last * length + i])
        for row in range(4):
            total = 0.0
            for stage in range(m[STAGES]):
                total += given[row * m[STAGES] + stage] * stages[stage * length + i]
            rows[(3 + row) * n + i] = h * total


@inlined
def _between(m: Any, guard: int, t: float, h: float, share: float) -> tuple[float, float]:
    """Value and rate of a guard at a share of the step, by its polynomial."""
    p = integers(m[TRIAL], plan.PLAN_LENGTH)
    n = p[plan.N]
    rows, y, x = doubles(m[DENSE], 7 * n), doubles(place(p, Y), n), doubles(m[SPARE], n)
    for i in range(n):
        value = 0.0
        for row in range(7):
            value = (value + rows[(6 - row) * n + i]) * (share if row % 2 == 0 else 1.0 - share)
        x[i] = y[i] + value
    value, rate, _ = measured(m, guard, t + share * h, m[SPARE])
    return value, rate


@inlined
def _retaken(m: Any, guard: int, t: float, end: float) -> tuple[float, float, float]:
    """A guard at the end of a step of another length; its state is in `NEXT` of the plan to try."""
    p = integers(m[TRIAL], plan.PLAN_LENGTH)
    step(p, t, end - t)
    return measured(m, guard, end, place(p, NEXT))


@inlined
def _sampled(m: Any, guard: int, t: float, h: float, value: float, rate: float) -> bool:
    """Fill the samples; whether they resolve the guard."""
    samples = doubles(m[SAMPLES], 2 * (PARTS + 1))
    samples[0], samples[1] = value, rate
    for part in range(1, PARTS + 1):
        samples[2 * part], samples[2 * part + 1] = _between(m, guard, t, h, part / PARTS)
    d = 2.0 * h / PARTS
    resolved = True
    for part in range(1, PARTS, 2):
        va, ra = samples[2 * part - 2], samples[2 * part - 1]
        vb, rb = samples[2 * part + 2], samples[2 * part + 3]
        inside, sloping = samples[2 * part], samples[2 * part + 1]
        variation = abs(vb - va) + d * max(abs(ra), abs(rb), abs(sloping))
        off = abs(inside - 0.5 * (va + vb) - 0.125 * d * (ra - rb))
        # Far from zero it need not be known so well.
        if off > MISSED * variation and min(abs(va), abs(vb), abs(inside)) <= 2.0 * variation:
            resolved = False
    return resolved


@inlined
def _near(m: Any, guard: int, t: float, h: float, a: float, b: float, side: float) -> float:
    """The zero of the polynomial's guard between two shares of the step."""
    share = 0.5 * (a + b)
    for _ in range(MOST_TRIALS):
        value, rate = _between(m, guard, t, h, share)
        if value == 0.0 or b - a <= 4.0 * EPSILON:
            break
        if side_of(value, rate) == side:
            a = share
        else:
            b = share
        new = share - value / (rate * h) if rate != 0.0 else -1.0
        if not a < new < b:
            new = 0.5 * (a + b)
        if abs(new - share) <= 1e-12:
            share = new
            break
        share = new
    return share


@inlined
def _located(m: Any, guard: int, t: float, h: float, a: float, b: float, side: float) -> float:
    """The instant between two shares of the step, on different sides of zero, at which the guard is zero."""
    end = t + h * _near(m, guard, t, h, a, b, side)
    low, high = t + h * a, t + h * b
    best, smallest = end, math.inf
    for _ in range(MOST_TRIALS):
        if not low < end < high:
            end = low + 0.5 * (high - low)
        value, rate, noise = _retaken(m, guard, t, end)
        if abs(value) < smallest:
            best, smallest = end, abs(value)
        if abs(value) <= noise:
            return end
        if side_of(value, rate) == side:
            low = end
        else:
            high = end
        if high - low <= 2.0 * EPSILON * max(abs(low), abs(high)):
            break
        new = end - value / rate if rate != 0.0 else math.nan
        if new == end:
            break
        end = new
    return best


@inlined
def _beyond(m: Any, guard: int, t: float, h: float, part: int, side: float) -> float:
    """A share on the other side of zero in a part where the guard nears it and turns; -1 if it turns before."""
    samples = doubles(m[SAMPLES], 2 * (PARTS + 1))
    a, b = part / PARTS, (part + 1) / PARTS
    rate_a, rate_b = samples[2 * part + 1], samples[2 * part + 3]
    share = 0.5
    for _ in range(MOST_TRIALS):
        if (b - a) * PARTS <= NARROW:
            break
        if rate_a != rate_b:
            share = min(0.9, max(0.1, rate_a / (rate_a - rate_b)))
        at = a + share * (b - a)
        value, rate, _ = _retaken(m, guard, t, t + at * h)
        if side_of(value, rate) != side:
            return at
        if value * rate < 0.0:
            a, rate_a = at, rate
        else:
            b, rate_b = at, rate
    return -1.0


@inlined
def passes(m: Any, guard: int, t: float, h: float, value: float, rate: float) -> float:
    """The instant of the guard's first event in the step that was `tried`; `NONE`, or `UNRESOLVED`.

    Value and rate are those at the start, where a guard that is leaving zero has the value 0.
    """
    if not _sampled(m, guard, t, h, value, rate):
        return UNRESOLVED
    samples, wanted = doubles(m[SAMPLES], 2 * (PARTS + 1)), float(integers(m[DIRECTIONS], guard + 1)[guard])
    for part in range(PARTS):
        va, ra, vb, rb = (
            samples[2 * part],
            samples[2 * part + 1],
            samples[2 * part + 2],
            samples[2 * part + 3],
        )
        before, after = side_of(va, ra), side_of(vb, rb)
        left, right = part / PARTS, (part + 1) / PARTS
        if before != after:
            if wanted == 0.0 or after == wanted:
                return _located(m, guard, t, h, left, right, before)
        elif va * ra < 0.0 and vb * rb > 0.0:
            middle = _beyond(m, guard, t, h, part, before)
            if middle >= 0.0:
                if wanted == 0.0 or before != wanted:
                    return _located(m, guard, t, h, left, middle, before)
                return _located(m, guard, t, h, middle, right, -before)
    return NONE
