"""Arcs of a hybrid machine and their derivatives in one compiled walk, for numba.

The steps are those of `explicit.drivers`. With columns of derivatives each step moves them too; at a
transition they are multiplied by its saltation matrix (P. C. Mueller, Calculation of Lyapunov exponents for
dynamic systems with discontinuities, Chaos, Solitons and Fractals 5 (1995) 1671-1681). What needs more
thought than a glance at values and rates is left to the careful way of `motions`.
"""

from __future__ import annotations

import math
from typing import Any

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined, integers
from contwalk.flow.explicit import plan
from contwalk.flow.explicit.drivers import EPSILON, accepted_step, copy, finite, first_stage, place, step
from contwalk.flow.explicit.stages import FIRST, NEXT, Y
from contwalk.flow.hybrid import course_plan
from contwalk.flow.hybrid.course_kernel import stands
from contwalk.flow.hybrid.guard_kernel import (
    CLEAR,
    MONOTONE,
    NONE,
    SUSPECT,
    UNRESOLVED,
    begin_trials,
    looks,
    measured,
    passes,
    passes_once,
    resolves,
    standing,
)
from contwalk.flow.hybrid.walk_plan import (
    ARRIVED,
    AWAY,
    BAND,
    BEGINS,
    CLOCK,
    COLUMN,
    COLUMNS,
    CONSTANTS,
    COUNT,
    COURSE,
    DIRECTIONS,
    ENTRIES,
    EVENTS,
    FASTEST,
    FIRST_OF_ALL,
    FULL,
    GIVEN,
    GOES_ON,
    GUARDS,
    HAPPENED,
    JUMP,
    LEADS,
    LEAVES,
    LEVELS,
    MARKS,
    MODE,
    MODE_LENGTH,
    MODES,
    MOST_BITS,
    MOVING,
    NOISE,
    NOT_FINITE,
    OF_GUARD,
    OUTPUTS,
    OWN,
    OWN_STEPS,
    PASSED,
    PASSES,
    RATE,
    RATE_AT_END,
    ROOM,
    ROWS,
    SHIFT,
    SIZE,
    SLOPES,
    SLOPING,
    SPEEDS,
    STEP_TOO_SMALL,
    STEPS,
    TAKEN,
    TARGET,
    TIME_UP,
    TIMES,
    TRANSITION_LENGTH,
    TRANSITIONS,
    TRIAL,
    UNSURE,
    VALUE,
    VALUE_AT_END,
    WALK_LENGTH,
    WIDTH,
    WORD,
)

COINCIDE = 8.0
ROUNDINGS, AFTER_RESET = 8.0, 1e3  # as in `departure`
LEFT = 2.0  # a guard has left zero where it is so many times what it began with of rounding
MOST_SHORTENED = 30  # times in a row, where a guard is not resolved
SHORTEST = 1e3  # roundings of the time in a step that does not resolve one
_EVENT = 100  # and more: the guard's number is added


# -- where an arc begins ------------------------------------------------------------------------------------


@inlined
def _stands(m: Any, guard: int, own: bool, passed: bool, t: float) -> bool:
    """Write down how a guard stands; whether nothing happens there."""
    k, at = integers(m[COURSE], course_plan.PLAN_LENGTH), doubles(standing(m, guard), OF_GUARD)
    sloping = integers(m[SLOPING], guard + 1)[guard]
    direction = integers(m[DIRECTIONS], guard + 1)[guard]
    kind = stands(k, sloping, direction, t, AFTER_RESET if own else ROUNDINGS, ROUNDINGS)
    answer = doubles(k[course_plan.ANSWER], course_plan.ANSWER_LENGTH)
    at[VALUE], at[RATE] = answer[course_plan.VALUE], answer[course_plan.RATE]
    at[BEGINS], at[FASTEST], at[BAND] = 0.0, 0.0, 0.0
    if kind == course_plan.ENTERING and passed and at[RATE] != 0.0:  # as in `departure`
        kind = course_plan.LEAVING
    if kind == course_plan.LEAVING:
        at[BAND] = LEFT * abs(at[VALUE])
        at[VALUE], at[BEGINS] = 0.0, answer[course_plan.SIDE]
    if kind == course_plan.BEYOND:
        return integers(m[LEVELS], guard + 1)[guard] == 0
    return kind == course_plan.CLEAR or kind == course_plan.LEAVING


@inlined
def _has(bits: int, guard: int) -> bool:
    return guard < MOST_BITS and (bits >> guard) & 1 == 1


@inlined
def _begin(m: Any, own: int, passed: int, t: float) -> int:
    """The first stage of an arc, and its guards; `ARRIVED`, or why it cannot begin.

    `own` has a bit for each guard that what has just happened leaves at zero, `passed` for each of these
    that it has passed in its own direction.
    """
    p = integers(m[MOVING], plan.PLAN_LENGTH)
    first_stage(p, t, Y)
    if not (finite(doubles(place(p, Y), m[SIZE])) and finite(doubles(place(p, FIRST), m[SIZE]))):
        return UNSURE
    memory = doubles(p[plan.MEMORY], plan.MEMORY_LENGTH)
    memory[0], memory[1], memory[2], memory[3] = t, 0.0, 0.0, 0.0
    leads = integers(m[LEADS], m[GUARDS])
    integers(m[COURSE], course_plan.PLAN_LENGTH)[course_plan.KNOWN] = 0
    for guard in range(m[GUARDS]):
        if leads[guard] < 0:
            at = doubles(standing(m, guard), OF_GUARD)
            at[VALUE], at[RATE], _ = measured(m, guard, t, place(p, Y), place(p, FIRST))
            at[BEGINS], at[FASTEST], at[BAND] = 0.0, 0.0, 0.0
        elif not _stands(m, guard, _has(own, guard), _has(passed, guard), t):
            return UNSURE
    return ARRIVED


# -- up to the next event -----------------------------------------------------------------------------------


@inlined
def _first_event(m: Any, t: float, end: float) -> tuple[float, int, int]:
    """The first event in the step that ends in `NEXT`: instant, or `NONE`, and guard.

    And the watched guards that may pass zero in the step, a bit for each. `FIRST` is the velocity at its end.
    """
    p, leads = integers(m[MOVING], plan.PLAN_LENGTH), integers(m[LEADS], m[GUARDS])
    first, which, begun, marked = NONE, -1, False, 0
    for guard in range(m[GUARDS]):
        value, rate, _ = measured(m, guard, end, place(p, NEXT), place(p, FIRST))
        at_end = doubles(standing(m, guard), OF_GUARD)
        at_end[VALUE_AT_END], at_end[RATE_AT_END] = value, rate
        look = looks(m, guard, end - t, value, rate)
        if look == CLEAR:
            continue
        if not begun:
            begin_trials(m, t)
            begun = True
        if leads[guard] < 0:
            marked |= 1 << min(guard, MOST_BITS)
            if look == SUSPECT and not resolves(m, guard, t, end - t, value, rate):
                return UNRESOLVED, guard, marked
            continue
        if look == MONOTONE:
            at = passes_once(m, guard, t, end - t, value, rate)
        else:
            at = passes(m, guard, t, end - t, value, rate)
        if at == UNRESOLVED:
            return UNRESOLVED, guard, marked
        if at != NONE and (first == NONE or at < first - COINCIDE * EPSILON * abs(at)):
            first, which = at, guard
    return first, which, marked


@inlined
def _go_on(m: Any) -> bool:
    """The step's end, where the guards are measured, becomes the state; whether all have values there."""
    p = integers(m[MOVING], plan.PLAN_LENGTH)
    sound = True
    for guard in range(m[GUARDS]):
        at = doubles(standing(m, guard), OF_GUARD)
        at[VALUE], at[RATE] = at[VALUE_AT_END], at[RATE_AT_END]
        if not abs(at[VALUE]) <= at[BAND]:
            at[BEGINS], at[BAND] = 0.0, 0.0
        sound = sound and abs(at[VALUE]) < math.inf
    copy(place(p, NEXT), place(p, Y), p[plan.LENGTH])
    return sound


@inlined
def _arc(w: Any, m: Any, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Steps until an event, whose guard's number is added to `_EVENT`, or until they end otherwise."""
    p, clock = integers(m[MOVING], plan.PLAN_LENGTH), doubles(w[CLOCK], 1)
    memory, times = doubles(p[plan.MEMORY], plan.MEMORY_LENGTH), doubles(w[TIMES], w[ROOM] + 1)
    happened, marks = integers(w[HAPPENED], WORD), integers(w[MARKS], w[ROOM])
    t, steps, shortened = clock[0], 0, 0
    if happened[GOES_ON] == 0:
        status = _begin(m, happened[OWN], happened[PASSED], t)
        if status != ARRIVED:
            return status
    happened[GOES_ON], happened[OWN_STEPS], times[0] = 0, 0, t
    while t != t1:
        if steps >= w[ROOM]:
            happened[GOES_ON] = 1
            return FULL
        status = accepted_step(p, t1, tolerance, order, stable)
        if status != plan.DONE:
            return NOT_FINITE if status == plan.NOT_FINITE else STEP_TOO_SMALL
        end = memory[0]
        at, guard, marked = _first_event(m, t, end)
        if at == UNRESOLVED:
            shortened += 1
            # A kink where the guard is zero, or a jump through zero.
            if shortened > MOST_SHORTENED or end - t < SHORTEST * EPSILON * abs(t):
                return UNSURE
            memory[0], memory[1] = t, 0.5 * (end - t)
            first_stage(p, t, Y)
            continue
        shortened = 0
        if at != NONE:
            if not at > t:
                return UNSURE
            first_stage(p, t, Y)
            step(p, t, at - t)
            copy(place(p, NEXT), place(p, Y), p[plan.LENGTH])
            end = at
        elif not _go_on(m):
            return UNSURE
        marks[steps] = marked
        steps += 1
        happened[STEPS] += 1
        happened[OWN_STEPS] = steps
        t, times[steps], clock[0] = end, end, end
        if p[plan.NODES] != 0:
            copy(place(p, Y), p[plan.NODES] + 8 * steps * p[plan.LENGTH], p[plan.LENGTH])
        if at != NONE:
            return _EVENT + guard
    return TIME_UP


# -- through a transition -----------------------------------------------------------------------------------


@inlined
def _derivatives(w: Any, m: Any, to: Any, j: Any, n: int) -> None:
    """Columns of derivatives through a transition: G_x X + (F+ - G_x F - G_t) (h_x X) / (h_x F + h_t)."""
    q, width, rows = w[COLUMNS], w[WIDTH], j[OUTPUTS]
    p, after = integers(m[MOVING], plan.PLAN_LENGTH), integers(to[MOVING], plan.PLAN_LENGTH)
    given = doubles(place(p, Y) + 8 * (p[plan.LENGTH] - n * width), n * width)
    found = doubles(place(after, Y) + 8 * (after[plan.LENGTH] - rows * width), rows * width)
    slopes, speeds = doubles(j[SLOPES], (rows + 1) * (n + 1)), doubles(j[SPEEDS], n + rows)
    column, shift, rate = doubles(w[COLUMN], rows), doubles(w[SHIFT], q), slopes[rows * (n + 1)]
    for i in range(n):
        rate += slopes[rows * (n + 1) + 1 + i] * speeds[i]
    for k in range(q):
        earlier = 0.0
        for i in range(n):
            earlier += slopes[rows * (n + 1) + 1 + i] * given[i * width + k]
        earlier /= rate
        shift[k] = -earlier
        for r in range(rows):
            jump = speeds[n + r] - slopes[r * (n + 1)]
            total = 0.0
            for i in range(n):
                slope = slopes[r * (n + 1) + 1 + i]
                jump -= slope * speeds[i]
                total += slope * given[i * width + k]
            column[r] = total + jump * earlier
        for r in range(rows):  # given and found are the same memory where the mode stays
            found[r * width + k] = column[r]


@inlined
def _through(w: Any, number: int) -> int:
    """Apply a transition: state, uncertainties, derivatives; `ARRIVED`, or why not."""
    happened, clock = integers(w[HAPPENED], WORD), doubles(w[CLOCK], 1)
    j = integers(w[TRANSITIONS] + 8 * number * TRANSITION_LENGTH, TRANSITION_LENGTH)
    m = integers(w[MODES] + 8 * happened[MODE] * MODE_LENGTH, MODE_LENGTH)
    to = integers(w[MODES] + 8 * j[TARGET] * MODE_LENGTH, MODE_LENGTH)
    n, rows, t = m[SIZE], j[OUTPUTS], clock[0]
    p, trial = integers(m[MOVING], plan.PLAN_LENGTH), integers(m[TRIAL], plan.PLAN_LENGTH)
    y, taken = doubles(place(p, Y), n), doubles(j[TAKEN], n + 1)
    speeds = doubles(j[SPEEDS], n + rows)
    copy(place(p, Y), place(trial, Y), n)
    first_stage(trial, t, Y)
    copy(place(trial, FIRST), j[SPEEDS], n)
    taken[0] = t
    for i in range(n):
        taken[1 + i] = y[i]
    call_rhs(j[JUMP], 0.0, j[TAKEN], j[CONSTANTS], j[GIVEN])
    given, starts = doubles(j[GIVEN], rows + 1), integers(j[ROWS], rows + 2)
    entries, columns = (
        doubles(j[GIVEN] + 8 * (rows + 1), starts[rows + 1]),
        integers(j[ENTRIES], starts[rows + 1]),
    )
    slopes, noise = doubles(j[SLOPES], (rows + 1) * (n + 1)), doubles(to[NOISE], 1 + rows)
    for i in range((rows + 1) * (n + 1)):
        slopes[i] = 0.0
    noise[0] = EPSILON * abs(t)
    for r in range(rows + 1):
        total = 0.0
        for e in range(starts[r], starts[r + 1]):
            slopes[r * (n + 1) + columns[e]] = entries[e]
            uncertain = EPSILON * abs(t)
            if columns[e] > 0:
                uncertain = EPSILON * abs(y[columns[e] - 1]) + uncertain * abs(speeds[columns[e] - 1])
            total += abs(entries[e]) * uncertain
        if r < rows:
            noise[1 + r] = EPSILON * abs(given[r]) + total
    moving, tried = integers(to[MOVING], plan.PLAN_LENGTH), integers(to[TRIAL], plan.PLAN_LENGTH)
    copy(j[GIVEN], place(tried, Y), rows)
    if not finite(given):
        return UNSURE
    first_stage(tried, t, Y)
    copy(place(tried, FIRST), j[SPEEDS] + 8 * n, rows)
    if w[COLUMNS] > 0:
        _derivatives(w, m, to, j, n)
    copy(j[GIVEN], place(moving, Y), rows)
    happened[MODE], happened[OWN], happened[PASSED] = j[TARGET], j[LEAVES], j[PASSES]
    return ARRIVED


@inlined
def _happens(w: Any, number: int) -> int:
    """Write down a transition, and apply it, unless it leads where the walk knows nothing."""
    happened = integers(w[HAPPENED], WORD + w[EVENTS])
    happened[WORD + happened[COUNT]] = number
    happened[COUNT] += 1
    if integers(w[TRANSITIONS] + 8 * number * TRANSITION_LENGTH, TRANSITION_LENGTH)[TARGET] < 0:
        return AWAY
    return _through(w, number)


def walk(address: int, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Arcs from the state in `Y` of its mode until there were `EVENTS` events, or time is up."""
    w = integers(address, WALK_LENGTH)
    happened = integers(w[HAPPENED], WORD)
    first, happened[FIRST_OF_ALL] = happened[FIRST_OF_ALL], -1
    if first >= 0:
        status = _happens(w, first)
        if status != ARRIVED:
            return status
    while happened[COUNT] < w[EVENTS]:
        m = integers(w[MODES] + 8 * happened[MODE] * MODE_LENGTH, MODE_LENGTH)
        status = _arc(w, m, t1, tolerance, order, stable)
        if status < _EVENT:
            return status
        status = _happens(w, integers(m[LEADS], m[GUARDS])[status - _EVENT])
        if status != ARRIVED:
            return status
    return ARRIVED
