"""Paths by collocation at Gauss points: given steps, with their tangents, and steps with error control.

Everything comes in by the address of a `GaussCall`, so that one object code serves every field and every
degree. Imported only where it is compiled.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.compiled.calling import call_rhs, doubles, inlined, integers
from contwalk.flow.gauss.gauss_call import GaussCall
from contwalk.flow.gauss.parts import (
    EPSILON,
    Points,
    Work,
    equations,
    gauss_call,
    gauss_control,
    points,
    work,
)
from contwalk.flow.gauss.step import CONVERGED, NOT_FINITE, carry, end_of, increments
from contwalk.flow.radau.kernel import end_of_step
from contwalk.flow.radau.parts import Equations

DONE, NOT_FINITE_PATH, TOO_MANY_STEPS, STEP_TOO_SMALL, FULL = 0, 1, 2, 3, 4

SAFETY, MOST_GROWTH, MOST_SHRINKAGE = 0.9, 5.0, 8.0
# Roundings by which two ends of a step may differ that are the same.
UNSEEN = 8.0
# A step whose equations are not solved is made shorter by this.
FAILED = 0.3


def gauss_paths(address: int) -> int:
    """The steps of all paths, with their tangents where there are any; how many paths were done to the end.

    What a path does not get to is left as it is.
    """
    call = gauss_call(address)
    eq, m, w = equations(call), points(call.numbers, call.s), work(call)
    n, q = call.n, call.q
    sources, lasts = integers(call.sources, q), integers(call.lasts, call.paths)
    done = first = 0
    for path in range(call.paths):
        x, start = doubles(call.states + 8 * first * n, n), doubles(call.starts + 8 * path * n, n)
        for k in range(n):
            x[k] = start[k]
        if q > 0:
            given = doubles(call.tangents, n * q)
            for i in range(n * q):
                w.tangents[i] = given[i]
        if _path(eq, m, w, call, first, lasts[path], q, sources):
            done += 1
            if q > 0:
                kept = doubles(call.ends + 8 * path * n * q, n * q)
                for i in range(n * q):
                    kept[i] = w.tangents[i]
        first = lasts[path] + 1
    return done


@inlined
def _path(
    eq: Equations, m: Points, w: Work, call: GaussCall, first: int, last: int, q: int, sources: np.ndarray
) -> bool:
    """The steps of one path, from the state at its first time."""
    n, times = eq.n, doubles(call.times, call.count)
    _keep(call, first, w, n * q)
    for step in range(first, last):
        t, h = times[step], times[step + 1] - times[step]
        x = doubles(call.states + 8 * step * n, n)
        if increments(eq, m, w, t, h, x)[0] != CONVERGED:
            return False
        if q > 0 and not carry(eq, m, w, t, h, x, q, sources):
            return False
        node = doubles(call.states + 8 * (step + 1) * n, n)
        for k in range(n):
            node[k] = x[k]
        end_of(m, w, n, node)
        _keep(call, step + 1, w, n * q)
    return True


@inlined
def _keep(call: GaussCall, at: int, w: Work, size: int) -> None:
    """Write tangents at one of the times, where they are wanted."""
    if call.nodes != 0:
        node = doubles(call.nodes + 8 * at * size, size)
        for i in range(size):
            node[i] = w.tangents[i]


@inlined
def _difference(
    eq: Equations, m: Points, finer: Points, w: Work, t: float, h: float, x: np.ndarray, weights: np.ndarray
) -> tuple[int, float, int]:
    """How both degrees' ends of a step differ, RMS in units of the weights; `w.first` is the lower one's.

    (How it ended, the difference, evaluations.)
    """
    n = eq.n
    code, spent = increments(eq, m, w, t, h, x)
    if code != CONVERGED:
        return code, 0.0, spent
    for k in range(n):
        w.first[k] = x[k]
    end_of(m, w, n, w.first)
    code, more = increments(eq, finer, w, t, h, x)
    spent += more
    if code != CONVERGED:
        return code, 0.0, spent
    for k in range(n):
        w.state[k] = x[k]
    end_of(finer, w, n, w.state)
    total = 0.0
    for k in range(n):
        # Both are known to their rounding only; where that is above the tolerance, it must not stop a path.
        apart = max(abs(w.first[k] - w.state[k]) - UNSEEN * w.base[k], 0.0)
        total += (apart / weights[k]) ** 2
    return CONVERGED, np.sqrt(total / n), spent


def gauss_errors(address: int) -> int:
    """Differences to the finer degree of the steps of one path, (count - 1,) at `nodes`; how many were
    done.
    """
    call = gauss_call(address)
    eq, w = equations(call), work(call)
    m, finer = points(call.numbers, call.s), points(call.finer_numbers, call.finer)
    n, times, errors = call.n, doubles(call.times, call.count), doubles(call.nodes, call.count)
    x = doubles(call.starts, n)
    for step in range(call.count - 1):
        h = times[step + 1] - times[step]
        code, error, _ = _difference(eq, m, finer, w, times[step], h, x, doubles(call.weights, n))
        if code != CONVERGED:
            return step
        errors[step] = error
        for k in range(n):
            x[k] = w.first[k]
    return call.count - 1


@inlined
def _first_step(call: GaussCall, eq: Equations, w: Work, t: float, x: np.ndarray, order: int) -> float:
    """A first step in which the state moves by what an error of the order allows; zero where f does not
    exist.
    """
    n, weights = eq.n, doubles(call.weights, eq.n)
    call_rhs(eq.rhs, t, x.ctypes.data, eq.c.ctypes.data, w.state.ctypes.data)
    total = 0.0
    for k in range(n):
        total += (w.state[k] / weights[k]) ** 2
    span, speed = call.t1 - t, np.sqrt(total / n)
    if not speed < np.inf:
        return 0.0
    return np.copysign(min(0.5 * call.tolerance ** (1.0 / (order + 1)) / speed, 0.1 * abs(span)), span)


def gauss_adaptive(address: int) -> int:
    """Steps with error control from the last node written to t1, until there is no more room."""
    call = gauss_call(address)
    eq, w, control = equations(call), work(call), gauss_control(call.control)
    m, finer = points(call.numbers, call.s), points(call.finer_numbers, call.finer)
    n, order, weights = call.n, 2 * call.s, doubles(call.weights, call.n)
    times, t1 = doubles(call.times, call.count), call.t1
    while times[control.steps] != t1:
        done = control.steps
        if done >= call.most:
            return TOO_MANY_STEPS
        if done + 1 >= call.count:
            return FULL
        t, x = times[done], doubles(call.states + 8 * done * n, n)
        if done == 0:
            control.proposed = _first_step(call, eq, w, t, x, order)
            if control.proposed == 0.0:
                return NOT_FINITE_PATH
        finite, rejected = True, False
        while True:
            end = end_of_step(t, control.proposed, t1)
            h = end - t
            if (end != t1 and not abs(h) > 16.0 * EPSILON * abs(t)) or h == 0.0:
                return STEP_TOO_SMALL if finite else NOT_FINITE_PATH
            code, error, spent = _difference(eq, m, finer, w, t, h, x, weights)
            control.evaluations += spent
            if code != CONVERGED:
                finite = code != NOT_FINITE
                control.proposed = FAILED * h
            else:
                error /= call.tolerance
                quotient = error ** (1.0 / (order + 1)) / SAFETY
                quotient = max(1.0 / MOST_GROWTH, min(MOST_SHRINKAGE, quotient))
                control.proposed = h / (max(quotient, 1.0) if rejected and error < 1.0 else quotient)
                if error < 1.0:
                    break
            control.rejected += 1
            rejected = True
        node = doubles(call.states + 8 * (done + 1) * n, n)
        for k in range(n):
            node[k] = w.first[k]
        times[done + 1] = end
        control.steps += 1
    return DONE
