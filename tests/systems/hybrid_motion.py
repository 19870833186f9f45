"""Motions through impacts by SciPy: what a plugin declares, and no integrator of the program."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from contwalk.system import System, Transition

RTOL, ATOL = 1e-12, 1e-13
SIGNS = {"falling": -1.0, "rising": 1.0, "both": 0.0}


@dataclass(frozen=True)
class Phase:
    """Motion in one mode up to the transition that ends it; `after` is named as the next mode names it."""

    mode: str
    begin: float
    end: float
    at: Callable[[float], np.ndarray]
    transition: Transition
    before: np.ndarray
    after: np.ndarray

    @property
    def duration(self) -> float:
        return self.end - self.begin

    def instants(self, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
        """Times and states, both ends included."""
        times = np.linspace(self.begin, self.end, count)
        states = np.array([self.at(t) for t in times])
        states[-1] = self.before
        return times, states


def parameters(system: System, **values: float) -> SimpleNamespace:
    return SimpleNamespace(**(system.defaults() | values))


def vector(function: Callable[..., None], t: float, x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
    """What a field, a reset or a map writes."""
    out = np.full(len(x), np.nan)
    function(t, x, p, out)
    return out


def after(system: System, transition: Transition, t: float, x: np.ndarray, p: SimpleNamespace) -> np.ndarray:
    """State after a transition: reset, then relabelled."""
    found = x if transition.reset is None else vector(transition.reset, t, x, p)
    if transition.relabel is not None:
        legs = next(s for s in system.symmetries if s.name == transition.relabel)
        found = vector(legs.map, t, found, p)
    return found


def phase(
    system: System,
    p: SimpleNamespace,
    mode: str,
    x: np.ndarray,
    t: float = 0.0,
    longest: float = 20.0,
    max_step: float = 0.25,
) -> Phase:
    """Motion from a state of a mode to the first transition that acts."""
    field = system.mode(mode).field
    armed = [transition for transition in system.leaving(mode) if transition.role != "watched"]

    def event(transition: Transition) -> Callable[[float, np.ndarray], float]:
        def value(time: float, y: np.ndarray) -> float:
            # A guard may be zero after its own reset; it counts again when it has been left.
            return 1.0 if time == t else transition.guard(time, y, p)

        value.terminal = True
        value.direction = SIGNS[transition.direction]
        return value

    solved = solve_ivp(
        lambda time, y: vector(field, time, y, p),
        (t, t + longest),
        np.asarray(x, dtype=float),
        method="DOP853",
        rtol=RTOL,
        atol=ATOL,
        events=[event(transition) for transition in armed],
        dense_output=True,
        max_step=max_step,
    )
    assert solved.status == 1, f"no transition out of '{mode}' in {longest} s"
    which = next(i for i, times in enumerate(solved.t_events) if len(times))
    end, before = float(solved.t_events[which][0]), solved.y_events[which][0]
    return Phase(mode, t, end, solved.sol, armed[which], before, after(system, armed[which], end, before, p))


def phases(
    system: System, p: SimpleNamespace, mode: str, x: np.ndarray, count: int, t: float = 0.0
) -> list[Phase]:
    """Motion through so many transitions."""
    found: list[Phase] = []
    for _ in range(count):
        found.append(phase(system, p, mode, x, t))
        mode, x, t = found[-1].transition.target, found[-1].after, found[-1].end
    return found


def joined(parts: list[Phase]) -> tuple[np.ndarray, np.ndarray]:
    """The motion as observables get it: two instants at each transition."""
    times, states = zip(*(part.instants() for part in parts), strict=True)
    return np.concatenate(times), np.concatenate(states)


def dips(guard: Callable[..., float], part: Phase, p: SimpleNamespace) -> list[tuple[float, float]]:
    """Times and values of the local minima of a guard inside a phase."""

    def value(t: float) -> float:
        return guard(t, part.at(t), p)

    times = np.linspace(part.begin, part.end, 400)
    values = [value(t) for t in times]
    found = []
    for k in range(1, len(times) - 1):
        if values[k] < values[k - 1] and values[k] <= values[k + 1]:
            ends = (times[k - 1], times[k + 1])
            least = minimize_scalar(value, bounds=ends, method="bounded", options={"xatol": 1e-9})
            found.append((float(least.x), float(least.fun)))
    return found
