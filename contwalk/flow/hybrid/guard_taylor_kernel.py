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

from contwalk.flow.compiled.calling import call_rhs, caller, doubles, inlined, integers, record
from contwalk.flow.hybrid.guard_taylor_records import (
    BEYOND,
    CLEAR,
    ENTERING,
    LEAVING,
    RESTING,
    UNDEFINED,
    GuardTaylorCoefficients,
    Instant,
)

EPSILON = 2.0**-52
JUST_AFTER = 4.0  # roundings of the time
ROUNDINGS = 8.0  # a number counts as zero within so many of its uncertainties
IN_A_ROW = 16.0  # roundings

instant_at, coefficients_at = record(Instant), record(GuardTaylorCoefficients)
_call_slopes = caller("v", "dqqqq")


@inlined
def _finite_size(value: float) -> float:
    """Derivatives that do not exist tell nothing."""
    return abs(value) if abs(value) < math.inf else 0.0


@inlined
def _coarseness(k: Instant) -> float:
    """How far second derivatives are off, of themselves: as their states are, of their magnitudes."""
    noise, weights, most = doubles(k.noise, 1 + k.size), doubles(k.weights, k.size), EPSILON
    for i in range(k.size):
        most = max(most, noise[1 + i] / weights[i])
    return IN_A_ROW * most


@inlined
def _know(k: Instant, t: float) -> None:
    """Acceleration of the states, and how uncertain it and the velocity are."""
    n = k.size
    rows = integers(k.rows, n + 1)
    columns = integers(k.columns, rows[n])
    call_rhs(k.rhs_jac, t, k.state, k.constants, k.found)
    call_rhs(k.variation, t, k.state, k.parameters, k.varied)
    entries, varied = doubles(k.found + 8 * n, rows[n]), doubles(k.varied, 2 * n)
    f, noise, motion = doubles(k.velocity, n), doubles(k.noise, 1 + n), doubles(k.motion, 3 * n)
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
    k.known = 1


@inlined
def _uncertain_rate(k: Instant) -> float:
    """How far the rate of the guard in `SLOPED` is off."""
    n = k.size
    slopes, f = doubles(k.sloped, 4 + 2 * n), doubles(k.velocity, n)
    noise, motion = doubles(k.noise, 1 + n), doubles(k.motion, 3 * n)
    total = IN_A_ROW * EPSILON * abs(slopes[2]) + abs(slopes[3 + n]) * noise[0]
    for i in range(n):
        total += abs(slopes[4 + n + i]) * noise[1 + i]
        if slopes[3 + i] != 0.0:
            total += abs(slopes[3 + i]) * (IN_A_ROW * EPSILON * abs(f[i]) + motion[i])
    return total


@inlined
def _bend(k: Instant) -> tuple[float, float]:
    """Second derivative by time of the guard in `SLOPED`, and its uncertainty."""
    n = k.size
    slopes, f, motion = doubles(k.sloped, 4 + 2 * n), doubles(k.velocity, n), doubles(k.motion, 3 * n)
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
def stands(k: Instant, slopes_address: int, direction: int, t: float, factor: float, beside: float) -> int:
    """How a guard stands; the answer is in place. See `guard_status.guard_statuses`.

    Parameters
    ----------
    factor : float
        It counts as zero within so many of its uncertainties: of more than `ROUNDINGS` right after its event.
    beside : float
        And within so many of those that rounding makes of the magnitudes of the states.
    """
    n = k.size
    slopes, f, noise = doubles(k.sloped, 4 + 2 * n), doubles(k.velocity, n), doubles(k.noise, 1 + n)
    weights, answer = doubles(k.weights, n), coefficients_at(k.answer)
    after = t + JUST_AFTER * EPSILON * abs(t)  # as in `guard.just_after`
    _call_slopes(slopes_address, after, k.state, k.velocity, k.parameters, k.sloped)
    value, rate, own = slopes[0], slopes[2], EPSILON * slopes[1]
    inherited = on_the_way = abs(slopes[2]) * noise[0]
    clock = _of_time_alone(slopes, n)
    for i in range(n):
        slope = slopes[3 + i]
        if slope != 0.0:
            rate += slope * f[i]
            inherited += abs(slope) * noise[1 + i]
            on_the_way += abs(slope) * EPSILON * weights[i]
    answer.value, answer.value_noise, answer.rate, answer.bend = value, own + inherited, rate, math.nan
    answer.side = 0.0
    if not abs(value) < math.inf:
        return UNDEFINED
    if abs(value) > factor * (own + inherited) and abs(value) > beside * (own + on_the_way):
        answer.side = 1.0 if value > 0.0 else -1.0
        return BEYOND if answer.side == direction else CLEAR
    if k.known == 0:
        _know(k, t)
    answer.bend, uncertain = _bend(k)
    if abs(rate) > ROUNDINGS * _uncertain_rate(k):
        answer.side = 1.0 if rate > 0.0 else -1.0
    else:
        answer.rate = 0.0  # what rounding has left of it is no rate
        if not abs(answer.bend) > ROUNDINGS * uncertain:
            answer.bend = 0.0 if abs(answer.bend) < math.inf else math.nan
            return RESTING
        answer.side = 1.0 if answer.bend > 0.0 else -1.0
    happened = clock and factor > ROUNDINGS
    return ENTERING if answer.side == direction and not happened else LEAVING


def standing(
    address: int, slopes_address: int, direction: int, t: float, factor: float, beside: float
) -> int:
    """As `stands`, by C's rules."""
    return stands(instant_at(address), slopes_address, direction, t, factor, beside)
