"""Many motions one after the other, each watched for crossings and stopped where it comes to rest.

The loop around the steps of `stages`, for numba. Each motion has its own parameters and stop rule, and no
memory of those before it, so that its result does not depend on which others are computed beside it. Imported
only where it is compiled.
"""

from __future__ import annotations

import math
from ctypes import sizeof

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, caller, doubles, inlined, integers, record
from contwalk.flow.ensemble.sampling_records import (
    FOUND,
    GIVEN_UP,
    NOT_FINITE,
    SETTLED,
    TIME_UP,
    SampleResult,
    SamplingCall,
)
from contwalk.flow.events.polynomial_kernel import draw, side_of
from contwalk.flow.explicit.drivers import place
from contwalk.flow.explicit.stages import FIRST, NEXT, Y

EPSILON = 2.0**-52
SAFETY = 0.9
MOST_GROWTH, MOST_SHRINKAGE = 6.0, 0.2
ORDER = 8.0
PARTS = 4  # of a step that may hold crossings: a guard has at most one extremum in each
MOST_TRIALS = 80
AT_END = FIRST + 12  # the first of the further stages of the interpolation: the field at the end
NARROW = 1e-8  # of a part, where an extremum is looked for: the guard is then off it by rounding

_sampling_call, _sample_result = record(SamplingCall), record(SampleResult)
_RESULT_LENGTH = sizeof(SampleResult)
_call_step = caller("v", "ddqqqq")
_call_guard = caller("v", "dqqqq")
_call_error = caller("d", "ddqqqqq")


@inlined
def _size(p: SamplingCall, vector: np.ndarray) -> float:
    """RMS norm in units of the weights."""
    scale, total = doubles(p.inverse_weights, p.length), 0.0
    for i in range(p.n):
        total += (vector[i] * scale[i]) ** 2
    return math.sqrt(total / p.n)


@inlined
def _measure(p: SamplingCall, t: float, state: int, velocity: int, parameters: int) -> tuple[float, float]:
    """Value and rate of the guard."""
    _call_guard(p.guard, t, state, velocity, parameters, p.measured)
    out = doubles(p.measured, 3)
    return out[0], out[1]


@inlined
def _try_step(p: SamplingCall, t: float, h: float) -> float:
    """Take a step; the RMS of its estimated error in units of the weights."""
    _call_step(p.step, t, h, p.length, p.work, p.evaluate, p.problem)
    places = p.length, p.work, p.evaluate, p.problem, p.inverse_weights
    return _call_error(p.error, t, h, *places) / math.sqrt(p.n)


# -- crossings within a step ---------------------------------------------------------------------------------


@inlined
def _interpolate(p: SamplingCall, t: float, h: float) -> None:
    """The polynomial of the step that was taken (Hairer, Norsett, Wanner, II.6): seven rows of n."""
    _call_step(p.extend, t, h, p.length, p.work, p.evaluate, p.problem)
    n, m = p.n, p.length
    rows, y, end = doubles(p.dense, 7 * n), doubles(place(p, Y), m), doubles(place(p, NEXT), m)
    first, last = doubles(place(p, FIRST), m), doubles(place(p, AT_END), m)
    stages, given = doubles(place(p, FIRST), p.stages * m), doubles(p.coefficients, 4 * p.stages)
    for i in range(n):
        change = end[i] - y[i]
        rows[i] = change
        rows[n + i] = h * first[i] - change
        rows[2 * n + i] = 2.0 * change - h * (first[i] + last[i])
        for row in range(4):
            total = 0.0
            for stage in range(p.stages):
                total += given[row * p.stages + stage] * stages[stage * m + i]
            rows[(3 + row) * n + i] = h * total


@inlined
def _between(p: SamplingCall, t: float, h: float, share: float, parameters: int) -> tuple[float, float]:
    """Value and rate of the guard at a share of the step, both by its polynomial."""
    n, rows, y = p.n, doubles(p.dense, 7 * p.n), doubles(place(p, Y), p.length)
    x, f = doubles(p.spare, p.length), doubles(p.speed, p.length)
    draw(n, rows, y, h, share, x, f)
    return _measure(p, t + share * h, p.spare, p.speed, parameters)


@inlined
def _zero(p: SamplingCall, t: float, h: float, parameters: int, a: float, side: float, b: float) -> float:
    """Where the guard passes zero between two shares: Newton's method, bisection where it leaves them."""
    share = 0.5 * (a + b)
    for _ in range(MOST_TRIALS):
        value, rate = _between(p, t, h, share, parameters)
        if value == 0.0 or b - a <= 4.0 * EPSILON:
            break
        if side_of(value, rate) == side:
            a = share
        else:
            b = share
        new = share - value / (rate * h) if rate != 0.0 else -1.0
        if not a <= new <= b:
            new = 0.5 * (a + b)
        if abs(new - share) <= EPSILON * abs(new):
            break
        share = new
    return share


@inlined
def _beyond(
    p: SamplingCall,
    t: float,
    h: float,
    parameters: int,
    left: tuple[float, float],
    side: float,
    right: tuple[float, float],
) -> float:
    """A share on the other side of zero between two that near it; -1 if the guard turns before.

    `left` and `right` are the shares with the rates there, `side` is the sign at the left one.
    """
    (a, rate_a), (b, rate_b) = left, right
    narrow, share = NARROW * (b - a), 0.5
    for _ in range(MOST_TRIALS):
        if b - a <= narrow:
            break
        at = a + share * (b - a)
        value, rate = _between(p, t, h, at, parameters)
        if side_of(value, rate) != side:
            return at
        if value * rate < 0.0:
            a, rate_a = at, rate
        else:
            b, rate_b = at, rate
        share = 0.5 if rate_a == rate_b else min(0.9, max(0.1, rate_a / (rate_a - rate_b)))
    return -1.0


@inlined
def _crossing(p: SamplingCall, t: float, h: float, parameters: int, value: float, rate: float) -> float:
    """The crossing of the step that counts, the first or the last one of its direction; NaN without one."""
    wanted = float(p.direction)
    found = math.nan
    a, value_a, rate_a = 0.0, value, rate
    for part in range(PARTS):
        b = (part + 1) / PARTS
        value_b, rate_b = _between(p, t, h, b, parameters)
        side_a, side_b = side_of(value_a, rate_a), side_of(value_b, rate_b)
        left, right, side = a, b, side_a
        hit = side_a != side_b and side_b == wanted
        if side_a == side_b and value_a * rate_a < 0.0 and value_b * rate_b > 0.0:
            middle = _beyond(p, t, h, parameters, (a, rate_a), side_a, (b, rate_b))
            hit = middle >= 0.0
            if side_a == wanted:  # out of the side and back: the way back counts
                left, side = middle, -side_a
            else:
                right = middle
        if hit:
            found = _zero(p, t, h, parameters, left, side, right)
            if p.first_only != 0:
                return t + found * h
        a, value_a, rate_a = b, value_b, rate_b
    return t + found * h


# -- one motion ----------------------------------------------------------------------------------------------


@inlined
def _at_rest(p: SamplingCall, state: np.ndarray, targets: np.ndarray) -> bool:
    """Whether the state is within the given distances of one of the targets; angles count by their turns."""
    n = p.n
    within, periods = doubles(p.within, n), doubles(p.periods, n)
    for target in range(p.targets):
        near = True
        for i in range(n):
            apart = state[i] - targets[target * n + i]
            if periods[i] > 0.0:
                apart -= periods[i] * math.floor(apart / periods[i] + 0.5)
            if not abs(apart) <= within[i]:
                near = False
        if near:
            return True
    return False


@inlined
def _begin(p: SamplingCall, sample: int) -> None:
    """State and field's constants of a sample into place."""
    y, x = doubles(place(p, Y), p.length), doubles(p.starts + 8 * sample * p.n, p.n)
    for i in range(p.length):
        y[i] = x[i] if i < p.n else 0.0
    problem = integers(p.problem, 2)
    problem[0], problem[1] = p.rhs, p.fields + 8 * sample * p.constants


@inlined
def _move(p: SamplingCall, sample: int, t1: float, tolerance: float, result: SampleResult) -> int:
    """A motion from its start until it rests, or its time is up; `result` is filled in."""
    m, parameters = p.length, p.values + 8 * sample * p.parameters
    targets = doubles(p.places + 8 * sample * p.targets * p.n, p.targets * p.n)
    y, end, slope = doubles(place(p, Y), m), doubles(place(p, NEXT), m), doubles(place(p, FIRST), m)
    slope_end, constants = doubles(place(p, AT_END), m), integers(p.problem, 2)[1]
    t, steps, former = 0.0, 0, 1e-4
    call_rhs(p.rhs, t, place(p, Y), constants, place(p, FIRST))
    value, rate = _measure(p, t, place(p, Y), place(p, FIRST), parameters)
    speed = _size(p, slope)
    if not speed < math.inf or not abs(value) < math.inf:
        return NOT_FINITE
    if _at_rest(p, y, targets):
        return SETTLED
    h = min(0.5 * tolerance ** (1.0 / ORDER) / max(speed, 1e-30), 1e-2 * t1)
    undefined, after_rejection = False, False
    while True:
        result.ended_at = t
        if t >= t1:
            return TIME_UP
        if steps >= p.most_steps:
            return GIVEN_UP
        length = min(h, t1 - t)
        if length <= 4.0 * EPSILON * t and length < t1 - t:
            return NOT_FINITE if undefined else GIVEN_UP
        error = _try_step(p, t, length) / tolerance
        steps += 1
        if not error <= 1.0:
            undefined, after_rejection = not error < math.inf, True
            h = length * (0.1 if undefined else max(MOST_SHRINKAGE, SAFETY * error ** (-1.0 / ORDER)))
            continue
        late = t1 if length == t1 - t else t + length
        call_rhs(p.rhs, late, place(p, NEXT), constants, place(p, AT_END))
        value_end, rate_end = _measure(p, late, place(p, NEXT), place(p, AT_END), parameters)
        if not abs(value_end) < math.inf:
            return NOT_FINITE
        reach = 2.0 * length * max(abs(rate), abs(rate_end))  # as far as it may go and come back
        if side_of(value, rate) != side_of(value_end, rate_end) or min(abs(value), abs(value_end)) <= reach:
            _interpolate(p, t, length)
            at = _crossing(p, t, length, parameters, value, rate)
            if at >= 0.0:
                result.crossed_at, result.crossed = at, 1.0
                if p.first_only != 0:
                    result.ended_at = late
                    return FOUND
        for i in range(m):
            y[i], slope[i] = end[i], slope_end[i]
        t, value, rate = late, value_end, rate_end
        result.ended_at = t
        if _at_rest(p, y, targets):
            return SETTLED
        error = max(error, 1e-4)
        factor = SAFETY * error ** (-0.7 / ORDER) * former ** (0.4 / ORDER)
        factor = min(1.0 if after_rejection else MOST_GROWTH, max(MOST_SHRINKAGE, factor))
        h, former, undefined, after_rejection = length * factor, error, False, False


def batch(call: int, first: int, last: int, tolerance: float) -> int:
    """The motions of samples first, first + 1, ... before last."""
    p = _sampling_call(call)
    limits = doubles(p.limits, last)
    for sample in range(first, last):
        result = _sample_result(p.results + sample * _RESULT_LENGTH)
        result.crossed_at, result.crossed, result.ended_at = 0.0, 0.0, 0.0
        _begin(p, sample)
        result.ended = _move(p, sample, limits[sample], tolerance, result)
    return last - first
