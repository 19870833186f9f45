"""How a guard stands where a motion begins, for numba: clear of zero, leaving it, or past it.

What is uncertain of a guard's rate and of its second derivative needs the Jacobian of the field, which is
asked for only where a guard is zero but for rounding. The field's own roundings are known by a running error
analysis. One of its acceleration would be a graph several times as large again: that is taken to be rounded
like a sum of its states' shares, |J| |f|, by so many roundings as a field has operations one after the other,
and to inherit what its states do not know.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import call_rhs, caller, doubles, inlined, integers
from contwalk.flow.hybrid.course_plan import (
    ANSWER,
    ANSWER_LENGTH,
    BEND,
    BEYOND,
    CLEAR,
    COLUMNS,
    CONSTANTS,
    ENTERING,
    FOUND,
    KNOWN,
    LEAVING,
    MOTION,
    NOISE,
    PARAMETERS,
    PLAN_LENGTH,
    RATE,
    RESTING,
    RHS_JAC,
    ROWS,
    SIDE,
    SIZE,
    SLOPED,
    STATE,
    UNDEFINED,
    VALUE,
    VALUE_NOISE,
    VARIATION,
    VARIED,
    VELOCITY,
    WEIGHTS,
)

EPSILON = 2.0**-52
JUST_AFTER = 4.0  # roundings of the time
ROUNDINGS = 8.0  # a number counts as zero within so many of its uncertainties
IN_A_ROW = 16.0  # roundings

_call_slopes = caller("v", "dqqqq")


@inlined
def _finite_size(value: float) -> float:
    """Derivatives that do not exist tell nothing."""
    return abs(value) if abs(value) < math.inf else 0.0


@inlined
def _coarseness(k: Any) -> float:
    """How far second derivatives are off, of themselves: as their states are, of their magnitudes."""
    noise, weights, most = doubles(k[NOISE], 1 + k[SIZE]), doubles(k[WEIGHTS], k[SIZE]), EPSILON
    for i in range(k[SIZE]):
        most = max(most, noise[1 + i] / weights[i])
    return IN_A_ROW * most


@inlined
def _know(k: Any, t: float) -> None:
    """Acceleration of the states, and how uncertain it and the velocity are."""
    n = k[SIZE]
    rows = integers(k[ROWS], n + 1)
    columns = integers(k[COLUMNS], rows[n])
    call_rhs(k[RHS_JAC], t, k[STATE], k[CONSTANTS], k[FOUND])
    call_rhs(k[VARIATION], t, k[STATE], k[PARAMETERS], k[VARIED])
    entries, varied = doubles(k[FOUND] + 8 * n, rows[n]), doubles(k[VARIED], 2 * n)
    f, noise, motion = doubles(k[VELOCITY], n), doubles(k[NOISE], 1 + n), doubles(k[MOTION], 3 * n)
    for i in range(n):
        motion[i] = EPSILON * varied[i] + _finite_size(varied[n + i]) * noise[0]
        motion[n + i] = varied[n + i]
        for e in range(rows[i], rows[i + 1]):
            motion[i] += _finite_size(entries[e]) * noise[1 + columns[e]]
            motion[n + i] += entries[e] * f[columns[e]]
    coarse = _coarseness(k)
    for i in range(n):
        motion[2 * n + i] = coarse * abs(varied[n + i])
        for e in range(rows[i], rows[i + 1]):
            j = columns[e]
            motion[2 * n + i] += abs(entries[e]) * (motion[j] + coarse * abs(f[j]))
    k[KNOWN] = 1


@inlined
def _uncertain_rate(k: Any) -> float:
    """How far the rate of the guard in `SLOPED` is off."""
    n = k[SIZE]
    slopes, f = doubles(k[SLOPED], 4 + 2 * n), doubles(k[VELOCITY], n)
    noise, motion = doubles(k[NOISE], 1 + n), doubles(k[MOTION], 3 * n)
    total = IN_A_ROW * EPSILON * abs(slopes[2]) + abs(slopes[3 + n]) * noise[0]
    for i in range(n):
        total += abs(slopes[4 + n + i]) * noise[1 + i]
        if slopes[3 + i] != 0.0:
            total += abs(slopes[3 + i]) * (IN_A_ROW * EPSILON * abs(f[i]) + motion[i])
    return total


@inlined
def _bend(k: Any) -> tuple[float, float]:
    """Second derivative by time of the guard in `SLOPED`, and its uncertainty."""
    n = k[SIZE]
    slopes, f, motion = doubles(k[SLOPED], 4 + 2 * n), doubles(k[VELOCITY], n), doubles(k[MOTION], 3 * n)
    coarse = _coarseness(k)
    value, total = slopes[3 + n], coarse * abs(slopes[3 + n])
    for i in range(n):
        slope, change = slopes[3 + i], slopes[4 + n + i]
        if change != 0.0:
            value += change * f[i]
            total += abs(change) * (coarse * abs(f[i]) + 2.0 * motion[i])
        if slope != 0.0:
            value += slope * motion[n + i]
            total += abs(slope) * (coarse * abs(motion[n + i]) + motion[2 * n + i])
    return value, total


@inlined
def _of_time_alone(slopes: Any, n: int) -> bool:
    """Whether the guard in `SLOPED` moves with time only: no reset can keep it from going on.

    At zero right after its event it has been left behind.
    """
    moved = slopes[2] == 0.0
    for i in range(n):
        moved = moved or slopes[3 + i] != 0.0 or slopes[4 + n + i] != 0.0
    return not moved


@inlined
def stands(k: Any, slopes_address: int, direction: int, t: float, factor: float, beside: float) -> int:
    """How a guard stands; the answer is in place. See `departure.departures`.

    Parameters
    ----------
    factor : float
        It counts as zero within so many of its uncertainties: of more than `ROUNDINGS` right after its event.
    beside : float
        And within so many of those that rounding makes of the magnitudes of the states.
    """
    n = k[SIZE]
    slopes, f, noise = doubles(k[SLOPED], 4 + 2 * n), doubles(k[VELOCITY], n), doubles(k[NOISE], 1 + n)
    weights, answer = doubles(k[WEIGHTS], n), doubles(k[ANSWER], ANSWER_LENGTH)
    after = t + JUST_AFTER * EPSILON * abs(t)  # as in `guard.just_after`
    _call_slopes(slopes_address, after, k[STATE], k[VELOCITY], k[PARAMETERS], k[SLOPED])
    value, rate, own = slopes[0], slopes[2], EPSILON * slopes[1]
    inherited = on_the_way = abs(slopes[2]) * noise[0]
    clock = _of_time_alone(slopes, n)
    for i in range(n):
        slope = slopes[3 + i]
        if slope != 0.0:
            rate += slope * f[i]
            inherited += abs(slope) * noise[1 + i]
            on_the_way += abs(slope) * EPSILON * weights[i]
    answer[VALUE], answer[VALUE_NOISE], answer[RATE], answer[BEND] = value, own + inherited, rate, math.nan
    answer[SIDE] = 0.0
    if not abs(value) < math.inf:
        return UNDEFINED
    if abs(value) > factor * (own + inherited) and abs(value) > beside * (own + on_the_way):
        answer[SIDE] = 1.0 if value > 0.0 else -1.0
        return BEYOND if answer[SIDE] == direction else CLEAR
    if k[KNOWN] == 0:
        _know(k, t)
    answer[BEND], uncertain = _bend(k)
    if abs(rate) > ROUNDINGS * _uncertain_rate(k):
        answer[SIDE] = 1.0 if rate > 0.0 else -1.0
    else:
        answer[RATE] = 0.0  # what rounding has left of it is no rate
        if not abs(answer[BEND]) > ROUNDINGS * uncertain:
            answer[BEND] = 0.0 if abs(answer[BEND]) < math.inf else math.nan
            return RESTING
        answer[SIDE] = 1.0 if answer[BEND] > 0.0 else -1.0
    happened = clock and factor > ROUNDINGS
    return ENTERING if answer[SIDE] == direction and not happened else LEAVING


def standing(
    address: int, slopes_address: int, direction: int, t: float, factor: float, beside: float
) -> int:
    """As `stands`, by C's rules."""
    return stands(integers(address, PLAN_LENGTH), slopes_address, direction, t, factor, beside)
