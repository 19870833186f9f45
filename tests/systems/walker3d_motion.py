"""Motions of the 3D walker by SciPy, with the compiled field and the guards as the plugin writes them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from contwalk_systems.walker3d import SYSTEM
from scipy.integrate import solve_ivp

from contwalk.flow.compiled.traced import field_of
from contwalk.system import System

REFERENCE = json.loads((Path(__file__).parent / "walker3d_reference.json").read_text(encoding="utf-8"))
GAITS = REFERENCE["gaits"]
RTOL, ATOL = 1e-12, 1e-13
ENDS = ("11", "12", "21", "22")


@cache
def walker(**choices: str) -> System:
    return SYSTEM.with_model(choices)


def values(system: System, preset: str = "overlap", **changed: float) -> dict[str, float]:
    """Values of all parameters: a preset, and what is changed of it."""
    return system.defaults() | dict(system.presets[preset]) | changed


def mode_named(system: System, toes: str, knees: str, swings: str = "", rising: str = "") -> str:
    """The mode in which these toes (`21 22`) are on the ground, these knees locked, these legs swinging."""
    on, locked, up = toes.split(), knees.split(), rising.split()
    wanted = {f"on{end}": float(end in on) for end in ENDS}
    wanted |= {f"damped{end}": float(end in on and end not in up) for end in ENDS}
    wanted |= {f"stop{leg}": float(leg in locked) for leg in "12"}
    for mode in system.modes:
        swinging = "".join(leg for leg in "12" if f"swing{leg}" in mode.name)
        if dict(mode.constants) == wanted and swinging == swings:
            return mode.name
    raise LookupError(wanted)


def rates(system: System, mode: str, x: np.ndarray, p: dict[str, float]) -> np.ndarray:
    """dx/dt as the plugin writes it; 0 for states that do not exist in the mode."""
    exists, found = list(system.states_of(mode)), np.zeros(28)
    there = np.zeros(28)
    there[exists] = np.asarray(x)[exists]
    constants = system.mode(mode).constants
    system.mode(mode).field(0.0, there, SimpleNamespace(**p, **constants), found)
    kept = np.zeros(28)
    kept[exists] = found[exists]
    return kept


@dataclass(frozen=True)
class Walk:
    """A motion: what happened when, the instants of all steps (both sides of events), modes in order."""

    events: list[tuple[float, str]]
    times: np.ndarray
    states: np.ndarray
    modes: list[str]


def walk(
    system: System, p: dict[str, float], mode: str, x: np.ndarray, until: float, finest: int = 4
) -> Walk:
    """Motion from a state; each step of the integrator gives `finest` instants."""
    given, vector = SimpleNamespace(**p), np.array([p[name] for name in system.parameter_names])
    t, events, modes, times, states = 0.0, [], [mode], [], []
    while t < until:
        exists = list(system.states_of(mode))
        field = field_of(system, mode)
        constants = field.constants(vector)
        armed = [each for each in system.leaving(mode) if each.role != "watched"]

        def full(y: np.ndarray, exists: list[int] = exists) -> np.ndarray:
            whole = np.zeros(28)
            whole[exists] = y
            return whole

        def event(transition, begin: float = t, full=full):
            def value(time: float, y: np.ndarray) -> float:
                # A guard may be zero after its own reset; it counts again when it has been left.
                return 1.0 if time == begin else transition.guard(time, full(y), given)

            value.terminal = True
            value.direction = -1.0 if transition.direction == "falling" else 1.0
            return value

        solved = solve_ivp(
            lambda time, y, field=field, constants=constants: field(time, y, constants),
            (t, until),
            np.asarray(x)[exists],
            method="DOP853",
            rtol=RTOL,
            atol=ATOL,
            events=[event(each) for each in armed],
            dense_output=True,
        )
        ends = np.concatenate([np.linspace(a, b, finest, endpoint=False) for a, b in pairwise(solved.t)])
        times.append(np.append(ends, solved.t[-1]))
        part = np.zeros((len(times[-1]), 28))
        part[:, exists] = solved.sol(times[-1]).T
        states.append(part)
        t, x = float(solved.t[-1]), full(solved.y[:, -1])
        if solved.status == 1:
            number = next(i for i, found in enumerate(solved.t_events) if len(found))
            t, x = float(solved.t_events[number][0]), full(solved.y_events[number][0])
            transition = armed[number]
            if transition.reset is not None:
                after = np.zeros(28)
                transition.reset(t, x, given, after)
                x = after
            mode = transition.target
            events.append((t, transition.name))
            modes.append(mode)
            kept = np.zeros(28)
            kept[list(system.states_of(mode))] = x[list(system.states_of(mode))]
            x = kept
    return Walk(events, np.concatenate(times), np.concatenate(states), modes)


def mode_of(case: dict) -> str:
    """The mode of a numbered state of contact."""
    toes = [end for end, on in zip(ENDS, case["contact"], strict=False) if on]
    rising = [end for end, down in zip(ENDS, case["damped"], strict=True) if not down]
    knees = [str(leg) for leg, on in zip((1, 2), case["contact"][4:], strict=True) if on]
    swings = "1" if toes and not {"11", "12"} & set(toes) and "1" not in knees else ""
    return mode_named(walker(), " ".join(toes), " ".join(knees), swings, " ".join(rising))


@cache
def gait(name: str, share: float = 1.0) -> tuple[SimpleNamespace, Walk]:
    """A gait for a share of its stride."""
    p, known = values(walker(), name), GAITS[name]
    return SimpleNamespace(**p), walk(walker(), p, mode_of(known), np.array(known["x"]), share * known["T"])


def random_state(random: np.random.Generator) -> np.ndarray:
    return np.concatenate([random.uniform(-0.6, 0.6, 18), random.normal(size=10)])
