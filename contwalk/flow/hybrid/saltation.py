"""Derivatives through a transition."""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.at_jumps import jumps_there
from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.system import Transition


def saltation(
    machine: HybridMachine, transition: Transition, t: float, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """How deviations go through a transition, in the states that exist on its sides.

    A deviation v before it, at a fixed time, is Psi v after it; the transition happens at t + s v with

        Psi = G_x + (F_after - G_x F_before - G_t) s', s = -h_x / (h_x F_before + h_t), s' = -s

    for the guard h and the map G. Where h has no rate, both are infinite. An event at which h jumps at an
    instant of time stays at that: s is zero.

    Parameters
    ----------
    t, x
        Time and full-length state right before it.

    Returns
    -------
    matrix : ndarray, shape (m, n)
    shift : ndarray, shape (n,)
        s, the derivative of the instant.
    """
    jump, c = machine.jump(transition)
    source, target = machine.mode(transition.source), machine.mode(transition.target)
    before = np.asarray(x, dtype=float)[source.states]
    at = np.concatenate([[t], before])
    after, slopes = jump(0.0, at, c)[:-1], jump.jacobian(0.0, at, c)
    speed, speed_after = source.field(t, before, source.c), target.field(t, after, target.c)
    by_state, by_time, guard = slopes[:-1, 1:], slopes[:-1, 0], slopes[-1]
    if jumps_there(source, transition, t, x):
        return by_state, np.zeros(len(before))
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = -guard[1:] / (guard[1:] @ speed + guard[0])
        return by_state - np.outer(speed_after - by_state @ speed - by_time, shift), shift
