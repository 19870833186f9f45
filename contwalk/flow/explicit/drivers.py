"""Paths of explicit methods, compiled by numba: the loops around the steps of `stages`.

A driver takes the address of an `ExplicitCall`. It is imported only in order to be compiled.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import caller, doubles, inlined, integers, record
from contwalk.flow.explicit.explicit_call import (
    DONE,
    FIRST_ROWS,
    FULL,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TOO_MANY_STEPS,
    Counts,
    ExplicitCall,
    PolynomialCall,
    StepControl,
)
from contwalk.flow.explicit.stages import FIRST, NEXT, STAGE, Y

EPSILON = 2.0**-52
LEAST_FIRST = 1e2  # roundings of the time in a first step
TARGET = 0.4  # of the tolerance: at 1, every second step would be rejected
MOST_GROWTH, MOST_SHRINKAGE = 6.0, 0.2
SHRINKAGE_WHERE_UNDEFINED = 0.1

# A step that is tried again must become shorter even after its end has been rounded: this many roundings
# long.
LEAST_SHRINKAGE, ROUNDINGS = 0.9, 16.0

explicit_call, step_control, counts_at = record(ExplicitCall), record(StepControl), record(Counts)
polynomial_call = record(PolynomialCall)
_call_step = caller("v", "ddqqqq")
_call_error = caller("d", "ddqqqqq")
_evaluate = caller("v", "qdqq")


@inlined
def place(p: ExplicitCall, number: int) -> int:
    """Address of a vector of the memory of the method."""
    return p.work + 8 * number * p.length


@inlined
def copy(source: int, target: int, length: int) -> None:
    """Doubles from one address to another."""
    given, written = doubles(source, length), doubles(target, length)
    for i in range(length):
        written[i] = given[i]


@inlined
def first_stage(p: ExplicitCall, t: float, vector: int) -> None:
    """The field at a vector becomes the first stage."""
    _evaluate(p.evaluate, p.problem, t, place(p, vector), place(p, FIRST))


@inlined
def step(p: ExplicitCall, t: float, h: float) -> None:
    """A step of length h from `Y`, whose first stage is there; its end is in `NEXT`."""
    _call_step(p.step, t, h, p.length, p.work, p.evaluate, p.problem)


@inlined
def _error(p: ExplicitCall, t: float, h: float) -> float:
    """RMS of the estimated error, in units of the weights."""
    places = p.length, p.work, p.evaluate, p.problem, p.inverse_weights
    return _call_error(p.error, t, h, *places) / math.sqrt(p.n)


@inlined
def finite(vector: Any) -> bool:
    """Whether all entries are: NaN and infinity times zero are not zero."""
    total = 0.0
    for i in range(len(vector)):
        total += 0.0 * vector[i]
    return total == 0.0


@inlined
def _distance(a: Any, b: Any, scale: Any) -> float:
    total = 0.0
    for i in range(len(a)):
        total += ((a[i] - b[i]) * scale[i]) ** 2
    return math.sqrt(total)


@inlined
def _size(a: Any, scale: Any) -> float:
    total = 0.0
    for i in range(len(a)):
        total += (a[i] * scale[i]) ** 2
    return math.sqrt(total)


@inlined
def _rounded(p: ExplicitCall, tolerance: float) -> float:
    """Roundings of a step's end, in units of the tolerance: no error below them can be asked for.

    They are far below it unless a motion runs off: towards a pole every step would be refused.
    """
    scale = doubles(p.inverse_weights, p.n)
    size = _size(doubles(place(p, NEXT), p.n), scale) / math.sqrt(p.n)
    return max(1.0, EPSILON * size / tolerance)


@inlined
def _first_length(p: ExplicitCall, t: float, t1: float, order: float, tolerance: float) -> float:
    """A first step, from the sizes of the first and second derivatives (Hairer, Norsett, Wanner, II.4)."""
    m, scale = p.length, doubles(p.inverse_weights, p.length)
    y, stage = doubles(place(p, Y), m), doubles(place(p, STAGE), m)
    k0, k1 = doubles(place(p, FIRST), m), doubles(place(p, FIRST + 1), m)
    size, slope = _size(y, scale) / tolerance, _size(k0, scale) / tolerance
    span = abs(t1 - t)
    h = 0.01 * size / slope if size > 1e-5 and slope > 1e-5 else 1e-6 * span
    h = min(max(h, LEAST_FIRST * EPSILON * abs(t)), span)  # what is zero but for rounding has no size
    for i in range(m):
        stage[i] = y[i] + math.copysign(h, t1 - t) * k0[i]
    _evaluate(p.evaluate, p.problem, t + math.copysign(h, t1 - t), stage.ctypes.data, k1.ctypes.data)
    bend = _distance(k1, k0, scale) / tolerance / h
    largest = max(bend, slope)
    if not largest < math.inf:
        return h
    longer = (0.01 / largest) ** (1.0 / order) if largest > 1e-15 else max(1e-6 * span, 1e-3 * h)
    return min(100.0 * h, longer, span)


@inlined
def _end(t: float, t1: float, h: float) -> float:
    """End of a step of about length h: the last two of a path are of equal length, and the end is met."""
    left = t1 - t
    if 1.01 * h >= abs(left):
        return t1
    return t + 0.5 * left if 2.0 * h > abs(left) else t + math.copysign(h, left)


@inlined
def _is_stiff(p: ExplicitCall, h: float, stable: float) -> bool:
    """Whether the step is as long as stability allows (Hairer, Wanner, IV.2).

    The field's largest rate is seen in the difference of two states at the end of the step. The field there
    is the first stage already.
    """
    scale = doubles(p.inverse_weights, p.length)
    m = p.length
    end, stage = doubles(place(p, NEXT), m), doubles(place(p, STAGE), m)
    apart = _distance(end, stage, scale)
    if apart <= 100.0 * EPSILON * _size(end, scale):  # rounding
        return False
    slope, former = doubles(place(p, FIRST), m), doubles(place(p, p.last_stage), m)
    return abs(h) * _distance(slope, former, scale) > stable * apart


@inlined
def _keep(p: ExplicitCall, node: int) -> None:
    """The end of a step becomes the state, and is written down."""
    copy(place(p, NEXT), place(p, Y), p.length)
    copy(place(p, NEXT), p.nodes + 8 * node * p.length, p.length)


@inlined
def _factor(error: float, former: float, order: float) -> float:
    """By how much the next step may be longer: proportional and integral control (Gustafsson)."""
    factor = (error / TARGET) ** (-0.7 / order) * (former / TARGET) ** (0.4 / order)
    return min(MOST_GROWTH, max(MOST_SHRINKAGE, factor))


@inlined
def accepted_step(p: ExplicitCall, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Try lengths until a step towards t1 is allowed; `DONE` when it is.

    The first stage is that of the state `Y`, at the time in the memory. When the step is allowed, its end is
    in `NEXT`, the first stage is that of the end, and the memory is that of the end.
    """
    control, counts = step_control(p.control), counts_at(p.counts)
    t, h, former = control.time, control.length, control.error
    undefined, after_rejection = control.undefined != 0.0, False
    if h == 0.0:
        h = _first_length(p, t, t1, order, tolerance)
        counts.evaluations += 1
    while True:
        end = _end(t, t1, h)
        length = end - t
        # A first length that is not a number, of rates whose squares overflow, gets no better by trying.
        if not abs(length) > 0.0 or (abs(length) < ROUNDINGS * EPSILON * abs(t) and end != t1):
            return NOT_FINITE if undefined else STEP_TOO_SMALL
        step(p, t, length)
        error = _error(p, t, length) / tolerance
        if error > 1.0 and p.far_out != 0:
            error /= _rounded(p, tolerance)
        counts.evaluations += p.last_stage - FIRST
        accepted = error <= 1.0
        if accepted:
            first_stage(p, end, NEXT)
            counts.evaluations += 1
            if not (finite(doubles(place(p, NEXT), p.length)) and finite(doubles(place(p, FIRST), p.length))):
                error, accepted = math.nan, False
                first_stage(p, t, Y)
                counts.evaluations += 1
        if accepted:
            break
        counts.rejected += 1
        after_rejection = True
        undefined = not error < math.inf
        factor = min(LEAST_SHRINKAGE, _factor(error, TARGET, order))
        h = abs(length) * (SHRINKAGE_WHERE_UNDEFINED if undefined else factor)
    if _is_stiff(p, length, stable):
        counts.stiff += 1
    factor = _factor(error, former if former > 0.0 else max(error, 1e-4), order)
    control.time, control.length = end, abs(length) * (min(factor, 1.0) if after_rejection else factor)
    control.error, control.undefined = max(error, 1e-4), 0.0
    return DONE


def adaptive(address: int, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Steps with error control up to t1, or until there is no more room; called again, it goes on.

    The memory holds: time, length of the next step, error of the last one, whether an attempt was undefined.
    """
    p = explicit_call(address)
    control, counts = step_control(p.control), counts_at(p.counts)
    times = doubles(p.times, p.room + 1)
    first_stage(p, control.time, Y)
    counts.evaluations += 1
    if not finite(doubles(place(p, FIRST), p.length)):
        return NOT_FINITE
    while control.time != t1:
        if counts.steps >= p.most_steps:
            return TOO_MANY_STEPS
        if counts.steps >= p.room:
            return FULL
        status = accepted_step(p, t1, tolerance, order, stable)
        if status != DONE:
            return status
        counts.steps += 1
        _keep(p, counts.steps)
        times[counts.steps] = control.time
    return DONE


def march(address: int) -> int:
    """One step from each of the given times to the next; with the steps' errors, if these have a place."""
    p = explicit_call(address)
    steps = p.room
    times, errors = doubles(p.times, steps + 1), doubles(p.errors, steps)
    for i in range(steps):
        t, h = times[i], times[i + 1] - times[i]
        first_stage(p, t, Y)
        step(p, t, h)
        if p.errors != 0:
            errors[i] = _error(p, t, h)
        _keep(p, i + 1 if p.every != 0 else 0)
    return DONE


def march_each(address: int) -> int:
    """Several paths one after the other, in steps as `march`: where a time is repeated the next one begins.

    Their ends take the places of their starts.
    """
    p = explicit_call(address)
    n, length, start = p.n, p.length, p.starts
    times = doubles(p.times, p.room + 1)
    copy(start, place(p, Y), length)
    copy(start, p.states, n)
    for i in range(p.room):
        t, h = times[i], times[i + 1] - times[i]
        if h == 0.0:
            copy(place(p, Y), start, length)
            start += 8 * length
            copy(start, place(p, Y), length)
        else:
            first_stage(p, t, Y)
            step(p, t, h)
            copy(place(p, NEXT), place(p, Y), length)
        copy(place(p, Y), p.states + 8 * (i + 1) * n, n)
    copy(place(p, Y), start, length)
    return DONE


def leap(address: int, targets: int) -> int:
    """For each target a step from a node to it: `WHICH` says from which one."""
    p = explicit_call(address)
    which, until = integers(p.which, p.room), doubles(targets, p.room)
    for j in range(p.room):
        copy(p.nodes + 8 * which[j] * p.n, place(p, Y), p.n)
        t = doubles(p.times, which[j] + 1)[which[j]]
        first_stage(p, t, Y)
        step(p, t, until[j] - t)
        copy(place(p, NEXT), p.out + 8 * j * p.length, p.length)
    return DONE


def polynomials(address: int) -> int:
    """Coefficients of the polynomials of the steps from the nodes `WHICH`, row by row.

    Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.6.
    """
    p = explicit_call(address)
    which, size = integers(p.which, p.room), (FIRST_ROWS + p.rows) * p.n
    for j in range(p.room):
        start = p.nodes + 8 * which[j] * p.n
        copy(start, place(p, Y), p.n)
        times = doubles(p.times, which[j] + 2)
        t, h = times[which[j]], times[which[j] + 1] - times[which[j]]
        first_stage(p, t, Y)
        step(p, t, h)
        _call_step(p.extend, t, h, p.length, p.work, p.evaluate, p.problem)
        _coefficients(p, h, start, p.out + 8 * j * size)
    return DONE


@inlined
def _coefficients(p: Any, h: float, start: int, out: int) -> None:
    """Coefficients of the step whose stages are in the memory."""
    n, rows = p.n, p.rows
    begin, end, c = doubles(start, n), doubles(start + 8 * n, n), doubles(out, (FIRST_ROWS + rows) * n)
    first, last = doubles(place(p, FIRST), n), doubles(place(p, p.last_stage + 1), n)
    for i in range(n):
        change = end[i] - begin[i]
        bend = h * first[i] - change
        c[i], c[n + i], c[2 * n + i] = change, bend, change - h * last[i] - bend
    stages = p.vectors - FIRST
    weights = doubles(p.dense, rows * stages)
    for row in range(rows):
        own = doubles(out + 8 * (FIRST_ROWS + row) * n, n)
        for i in range(n):
            own[i] = 0.0
        for k in range(stages):
            weight = weights[row * stages + k]
            if weight != 0.0:
                stage = doubles(place(p, FIRST + k), n)
                for i in range(n):
                    own[i] += weight * stage[i]
        for i in range(n):
            own[i] *= h


def interpolate(address: int) -> int:
    """The polynomials of a `PolynomialCall` at its times. At a node it is the node.

    start + s (c0 + (1 - s) (c1 + s (c2 + ...))), where s is the part of the step that has passed.
    """
    call = polynomial_call(address)
    n, rows, count = call.n, call.rows, call.count
    nodes, coefficients, out = call.nodes, call.coefficients, call.out
    grid, wanted, own = (
        doubles(call.times, call.steps + 1),
        doubles(call.wanted, count),
        integers(call.which, call.steps),
    )
    k = 0
    for j in range(count):
        t = wanted[j]
        if not (grid[k] <= t and t < grid[k + 1]):
            k = _step_of(grid, t)
        begin, found = doubles(nodes + 8 * k * n, n), doubles(out + 8 * j * n, n)
        if t == grid[k] or t == grid[k + 1]:
            copy(nodes + 8 * (k + 1 if t == grid[k + 1] else k) * n, out + 8 * j * n, n)
            continue
        s = (t - grid[k]) / (grid[k + 1] - grid[k])
        for i in range(n):
            found[i] = 0.0
        for row in range(rows - 1, -1, -1):
            c, factor = (
                doubles(coefficients + 8 * (own[k] * rows + row) * n, n),
                s if row % 2 == 0 else 1.0 - s,
            )
            for i in range(n):
                found[i] = (found[i] + c[i]) * factor
        for i in range(n):
            found[i] += begin[i]
    return DONE


@inlined
def _step_of(grid: Any, t: float) -> int:
    """The last step that begins at a time or before it, or the first one of all."""
    low, high = 0, len(grid)
    while low < high:
        middle = (low + high) // 2
        if t < grid[middle]:
            high = middle
        else:
            low = middle + 1
    return min(max(low - 1, 0), len(grid) - 2)
