"""Does a motion keep volumes of states, as a machine does that loses nothing? Then it settles nowhere.

Deviations span a volume, whose logarithm grows by the divergence of the field, and at an event by the
logarithm of the determinant of its saltation matrix. Where it does not tend to minus infinity a motion has
no attractor, and returns do not become better by waiting (Liouville's theorem; Arnold, Mathematical Methods
of Classical Mechanics, section 16). In coordinates that are not canonical it goes up and down with the
motion; so its trend decides. That of a quasi-periodic motion averages out. Of an irregular one it does not,
but what is kept is a density times the volume: the logarithm is a function of the state, and what the states
at one kind of event tell of it is taken off before the trend is asked for.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.hybrid.motion_segment import MotionSegment
from contwalk.flow.hybrid.saltation import saltation
from contwalk.system import System

# Events before volumes are looked at, so that what settles soon costs nothing, and events that are looked at.
FIRST, WATCHED = 200, 200
# Logarithm of a volume that is kept: what it would change by in the whole search.
KEPT = 1.0
# Functions of the state are at most this part of the events; the time is none of them if this part of it is
# left beside them.
FUNCTIONS, LEFT = 0.25, 0.5
# So many standard errors, and a function that the others give to this part of itself.
SURE, SAME = 3.0, 1e-8


class Volume:
    """The logarithm of a volume along a motion, at each of its events.

    Attributes
    ----------
    rates : tuple of (float, float)
        Its trend per second with an error, as far as it is known in one way or another.
    """

    def __init__(self) -> None:
        self.rates: tuple[tuple[float, float], ...] = ()
        self._events: list[tuple[str, str]] = []
        self._states: list[np.ndarray] = []
        self._times: list[float] = []
        self._logarithms: list[float] = []
        self._now = 0.0
        self._passed: set[tuple[str, str]] = set()

    def add(self, machine: HybridMachine, segment: MotionSegment, events: int) -> None:
        """Take the segment in that ends with an event of this number, or with none."""
        if segment.transition is not None:
            self._passed.add((segment.transition, segment.mode))
        if events <= FIRST or len(self._times) > WATCHED or not np.isfinite(self._now):
            return
        self._now += _along(machine.mode(segment.mode), segment)
        if segment.transition is None:
            return
        self._now += _through(machine, segment)
        self._times.append(float(segment.times[-1]))
        self._logarithms.append(self._now)
        self._states.append(segment.states[-1])
        self._events.append((segment.transition, segment.mode))
        if len(self._times) > WATCHED and np.isfinite(self._now):
            times, logarithms = np.array(self._times), np.array(self._logarithms)
            alike = self._of_one_kind()
            functions = _functions(machine.system, np.array(self._states)[alike])
            beside = () if functions is None else _trend_beside(times[alike], logarithms[alike], functions)
            self.rates = ((_trend(times, logarithms), 0.0), *beside)

    def _of_one_kind(self) -> np.ndarray:
        """Which of the events are of the kind that happens most often."""
        often = max(self._passed, key=lambda kind: (self._events.count(kind), kind))
        return np.array([kind == often for kind in self._events])

    def kept(self, span: float) -> bool:
        """Whether a volume stays what it is within so many seconds of the motion, as far as is known."""
        return any((abs(rate) + error) * span <= KEPT for rate, error in self.rates)

    def seen_all(self, machine: HybridMachine) -> bool:
        """Whether all that may happen has: what has not may lose something."""
        acting = [each for each in machine.system.transitions if each.role != "watched"]
        return all((each.name, each.source) in self._passed for each in acting)


def _trend(times: np.ndarray, values: np.ndarray) -> float:
    """Slope of a straight line through values that go up and down with several frequencies.

    Weights that vanish smoothly at both ends let them average out fast (S. Das, Y. Saiki, E. Sander &
    J. A. Yorke, Nonlinearity 30 (2017) 4111).
    """
    share = (times[1:-1] - times[0]) / (times[-1] - times[0])
    with np.errstate(divide="ignore"):  # at the ends nothing weighs
        weights = np.exp(-1.0 / (share * (1.0 - share)))
    t = times[1:-1] - np.average(times[1:-1], weights=weights)
    return float((weights * t) @ values[1:-1] / ((weights * t) @ t))


def _functions(system: System, states: np.ndarray) -> np.ndarray | None:
    """Functions of states, shape (k, n), a column each: their products by two; of many states, themselves.

    None where even these are too many for so few events.
    """
    turns = np.array([state.period or 0.0 for state in system.states])
    phases = 2.0 * np.pi * states[:, turns > 0.0] / turns[turns > 0.0]
    columns = np.hstack([states[:, turns == 0.0], np.cos(phases), np.sin(phases)])
    half = 0.5 * np.ptp(columns, axis=0)
    moves = half > SAME * np.abs(columns).max(axis=0)
    moved = (columns[:, moves] - columns[:, moves].mean(axis=0)) / half[moves]
    n, most = moved.shape[1], FUNCTIONS * len(states)
    if n + 1 > most:
        return None
    both = [moved[:, i] * moved[:, j] for i in range(n) for j in range(i, n)]
    if n + 1 + len(both) > most:
        both = []
    return np.column_stack([np.ones(len(states)), moved, *both])


def _trend_beside(
    times: np.ndarray, values: np.ndarray, functions: np.ndarray
) -> tuple[tuple[float, float], ...]:
    """Slope of values beside functions of the state, by least squares, with some standard errors.

    None where the functions go with the time themselves, as an amplitude does that decays.
    """
    u, sizes, _ = np.linalg.svd(functions, full_matrices=False)
    u = u[:, sizes > SAME * sizes[0]]
    t = times - times.mean()
    own, rest = t - u @ (u.T @ t), values - u @ (u.T @ values)
    if np.linalg.norm(own) < LEFT * np.linalg.norm(t):
        return ()
    rate = float(own @ rest / (own @ own))
    left = rest - rate * own
    variance = float(left @ left) / (len(times) - u.shape[1] - 1)
    return ((rate, SURE * float(np.sqrt(variance / (own @ own)))),)


def _along(flow: ModeFlow, segment: MotionSegment) -> float:
    """The integral of the divergence over an segment: Simpson's rule on cubics through its steps."""

    def divergence(t: float, x: np.ndarray) -> float:
        return float(np.trace(flow.field.jacobian(t, x, flow.c)[:, : len(x)]))

    times, states = segment.times, segment.states[:, flow.states]
    speeds = np.array([flow.field(t, x, flow.c) for t, x in zip(times, states, strict=True)])
    at_ends = np.array([divergence(t, x) for t, x in zip(times, states, strict=True)])
    steps = np.diff(times)
    halfway = 0.5 * (states[1:] + states[:-1]) - 0.125 * steps[:, None] * np.diff(speeds, axis=0)
    between = [divergence(t, x) for t, x in zip(times[:-1] + 0.5 * steps, halfway, strict=True)]
    return float(steps @ (at_ends[:-1] + 4.0 * np.array(between) + at_ends[1:]) / 6.0)


def _through(machine: HybridMachine, segment: MotionSegment) -> float:
    """The logarithm of what the event that ends an segment makes of a volume; NaN where dimensions differ."""
    transition = machine.transition(str(segment.transition), segment.mode)
    matrix, _ = saltation(machine, transition, float(segment.times[-1]), segment.states[-1])
    if matrix.shape[0] != matrix.shape[1] or not np.isfinite(matrix).all():
        return np.nan
    return float(np.linalg.slogdet(matrix)[1])
