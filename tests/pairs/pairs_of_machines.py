"""Machines that reach a limit and come back from it within a drawn distance."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pairs_form import FREE, Case, Draw

from contwalk.system import Mode, Parameter, State, System, Transition


def _beside_a_wall(free: Any, start: float, size: float, **more: Any) -> System:
    """A mass that moves as `free` says, and loses half its speed at a wall at x = size."""

    def bounce(t: Any, x: Any, p: Any, after: Any) -> None:
        after[0], after[1] = x[0], -0.5 * x[1]

    hit = Transition("hit", "free", "free", lambda t, x, p: size - x[0], "falling", reset=bounce)
    states, parameters = (State("x"), State("v")), (Parameter(FREE, start),)
    modes = (Mode("free", free),)
    return System("pairs", states, parameters, modes, transitions=(hit,), **more)


def two_grazings(draw: Draw) -> Case:
    """A forced oscillator whose amplitude reaches a stop about its resonance.

    x'' + 2 d x' + x = F(q) cos t has the amplitude F / (2 d), and F = 2 d (1 - dip): it is 1 where the dip
    is zero. A stop lies at 1, in units of its own.
    """
    dip = draw.dip()
    inside = -1.0 if draw.near_miss else 1.0
    sign = float(draw.sign)
    damping = float(draw.rng.uniform(0.05, 0.4))
    size = float(2.0 ** draw.rng.integers(-10, 11))
    # The walk begins where the stop is not reached: outside of the dip, or between both.
    start = draw.start

    def free(t: Any, x: Any, p: Any, dx: Any) -> None:
        force = 2.0 * damping * (1.0 + 0.3 * sign * dip(draw.part(p.lam)))
        dx[0] = x[1]
        dx[1] = size * force * np.cos(t) - 2.0 * damping * x[1] - x[0]

    system = _beside_a_wall(free, start, size, period=lambda p: 2.0 * math.pi)
    force = 1.0 + 0.3 * sign * dip(draw.part(start))
    state = np.array([0.0, size * force])
    # The amplitude is rounded, and stands still in the middle.
    return Case(
        draw.kind,
        draw.seed,
        system,
        state,
        start,
        draw.range,
        draw.distance,
        draw.beside("GR") if inside > 0.0 else (),
        machine={"mode": "free", "until": "settled", "events": {"GR": "ignore"}},
    )


def two_boundary_equilibria(draw: Draw) -> Case:
    """A mass on a spring, drawn towards a wall and back: at rest it touches the wall twice."""
    dip, sign = draw.dip(), float(draw.sign)
    damping, size = float(draw.rng.uniform(0.1, 1.0)), float(2.0 ** draw.rng.integers(-10, 11))
    start = draw.start

    def free(t: Any, x: Any, p: Any, dx: Any) -> None:
        dx[0] = x[1]
        dx[1] = size * (1.0 + 0.3 * sign * dip(draw.part(p.lam))) - x[0] - damping * x[1]

    system = _beside_a_wall(free, start, size)
    state = np.array([size * (1.0 + 0.3 * sign * dip(draw.part(start))), 0.0])
    return Case(
        draw.kind,
        draw.seed,
        system,
        state,
        start,
        draw.range,
        draw.distance,
        draw.beside("BE"),
        options={"events": {"BE": "ignore"}},
    )


MACHINES = {"machines GR GR": two_grazings, "machines BE BE": two_boundary_equilibria}
DIPS = tuple(MACHINES)
