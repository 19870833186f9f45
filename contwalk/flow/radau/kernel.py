"""Paths of Radau IIA collocation, compiled by numba: with step control, on a frozen grid, and with tangents.

Everything comes in by the address of a `RadauCall`, so that one object code serves every field. Imported
only where it is compiled.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import doubles, inlined, record
from contwalk.flow.radau.estimate import estimated, estimated_again, norm
from contwalk.flow.radau.newton import CONVERGED, NOT_FINITE, iterate, linearize, predict, solved
from contwalk.flow.radau.parts import EPSILON, Equations, Method, Work, equations, method, radau_call, work
from contwalk.flow.radau.radau_call import RadauCall, RadauControl, RadauCounts

# What `adaptive` returns.
DONE, NOT_FINITE_PATH, TOO_MANY_STEPS, STEP_TOO_SMALL, FULL = 0, 1, 2, 3, 4

# Passes of Newton's method: a step that needs more is shortened, or, on a frozen grid, given up.
MOST_PASSES = 40
MOST_PASSES_FROZEN = 200

# Work for a stretch of time goes like 1 / (rate log 1/rate), which is flat between 0.2 and 0.4.
BEST_RATE = 0.25

SAFETY = 0.9
MOST_GROWTH, MOST_SHRINKAGE = 8.0, 5.0

radau_control, radau_counts = record(RadauControl), record(RadauCounts)


@inlined
def accept(m: Method, w: Work, n: int, x: np.ndarray) -> None:
    """Go to the end of the step."""
    for i in range(m.s * n):
        w.old[i] = w.z[i]
    for k in range(n):
        x[k] += w.z[(m.s - 1) * n + k]


def radau_march(address: int) -> int:
    """The steps of the grid of a `RadauCall` from x, which is overwritten; how many of them could be done."""
    call = radau_call(address)
    eq, m, w = equations(call), method(call), work(call)
    n, s, steps = call.n, call.s, call.steps
    grid, now, sn = doubles(call.times, steps + 1), doubles(call.x, n), s * n
    before = 0.0
    if call.states != 0:
        for k in range(n):
            doubles(call.states, n)[k] = now[k]
    for step in range(steps):
        h = grid[step + 1] - grid[step]
        if not linearize(eq, w, grid[step], now):
            return step
        if not solved(eq, m, w, grid[step], h, before, now, MOST_PASSES_FROZEN):
            return step
        if call.errors != 0:
            pair = doubles(call.errors + 16 * step, 2)
            pair[0], pair[1] = estimated(eq, m, w, h, doubles(call.weights, n))
        if call.increments != 0:
            kept = doubles(call.increments + 8 * step * sn, sn)
            for i in range(sn):
                kept[i] = w.z[i]
        accept(m, w, n, now)
        if call.states != 0:
            node = doubles(call.states + 8 * (step + 1) * n, n)
            for k in range(n):
                node[k] = now[k]
        before = h
    return steps


@inlined
def next_step(s: int, h: float, error: float, rate: float, last_h: float, last_error: float) -> float:
    """The next step by Gustafsson's predictive controller, held where Newton's method is at its best."""
    power = 1.0 / (s + 1)
    quotient = max(1.0 / MOST_GROWTH, min(MOST_SHRINKAGE, error**power / SAFETY))
    if last_h != 0.0 and error < 1.0:
        predicted = (last_h / h) * (error * error / last_error) ** power / SAFETY
        quotient = max(quotient, max(1.0 / MOST_GROWTH, min(MOST_SHRINKAGE, predicted)))
    if rate > 0.0 and error < 1.0:
        quotient = max(quotient, min(2.0, rate / BEST_RATE))
    return h / quotient


@inlined
def first_step(s: int, span: float, speed: float, tolerance: float) -> float:
    """A first step in which the state moves by what an error of order s + 1 allows."""
    h = 0.5 * tolerance ** (1.0 / (s + 1)) / speed
    return np.copysign(min(h, 0.1 * abs(span)), span)


@inlined
def end_of_step(t: float, h: float, t1: float) -> float:
    """Where a step of about h ends: on t1, or so that what remains is not much shorter than the step."""
    rest = t1 - t
    if abs(rest) <= 1.000001 * abs(h):
        return t1
    return t + (0.5 * rest if abs(rest) < 2.0 * abs(h) else h)


@inlined
def one_step(call: RadauCall, eq: Equations, m: Method, w: Work, t: float, x: np.ndarray) -> int:
    """Try steps until one is accepted; its increments are in w.z, its end and length in the control."""
    t1, tolerance, allowed, weights = call.t1, call.tolerance, call.allowed, doubles(call.weights, call.n)
    control, count = radau_control(call.control), radau_counts(call.counts)
    passable = True
    again = count.steps == 0
    rejected = False
    while True:
        end = end_of_step(t, control.proposed, t1)
        h = end - t
        if (end != t1 and not abs(h) > 16.0 * EPSILON * abs(t)) or h == 0.0:
            return STEP_TOO_SMALL if passable else NOT_FINITE_PATH
        predict(eq, m, w, h, control.length)
        code, passes, rate = iterate(eq, m, w, t, h, x, MOST_PASSES)
        count.evaluations += passes * m.s
        if code != CONVERGED:
            passable = code != NOT_FINITE
            count.rejected += 1
            control.proposed = 0.3 * h
            rejected = again = True
            continue
        error, linear = estimated(eq, m, w, h, weights)
        if max(error / allowed, linear / tolerance) >= 1.0 and again:
            count.evaluations += 1
            error, linear = estimated_again(eq, m, w, t, h, x, weights)
        error = max(error / allowed, linear / tolerance)
        if error < 1.0:
            proposed = next_step(m.s, h, max(error, 1e-10), rate, control.last_length, control.last_error)
            control.proposed = proposed if not rejected or abs(proposed) < abs(h) else h
            control.length, control.last_length, control.last_error, control.end = h, h, max(error, 1e-2), end
            return DONE
        passable = error < np.inf
        count.rejected += 1
        control.proposed = next_step(m.s, h, error, 0.0, 0.0, 0.0) if passable else 0.3 * h
        rejected = again = True


def radau_adaptive(address: int) -> int:
    """Steps with error control from the last node written to t1, until there is no more room."""
    call = radau_call(address)
    eq, m, w = equations(call), method(call), work(call)
    n, scales, grid = call.n, doubles(call.weights, call.n), doubles(call.times, call.steps + 1)
    control, count = radau_control(call.control), radau_counts(call.counts)
    while grid[count.steps] != call.t1:
        done = count.steps
        if done >= call.most:
            return TOO_MANY_STEPS
        if done >= call.steps:
            return FULL
        t, x = grid[done], doubles(call.states + 8 * done * n, n)
        count.jacobians += 1
        if not linearize(eq, w, t, x):
            return NOT_FINITE_PATH
        if done == 0:
            control.proposed = first_step(call.s, call.t1 - t, norm(w.out, scales, n), call.allowed)
        code = one_step(call, eq, m, w, t, x)
        if code != DONE:
            return code
        node = doubles(call.states + 8 * (done + 1) * n, n)
        for k in range(n):
            node[k] = x[k]
        accept(m, w, n, node)
        grid[done + 1] = control.end
        count.steps += 1
    return DONE
