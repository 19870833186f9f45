"""Paths of explicit methods, compiled by numba: the loops around the steps of `stages`.

A driver takes the address of its `plan`, an array of integers and addresses. It is imported
only in order to be compiled.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import caller, doubles, inlined, integers
from contwalk.flow.explicit import plan
from contwalk.flow.explicit.stages import FIRST, NEXT, STAGE, Y

EPSILON = 2.0**-52
LEAST_FIRST = 1e2  # roundings of the time in a first step
TARGET = 0.4  # of the tolerance: at 1, every second step would be rejected
MOST_GROWTH, MOST_SHRINKAGE = 6.0, 0.2
SHRINKAGE_WHERE_UNDEFINED = 0.1

# A step that is tried again must become shorter even after its end has been rounded: this many roundings
# long.
LEAST_SHRINKAGE, ROUNDINGS = 0.9, 16.0

_call_step = caller("v", "ddqqqq")
_call_error = caller("d", "ddqqqqq")
_evaluate = caller("v", "qdqq")


@inlined
def place(p: Any, number: int) -> int:
    """Address of a vector of the memory of the method."""
    return p[plan.WORK] + 8 * number * p[plan.LENGTH]


@inlined
def copy(source: int, target: int, length: int) -> None:
    given, written = doubles(source, length), doubles(target, length)
    for i in range(length):
        written[i] = given[i]


@inlined
def first_stage(p: Any, t: float, vector: int) -> None:
    _evaluate(p[plan.EVALUATE], p[plan.PROBLEM], t, place(p, vector), place(p, FIRST))


@inlined
def step(p: Any, t: float, h: float) -> None:
    _call_step(p[plan.STEP], t, h, p[plan.LENGTH], p[plan.WORK], p[plan.EVALUATE], p[plan.PROBLEM])


@inlined
def _error(p: Any, t: float, h: float) -> float:
    """RMS of the estimated error, in units of the weights."""
    places = p[plan.LENGTH], p[plan.WORK], p[plan.EVALUATE], p[plan.PROBLEM], p[plan.INVERSE_WEIGHTS]
    return _call_error(p[plan.ERROR], t, h, *places) / math.sqrt(p[plan.N])


@inlined
def finite(vector: Any) -> bool:
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
def _rounded(p: Any, tolerance: float) -> float:
    """Roundings of a step's end, in units of the tolerance: no error below them can be asked for.

    They are far below it unless a motion runs off: towards a pole every step would be refused.
    """
    scale = doubles(p[plan.INVERSE_WEIGHTS], p[plan.N])
    size = _size(doubles(place(p, NEXT), p[plan.N]), scale) / math.sqrt(p[plan.N])
    return max(1.0, EPSILON * size / tolerance)


@inlined
def _first_length(p: Any, t: float, t1: float, order: float, tolerance: float) -> float:
    """A first step, from the sizes of the first and second derivatives (Hairer, Norsett, Wanner, II.4)."""
    m, scale = p[plan.LENGTH], doubles(p[plan.INVERSE_WEIGHTS], p[plan.LENGTH])
    y, stage = doubles(place(p, Y), m), doubles(place(p, STAGE), m)
    k0, k1 = doubles(place(p, FIRST), m), doubles(place(p, FIRST + 1), m)
    size, slope = _size(y, scale) / tolerance, _size(k0, scale) / tolerance
    span = abs(t1 - t)
    h = 0.01 * size / slope if size > 1e-5 and slope > 1e-5 else 1e-6 * span
    h = min(max(h, LEAST_FIRST * EPSILON * abs(t)), span)  # what is zero but for rounding has no size
    for i in range(m):
        stage[i] = y[i] + math.copysign(h, t1 - t) * k0[i]
    _evaluate(
        p[plan.EVALUATE], p[plan.PROBLEM], t + math.copysign(h, t1 - t), stage.ctypes.data, k1.ctypes.data
    )
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
def _is_stiff(p: Any, h: float, stable: float) -> bool:
    """Whether the step is as long as stability allows (Hairer, Wanner, IV.2).

    The field's largest rate is seen in the difference of two states at the end of the step. The field there
    is the first stage already.
    """
    scale = doubles(p[plan.INVERSE_WEIGHTS], p[plan.LENGTH])
    m = p[plan.LENGTH]
    end, stage = doubles(place(p, NEXT), m), doubles(place(p, STAGE), m)
    apart = _distance(end, stage, scale)
    if apart <= 100.0 * EPSILON * _size(end, scale):  # rounding
        return False
    slope, former = doubles(place(p, FIRST), m), doubles(place(p, p[plan.LAST_STAGE]), m)
    return abs(h) * _distance(slope, former, scale) > stable * apart


@inlined
def _keep(p: Any, node: int) -> None:
    """The end of a step becomes the state, and is written down."""
    copy(place(p, NEXT), place(p, Y), p[plan.LENGTH])
    copy(place(p, NEXT), p[plan.NODES] + 8 * node * p[plan.LENGTH], p[plan.LENGTH])


@inlined
def _factor(error: float, former: float, order: float) -> float:
    """By how much the next step may be longer: proportional and integral control (Gustafsson)."""
    factor = (error / TARGET) ** (-0.7 / order) * (former / TARGET) ** (0.4 / order)
    return min(MOST_GROWTH, max(MOST_SHRINKAGE, factor))


@inlined
def accepted_step(p: Any, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Try lengths until a step towards t1 is allowed; `plan.DONE` when it is.

    The first stage is that of the state `Y`, at the time in the memory. When the step is allowed, its end is
    in `NEXT`, the first stage is that of the end, and the memory is that of the end.
    """
    memory, counts = doubles(p[plan.MEMORY], plan.MEMORY_LENGTH), integers(p[plan.COUNTS], plan.COUNTS_LENGTH)
    t, h, former = memory[0], memory[1], memory[2]
    undefined, after_rejection = memory[3] != 0.0, False
    if h == 0.0:
        h = _first_length(p, t, t1, order, tolerance)
        counts[plan.EVALUATIONS] += 1
    while True:
        end = _end(t, t1, h)
        length = end - t
        if length == 0.0 or (abs(length) < ROUNDINGS * EPSILON * abs(t) and end != t1):
            return plan.NOT_FINITE if undefined else plan.STEP_TOO_SMALL
        step(p, t, length)
        error = _error(p, t, length) / tolerance
        if error > 1.0 and p[plan.FAR_OUT] != 0:
            error /= _rounded(p, tolerance)
        counts[plan.EVALUATIONS] += p[plan.LAST_STAGE] - FIRST
        accepted = error <= 1.0
        if accepted:
            first_stage(p, end, NEXT)
            counts[plan.EVALUATIONS] += 1
            if not (
                finite(doubles(place(p, NEXT), p[plan.LENGTH]))
                and finite(doubles(place(p, FIRST), p[plan.LENGTH]))
            ):
                error, accepted = math.nan, False
                first_stage(p, t, Y)
                counts[plan.EVALUATIONS] += 1
        if accepted:
            break
        counts[plan.REJECTED] += 1
        after_rejection = True
        undefined = not error < math.inf
        factor = min(LEAST_SHRINKAGE, _factor(error, TARGET, order))
        h = abs(length) * (SHRINKAGE_WHERE_UNDEFINED if undefined else factor)
    if _is_stiff(p, length, stable):
        counts[plan.STIFF] += 1
    factor = _factor(error, former if former > 0.0 else max(error, 1e-4), order)
    memory[0], memory[1] = end, abs(length) * (min(factor, 1.0) if after_rejection else factor)
    memory[2], memory[3] = max(error, 1e-4), 0.0
    return plan.DONE


def adaptive(address: int, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Steps with error control up to t1, or until there is no more room; called again, it goes on.

    The memory holds: time, length of the next step, error of the last one, whether an attempt was undefined.
    """
    p = integers(address, plan.PLAN_LENGTH)
    memory, counts = doubles(p[plan.MEMORY], plan.MEMORY_LENGTH), integers(p[plan.COUNTS], plan.COUNTS_LENGTH)
    times = doubles(p[plan.TIMES], p[plan.ROOM] + 1)
    first_stage(p, memory[0], Y)
    counts[plan.EVALUATIONS] += 1
    if not finite(doubles(place(p, FIRST), p[plan.LENGTH])):
        return plan.NOT_FINITE
    while memory[0] != t1:
        if counts[plan.STEPS] >= p[plan.MOST_STEPS]:
            return plan.TOO_MANY_STEPS
        if counts[plan.STEPS] >= p[plan.ROOM]:
            return plan.FULL
        status = accepted_step(p, t1, tolerance, order, stable)
        if status != plan.DONE:
            return status
        counts[plan.STEPS] += 1
        _keep(p, counts[plan.STEPS])
        times[counts[plan.STEPS]] = memory[0]
    return plan.DONE


def march(address: int) -> int:
    """One step from each of the given times to the next; with the steps' errors, if these have a place."""
    p = integers(address, plan.PLAN_LENGTH)
    steps = p[plan.ROOM]
    times, errors = doubles(p[plan.TIMES], steps + 1), doubles(p[plan.ERRORS], steps)
    for i in range(steps):
        t, h = times[i], times[i + 1] - times[i]
        first_stage(p, t, Y)
        step(p, t, h)
        if p[plan.ERRORS] != 0:
            errors[i] = _error(p, t, h)
        _keep(p, i + 1 if p[plan.EVERY] != 0 else 0)
    return plan.DONE


def march_each(address: int) -> int:
    """Several paths one after the other, in steps as `march`: where a time is repeated the next one begins.

    Their ends take the places of their starts.
    """
    p = integers(address, plan.PLAN_LENGTH)
    n, length, start = p[plan.N], p[plan.LENGTH], p[plan.STARTS]
    times = doubles(p[plan.TIMES], p[plan.ROOM] + 1)
    copy(start, place(p, Y), length)
    copy(start, p[plan.STATES], n)
    for i in range(p[plan.ROOM]):
        t, h = times[i], times[i + 1] - times[i]
        if h == 0.0:
            copy(place(p, Y), start, length)
            start += 8 * length
            copy(start, place(p, Y), length)
        else:
            first_stage(p, t, Y)
            step(p, t, h)
            copy(place(p, NEXT), place(p, Y), length)
        copy(place(p, Y), p[plan.STATES] + 8 * (i + 1) * n, n)
    copy(place(p, Y), start, length)
    return plan.DONE


def leap(address: int, targets: int) -> int:
    """For each target a step from a node to it: `plan.WHICH` says from which one."""
    p = integers(address, plan.PLAN_LENGTH)
    which, until = integers(p[plan.WHICH], p[plan.ROOM]), doubles(targets, p[plan.ROOM])
    for j in range(p[plan.ROOM]):
        copy(p[plan.NODES] + 8 * which[j] * p[plan.N], place(p, Y), p[plan.N])
        t = doubles(p[plan.TIMES], which[j] + 1)[which[j]]
        first_stage(p, t, Y)
        step(p, t, until[j] - t)
        copy(place(p, NEXT), p[plan.OUT] + 8 * j * p[plan.LENGTH], p[plan.LENGTH])
    return plan.DONE


def stages_of(address: int) -> int:
    """All stages of the steps from the nodes `plan.WHICH`, those for interpolation included."""
    p = integers(address, plan.PLAN_LENGTH)
    which = integers(p[plan.WHICH], p[plan.ROOM])
    size = (p[plan.VECTORS] - FIRST) * p[plan.LENGTH]
    for j in range(p[plan.ROOM]):
        copy(p[plan.NODES] + 8 * which[j] * p[plan.N], place(p, Y), p[plan.N])
        times = doubles(p[plan.TIMES], which[j] + 2)
        t, h = times[which[j]], times[which[j] + 1] - times[which[j]]
        first_stage(p, t, Y)
        step(p, t, h)
        _call_step(p[plan.EXTEND], t, h, p[plan.LENGTH], p[plan.WORK], p[plan.EVALUATE], p[plan.PROBLEM])
        copy(place(p, FIRST), p[plan.OUT] + 8 * j * size, size)
    return plan.DONE
