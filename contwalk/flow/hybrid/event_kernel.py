"""Segments of a hybrid machine and their derivatives in one compiled walk, for numba.

The steps are those of `explicit.drivers`. With columns of derivatives each step moves them too; at a
transition they are multiplied by its saltation matrix (P. C. Mueller, Calculation of Lyapunov exponents for
dynamic systems with discontinuities, Chaos, Solitons and Fractals 5 (1995) 1671-1681). What needs more
thought than a glance at values and rates is left to the reference integrator of `motions`.
"""

from __future__ import annotations

import math
from ctypes import sizeof
from typing import Any

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined, integers, record
from contwalk.flow.explicit import explicit_call as explicit
from contwalk.flow.explicit.drivers import (
    EPSILON,
    accepted_step,
    copy,
    explicit_call,
    finite,
    first_stage,
    place,
    step,
    step_control,
)
from contwalk.flow.explicit.stages import FIRST, NEXT, Y
from contwalk.flow.hybrid import guard_taylor_records as status_of
from contwalk.flow.hybrid.event_records import (
    ARRIVED,
    AWAY,
    FULL,
    MOST_BITS,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TIME_UP,
    UNSURE,
    EventCall,
    Happened,
    ModeRecord,
    TransitionRecord,
)
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
from contwalk.flow.hybrid.guard_taylor_kernel import coefficients_at, instant_at, stands

COINCIDE = 8.0
ROUNDINGS, AFTER_RESET = 8.0, 1e3  # as in `guard_status`
INSTANT, INVISIBLE = 64.0, 100.0  # as in `chatter`
LEFT = 2.0  # a guard has left zero where it is so many times what it began with of rounding
MOST_SHORTENED = 30  # times in a row, where a guard is not resolved
SHORTEST = 1e3  # roundings of the time in a step that does not resolve one
_EVENT = 100  # and more: the guard's number is added


_event_call, happened_at = record(EventCall), record(Happened)
_mode_at, _transition_at = record(ModeRecord), record(TransitionRecord)
_MODE_LENGTH, _TRANSITION_LENGTH = sizeof(ModeRecord), sizeof(TransitionRecord)


@inlined
def _mode(w: EventCall, number: int) -> Any:
    """A `ModeRecord`."""
    return _mode_at(w.modes + number * _MODE_LENGTH)


@inlined
def _transition(w: EventCall, number: int) -> Any:
    """A `TransitionRecord`."""
    return _transition_at(w.transitions + number * _TRANSITION_LENGTH)


# -- where a segment begins ---------------------------------------------------------------------------------


@inlined
def _returns_unseen(rate: float, bend: float, noise: float, t: float) -> bool:
    """Whether a guard that leaves zero is back too soon, or too near, to be seen; as in `chatter`."""
    if not rate * bend < 0.0:
        return False
    back, excursion = 2.0 * abs(rate / bend), 0.5 * rate * (rate / abs(bend))
    return back <= INSTANT * EPSILON * abs(t) or abs(excursion) <= INVISIBLE * noise


@inlined
def _stands(m: ModeRecord, guard: int, own: bool, passed: bool, t: float) -> bool:
    """Write down how a guard stands; whether nothing happens there."""
    k, at = instant_at(m.instant), standing(m, guard)
    sloping = integers(m.sloping, guard + 1)[guard]
    direction = integers(m.directions, guard + 1)[guard]
    kind = stands(k, sloping, direction, t, AFTER_RESET if own else ROUNDINGS, ROUNDINGS)
    answer = coefficients_at(k.answer)
    at.value, at.rate = answer.value, answer.rate
    at.begins, at.fastest, at.band = 0.0, 0.0, 0.0
    if kind == status_of.ENTERING and passed and at.rate != 0.0:  # as in `guard_status`
        kind = status_of.LEAVING
    if kind == status_of.LEAVING:
        at.band = LEFT * abs(at.value)
        at.value, at.begins = 0.0, answer.side
        if m.paced != 0 and _returns_unseen(answer.rate, answer.bend, answer.value_noise, t):
            return False
    if kind == status_of.BEYOND:
        return integers(m.levels, guard + 1)[guard] == 0
    return kind == status_of.CLEAR or kind == status_of.LEAVING


@inlined
def _has(bits: int, guard: int) -> bool:
    return guard < MOST_BITS and (bits >> guard) & 1 == 1


@inlined
def _begin(m: ModeRecord, own: int, passed: int, t: float) -> int:
    """The first stage of a segment, and its guards; `ARRIVED`, or why it cannot begin.

    `own` has a bit for each guard that what has just happened leaves at zero, `passed` for each of these
    that it has passed in its own direction.
    """
    p = explicit_call(m.moving)
    first_stage(p, t, Y)
    if not (finite(doubles(place(p, Y), m.size)) and finite(doubles(place(p, FIRST), m.size))):
        return UNSURE
    control = step_control(p.control)
    control.time, control.length, control.error, control.undefined = t, 0.0, 0.0, 0.0
    leads = integers(m.leads, m.guards)
    instant_at(m.instant).known = 0
    for guard in range(m.guards):
        if leads[guard] < 0:
            at = standing(m, guard)
            at.value, at.rate, _ = measured(m, guard, t, place(p, Y), place(p, FIRST))
            at.begins, at.fastest, at.band = 0.0, 0.0, 0.0
        elif not _stands(m, guard, _has(own, guard), _has(passed, guard), t):
            return UNSURE
    return ARRIVED


# -- up to the next event -----------------------------------------------------------------------------------


@inlined
def _first_event(m: ModeRecord, t: float, end: float) -> tuple[float, int, int]:
    """The first event in the step that ends in `NEXT`: instant, or `NONE`, and guard.

    And the watched guards that may pass zero in the step, a bit for each. `FIRST` is the velocity at its end.
    """
    p, leads = explicit_call(m.moving), integers(m.leads, m.guards)
    first, which, begun, marked = NONE, -1, False, 0
    for guard in range(m.guards):
        value, rate, _ = measured(m, guard, end, place(p, NEXT), place(p, FIRST))
        at_end = standing(m, guard)
        at_end.value_at_end, at_end.rate_at_end = value, rate
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
def _go_on(m: ModeRecord) -> bool:
    """The step's end, where the guards are measured, becomes the state; whether all have values there."""
    p = explicit_call(m.moving)
    sound = True
    for guard in range(m.guards):
        at = standing(m, guard)
        at.value, at.rate = at.value_at_end, at.rate_at_end
        if not abs(at.value) <= at.band:
            at.begins, at.band = 0.0, 0.0
        sound = sound and abs(at.value) < math.inf
    copy(place(p, NEXT), place(p, Y), p.length)
    return sound


@inlined
def _segment(w: EventCall, m: ModeRecord, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Steps until an event, whose guard's number is added to `_EVENT`, or until they end otherwise."""
    p, clock = explicit_call(m.moving), doubles(w.clock, 1)
    control, times = step_control(p.control), doubles(w.times, w.room + 1)
    happened, marks = happened_at(w.happened), integers(w.marks, w.room)
    t, steps, shortened = clock[0], 0, 0
    if happened.goes_on == 0:
        status = _begin(m, happened.own, happened.passed, t)
        if status != ARRIVED:
            return status
    happened.goes_on, happened.own_steps, times[0] = 0, 0, t
    while t != t1:
        if steps >= w.room:
            happened.goes_on = 1
            return FULL
        status = accepted_step(p, t1, tolerance, order, stable)
        if status != explicit.DONE:
            return NOT_FINITE if status == explicit.NOT_FINITE else STEP_TOO_SMALL
        end = control.time
        at, guard, marked = _first_event(m, t, end)
        if at == UNRESOLVED:
            shortened += 1
            # A kink where the guard is zero, or a jump through zero.
            if shortened > MOST_SHORTENED or end - t < SHORTEST * EPSILON * abs(t):
                return UNSURE
            control.time, control.length = t, 0.5 * (end - t)
            first_stage(p, t, Y)
            continue
        shortened = 0
        if at != NONE:
            if not at > t:
                return UNSURE
            first_stage(p, t, Y)
            step(p, t, at - t)
            copy(place(p, NEXT), place(p, Y), p.length)
            end = at
        elif not _go_on(m):
            return UNSURE
        marks[steps] = marked
        steps += 1
        happened.steps += 1
        happened.own_steps = steps
        t, times[steps], clock[0] = end, end, end
        if p.nodes != 0:
            copy(place(p, Y), p.nodes + 8 * steps * p.length, p.length)
        if at != NONE:
            return _EVENT + guard
    return TIME_UP


# -- through a transition -----------------------------------------------------------------------------------


@inlined
def _derivatives(w: EventCall, m: ModeRecord, to: ModeRecord, j: TransitionRecord, n: int) -> None:
    """Columns of derivatives through a transition: G_x X + (F+ - G_x F - G_t) (h_x X) / (h_x F + h_t)."""
    q, width, rows = w.columns, w.width, j.outputs
    p, after = explicit_call(m.moving), explicit_call(to.moving)
    given = doubles(place(p, Y) + 8 * (p.length - n * width), n * width)
    found = doubles(place(after, Y) + 8 * (after.length - rows * width), rows * width)
    slopes, speeds = doubles(j.slopes, (rows + 1) * (n + 1)), doubles(j.speeds, n + rows)
    column, shift, rate = doubles(w.column, rows), doubles(w.shift, q), slopes[rows * (n + 1)]
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
def _through(w: EventCall, number: int) -> int:
    """Apply a transition: state, uncertainties, derivatives; `ARRIVED`, or why not."""
    happened, clock = happened_at(w.happened), doubles(w.clock, 1)
    j = _transition(w, number)
    m = _mode(w, happened.mode)
    to = _mode(w, j.target)
    n, rows, t = m.size, j.outputs, clock[0]
    p, trial = explicit_call(m.moving), explicit_call(m.trial)
    y, taken = doubles(place(p, Y), n), doubles(j.taken, n + 1)
    speeds = doubles(j.speeds, n + rows)
    copy(place(p, Y), place(trial, Y), n)
    first_stage(trial, t, Y)
    copy(place(trial, FIRST), j.speeds, n)
    taken[0] = t
    for i in range(n):
        taken[1 + i] = y[i]
    call_rhs(j.jump, 0.0, j.taken, j.constants, j.given)
    given, starts = doubles(j.given, rows + 1), integers(j.rows, rows + 2)
    entries, columns = (
        doubles(j.given + 8 * (rows + 1), starts[rows + 1]),
        integers(j.entries, starts[rows + 1]),
    )
    slopes, noise = doubles(j.slopes, (rows + 1) * (n + 1)), doubles(to.noise, 1 + rows)
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
    moving, tried = explicit_call(to.moving), explicit_call(to.trial)
    copy(j.given, place(tried, Y), rows)
    if not finite(given):
        return UNSURE
    first_stage(tried, t, Y)
    copy(place(tried, FIRST), j.speeds + 8 * n, rows)
    if w.columns > 0:
        _derivatives(w, m, to, j, n)
    copy(j.given, place(moving, Y), rows)
    happened.mode, happened.own, happened.passed = j.target, j.leaves, j.passes
    return ARRIVED


@inlined
def _happens(w: EventCall, number: int) -> int:
    """Write down a transition, and apply it, unless it leads where the integrator knows nothing."""
    happened = happened_at(w.happened)
    integers(w.itinerary, w.events)[happened.count] = number
    happened.count += 1
    if _transition(w, number).target < 0:
        return AWAY
    return _through(w, number)


def integrate(address: int, t1: float, tolerance: float, order: float, stable: float) -> int:
    """Segments from the state in `Y` of its mode until there were `EVENTS` events, or time is up."""
    w = _event_call(address)
    happened = happened_at(w.happened)
    first, happened.first_of_all = happened.first_of_all, -1
    if first >= 0:
        status = _happens(w, first)
        if status != ARRIVED:
            return status
    while happened.count < w.events:
        m = _mode(w, happened.mode)
        status = _segment(w, m, t1, tolerance, order, stable)
        if status < _EVENT:
            return status
        status = _happens(w, integers(m.leads, m.guards)[status - _EVENT])
        if status != ARRIVED:
            return status
    return ARRIVED
