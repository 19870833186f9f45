"""Machines with every kind of transition, a state near an orbit of each, and an independent simulation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from contwalk_systems.bouncing_ball import SYSTEM as BALL
from contwalk_systems.planar_walker import SYSTEM as WALKER
from contwalk_systems.rimless_wheel import SYSTEM as WHEEL
from hybrid_invariants import after, written
from hybrid_runs import ACCURACY, machine, solution
from scipy.integrate import solve_ivp

from contwalk.problems.hybrid.hybrid_orbit import HybridOrbit
from contwalk.problems.hybrid.soft_orbit import SoftOrbit
from contwalk.problems.orbit.itinerary import Leg
from contwalk.system import Mode, State, Symmetry, System, Transition


@dataclass(frozen=True)
class Case:
    """A system, its free parameter, and a state that leads to an orbit."""

    system: System
    free: str
    state: tuple[float, ...]
    parameters: Mapping[str, float] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    itinerary: tuple[str, ...] = ()


# -- a field that switches continuously ----------------------------------------------------------------------


def _spring(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - 2.0 * p.zeta * x[1] - x[0] - 0.3 * x[0] ** 3


def _stop(t: Any, x: Any, p: Any, dx: Any) -> None:
    """A second spring, without preload, is met at the gap."""
    dx[0] = x[1]
    dx[1] = p.force * math.cos(p.omega * t) - 2.0 * p.zeta * x[1] - x[0] - 0.3 * x[0] ** 3
    dx[1] = dx[1] - p.stiffness * (x[0] - p.gap)


SOFT = machine(
    ["q", "v"],
    {"zeta": 0.1, "omega": 0.9, "force": 0.8, "stiffness": 20.0, "gap": 0.5},
    {"free": _spring, "contact": _stop},
    [
        Transition("touch", "free", "contact", lambda t, x, p: p.gap - x[0], role="soft"),
        Transition("leave", "contact", "free", lambda t, x, p: x[0] - p.gap, role="soft"),
    ],
    period=lambda p: 2.0 * math.pi / p.omega,
)


# -- modes with 2, 2 and 3 states, rising and falling guards, resets that depend on parameters ---------------


def _leaking(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[0] = -0.3 * x[0] + 0.2 * x[1]
    dx[1] = -x[1] * (1.0 + 0.2 * x[1]) + 0.1 * x[0]


def _flying(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[0] = x[2]
    dx[2] = -2.0 - p.drag * x[2] * x[2] * x[2]


def _filling(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[0] = -x[0]
    dx[1] = p.inflow + x[2] * x[0] - 0.1 * x[1]
    dx[2] = -0.5 * x[2] + 0.1 * math.sin(x[1])


def _launch(t: Any, x: Any, p: Any, after: Any) -> None:
    after[0] = 0.0
    after[2] = p.kick * (1.0 + x[1] + 0.5 * x[0])


def _land(t: Any, x: Any, p: Any, after: Any) -> None:
    after[0] = -0.4 * x[2]
    after[1] = 0.1 + p.kick * 0.02 * x[2] ** 2
    after[2] = 0.3 * x[2]


def _full(t: Any, x: Any, p: Any, after: Any) -> None:
    after[0] = x[0] + 0.2 * x[2]
    after[1] = x[1] + 0.1 * x[0] - 0.05 * x[2]


TANK = machine(
    ["y", "z", "v"],
    {"drag": 0.05, "kick": 1.5, "inflow": 0.7},
    [
        Mode("leaking", _leaking, states=("y", "z")),
        Mode("flying", _flying, states=("y", "v")),
        Mode("filling", _filling),
    ],
    [
        Transition("empty", "leaking", "flying", lambda t, x, p: x[1] - 0.5 * p.inflow, reset=_launch),
        Transition("landed", "flying", "filling", lambda t, x, p: x[0], reset=_land),
        Transition(
            "full",
            "filling",
            "leaking",
            lambda t, x, p: x[1] - p.inflow - 0.1 * x[0],
            direction="rising",
            reset=_full,
        ),
    ],
)


# -- names that are swapped at every event -------------------------------------------------------------------


def _swinging(t: Any, x: Any, p: Any, dx: Any) -> None:
    """Two unlike pendulums, coupled; the one that is called first is pushed."""
    dx[0] = x[2]
    dx[1] = x[3]
    dx[2] = -math.sin(x[0]) - 0.3 * x[2] + 0.2 * (x[1] - x[0]) + p.push
    dx[3] = -1.5 * math.sin(x[1]) - 0.2 * x[3] + 0.1 * (x[0] - x[1])


def _swap(t: Any, x: Any, p: Any, image: Any) -> None:
    image[0] = x[1]
    image[1] = x[0]
    image[2] = x[3]
    image[3] = x[2]


def _strike(t: Any, x: Any, p: Any, after: Any) -> None:
    after[0] = x[0]
    after[1] = x[1]
    after[2] = 0.5 * x[2] - 0.1 * x[3]
    after[3] = 0.4 * x[3] - 0.8


PAIR = machine(
    ["a", "b", "u", "w"],
    {"push": 1.2},
    {"swing": _swinging},
    [
        Transition(
            "strike",
            "swing",
            "swing",
            lambda t, x, p: 0.6 - x[0] + 0.1 * x[1],
            reset=_strike,
            relabel="names",
        )
    ],
    symmetries=(Symmetry("names", "relabel", _swap),),
)


# -- an angle that grows by a turn, and a guard of either direction ------------------------------------------


def _turning(t: Any, x: Any, p: Any, dx: Any) -> None:
    dx[0] = 1.0 + x[1] + 0.2 * math.cos(x[0])
    dx[1] = -p.damping * x[1] + 0.1 * math.sin(2.0 * x[0])


def _kick(t: Any, x: Any, p: Any, after: Any) -> None:
    after[0] = x[0]
    after[1] = 0.5 * x[1] + 0.4 * math.cos(x[0] - p.damping)


ROTOR = machine(
    [State("phi", period=2.0 * math.pi), State("v")],
    {"damping": 0.4},
    {"turning": _turning},
    [
        Transition(
            "through", "turning", "turning", lambda t, x, p: math.sin(x[0]), direction="both", reset=_kick
        )
    ],
)


def _ball_at_zero(amplitude: float = 0.0095, e: float = 0.5, g: float = 9.81, omega: float = 35.0) -> tuple:
    """Height and velocity, when the table begins its period, of the ball that bounces once in each."""
    speed = math.pi * g / omega
    bounce = math.acos(speed * (1.0 - e) / ((1.0 + e) * amplitude * omega)) / omega
    passed = 2.0 * math.pi / omega - bounce
    return amplitude * math.sin(omega * bounce) + speed * passed - 0.5 * g * passed**2, speed - g * passed


CASES = {
    "time-dependent guard and reset": Case(
        BALL, "A", _ball_at_zero(), {"A": 0.0095, "e": 0.5}, {}, ("bounce",)
    ),
    "period that is free": Case(BALL, "omega", _ball_at_zero(), {"A": 0.0095, "e": 0.5}, {}, ("bounce",)),
    "parameter-dependent reset": Case(
        WHEEL,
        "a",
        (0.1 + math.pi / 8.0, 1.7),
        {"gamma": 0.1},
        {"event": "heel_strike", "until": "settled"},
        ("heel_strike",),
    ),
    "soft": Case(SOFT, "omega", (0.0, 0.0), {}, {"until": "settled"}, ("touch", "leave")),
    "different numbers of states": Case(
        TANK, "kick", (0.0, 0.6, 0.0), {}, {"until": "settled"}, ("empty", "landed", "full")
    ),
    "names that are swapped": Case(PAIR, "push", (0.0, 0.0, 0.5, 0.0), {}, {"until": "settled"}, ("strike",)),
    "guard of both directions": Case(
        ROTOR, "damping", (0.5, 0.0), {}, {"until": "settled"}, ("through", "through")
    ),
    "walker": Case(
        WALKER,
        "alpha",
        (-0.5196, 0.1528388, 0.0, 0.0, -1.933, -2.037, 0.0),
        {},
        {"event": "heel_strike", "until": "settled"},
        ("heel_strike", "knee_strike"),
    ),
}


@cache
def orbit(name: str, accuracy: float = ACCURACY) -> tuple[HybridOrbit, np.ndarray]:
    """The problem of a case and a solution of it; of soft transitions, the one with a leg for each."""
    case = CASES[name]
    found = solution(case.system, case.free, case.state, case.parameters, accuracy=accuracy, **case.options)
    return found[0].explicit(found[1]) if isinstance(found[0], SoftOrbit) else found


def simulated(
    problem: HybridOrbit, p: SimpleNamespace, first: int, x: np.ndarray, t: float, durations: np.ndarray
) -> tuple[np.ndarray, float]:
    """State and time after one round of the itinerary from leg `first` on, its events located by scipy.

    `x` holds the states of that leg. Guards count after a twentieth of the legs' durations: a displaced start
    may be on the other side of the guard that it comes from.
    """
    system, legs, end = problem.system, problem.itinerary.legs, t + float(durations.sum())
    for k in range(len(legs)):
        i = (first + k) % len(legs)
        x, t = through(system, legs[i], p, x, t, float(durations[i]), end)
    return x, t


def through(
    system: System, leg: Leg, p: SimpleNamespace, x: np.ndarray, t: float, lasting: float, closes: float
) -> tuple[np.ndarray, float]:
    """State and time after a leg that lasts about so long, and its event; without one, when all closes."""
    place, event, field = list(system.states_of(leg.mode)), leg.transition, system.mode(leg.mode).field
    sign = 1.0 if leg.falls else -1.0

    def full(y: np.ndarray) -> np.ndarray:
        result = np.zeros(len(system.states))
        result[place] = y
        return result

    def rate(time: float, y: np.ndarray) -> np.ndarray:
        return written(field, time, full(y), p)[place]

    if event is None:
        run = solve_ivp(rate, (t, closes), x, "DOP853", rtol=1e-13, atol=1e-15)
        return run.y[:, -1], closes

    def guard(time: float, y: np.ndarray) -> float:
        return 1.0 if time < t + 0.05 * lasting else sign * event.guard(time, full(y), p)

    guard.terminal = True
    guard.direction = -1.0
    solved = solve_ivp(
        rate,
        (t, t + 3.0 * lasting),
        x,
        "DOP853",
        rtol=1e-13,
        atol=1e-15,
        events=guard,
        max_step=0.04 * lasting,
    )
    end = float(solved.t_events[0][0])
    return after(system, event, end, full(solved.y_events[0][0]), p)[
        list(system.states_of(event.target))
    ], end
