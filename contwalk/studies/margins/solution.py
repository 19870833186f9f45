"""A stored solution as motions set out from it: its instants, and what happens on it in a period."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.diagram.reopening import reopened
from contwalk.errors import ContwalkError
from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.discretization import Discretization
from contwalk.system import System

# How well the states at the instants are known, in parts of the states.
ACCURATE = Discretization(accuracy=1e-10)
SAMPLES = 65  # instants of each leg that magnitudes are taken from
ZOOMS = 9  # each finds an instant 32 times sharper
ROUNDED = 1e-11  # of the time: an instant that is nearer to an event than this is at it
AT_EVENT = 1e-7  # of the period: so near to an event the stored state, with its own error, is the one at it


@dataclass(frozen=True, eq=False)
class Instant:
    """A state of the solution.

    Parameters
    ----------
    fraction : float
        Of the closure.
    time : float
        Seconds, the machine's own, for fields that depend on it.
    mode : str
    state : ndarray, shape (n,)
        Of full length; states that do not exist in the mode are 0.
    exists : tuple of int
        Those that do.
    last : str
        The transition that has led to this very state; empty between two.
    leg, share : int, float
        The leg of the closure that it is on, and where on it, 0 to 1.
    """

    fraction: float
    time: float
    mode: str
    state: np.ndarray
    exists: tuple[int, ...]
    last: str = ""
    leg: int = 0
    share: float = 0.0


@dataclass(frozen=True, eq=False)
class Solution:
    """What is pushed.

    Parameters
    ----------
    parameters : mapping
        All of the system's, by name.
    period : float
        Of the whole orbit, seconds; NaN of an equilibrium.
    instants : tuple of Instant
    cycle : tuple of tuple of str
        The transitions of a period that are hard, in their order; those that follow each other within
        `TOGETHER` of the period in one group, as their order may change without the motion being another.
    magnitudes : ndarray, shape (n,)
        Half the range of each state over the solution, or what the plugin declares; 1 of a state that is zero
        all over it.
    course : ndarray, shape (k, n)
        States all over it, in their order; NaN where a state does not exist.
    neutral : tuple of str
        States along which the solution is one of a family: declared directions that move this state alone.
    """

    parameters: dict[str, float]
    period: float
    instants: tuple[Instant, ...]
    cycle: tuple[tuple[str, ...], ...]
    magnitudes: np.ndarray
    course: np.ndarray
    neutral: tuple[str, ...] = ()


# A state that is smaller all over the solution, in parts of the largest one, is zero but for rounding.
ZERO = float(np.finfo(float).eps)
# Events that follow each other within this part of the period happen together.
TOGETHER = 0.02


def solution_at(
    system: System, branch: Branch, point: SpecialPoint | int, fractions: Sequence[float]
) -> Solution:
    """The solution of a stored point, with its states at parts of the closure.

    Raises
    ------
    ContwalkError
        If the point's orbit cannot be computed once more.
    """
    with np.errstate(all="ignore"):
        problem: Any
        problem, sample = reopened(system, branch, point, ACCURATE)
        kind, stored = branch.info.problem, _stored_state(branch, point)
        if kind == "equilibrium":
            found = _equilibrium(system, problem, sample)
        elif kind == "hybrid_orbit":
            found = _with_events(system, branch, problem, sample, fractions, stored)
        elif kind == "periodic_orbit":
            found = _smooth(system, branch, problem, sample, fractions, stored)
        else:
            raise ContwalkError(
                f"Branch {branch.name} is one of {kind} points, which are no motions.",
                "Name a point on a branch of equilibria or orbits.",
            )
    return found


def _stored_state(branch: Branch, point: SpecialPoint | int) -> np.ndarray:
    """The state that the database tells of a point, shape (n,): where the run asked for it (`report_at`)."""
    if isinstance(point, SpecialPoint):
        if point.state:
            return np.array([point.state[name] for name in branch.info.states], dtype=float)
        point = point.index
    return np.array(branch.points["state"][point], dtype=float)


def _equilibrium(system: System, problem: Any, sample: Any) -> Solution:
    n = len(system.states)
    state = np.array(sample.z[:n])
    mode = system.modes[0].name
    instant = Instant(0.0, 0.0, mode, state, system.states_of(mode))
    values = dict(problem.values_of(sample.z))
    return _solution(system, values, np.nan, [instant], (), state[None], problem)


def _smooth(
    system: System, branch: Branch, problem: Any, sample: Any, fractions: Sequence[float], stored: np.ndarray
) -> Solution:
    z, mode = sample.z, system.modes[0].name
    (view,), duration = problem.view(z), problem.duration(z)
    _, states = problem.motion_of(z)
    period = int(branch.info.settings.get("fold", 1)) * sample.period
    values = dict(problem.values_of(z))
    begin, _ = _nearest(view.at, stored, np.ptp(states, axis=0), _neutral(system, problem, states[0]))
    instants = []
    for fraction in fractions:
        share = (begin + fraction) % 1.0
        state = np.array(view.at(np.array([share]))[0])
        # A forced orbit is looked at from where its force begins.
        exists = system.states_of(mode)
        instants.append(Instant(fraction, share * duration, mode, state, exists, share=share))
    return _solution(system, values, period, instants, (), states, problem)


def _with_events(
    system: System, branch: Branch, problem: Any, sample: Any, fractions: Sequence[float], stored: np.ndarray
) -> Solution:
    problem, z = problem.explicit(sample.z)
    stretches, legs = problem.stretches(z), problem.itinerary.unfolded(system).legs
    grid, closure = np.linspace(0.0, 1.0, SAMPLES), problem.duration(z)
    begins, ends = stretches[0].start[0], stretches[-1].end[0]
    states = []
    for stretch in stretches:
        seen = stretch.at(grid)[1]
        states.append(np.where(np.isin(np.arange(seen.shape[1]), stretch.exists), seen, np.nan))
    course = np.concatenate(states)
    low, high = _bounds(course)
    at = begins + _stored_at(system, problem, z, high - low, stored)
    instants = []
    for fraction in fractions:
        time = at + fraction * closure
        instants.append(_on(stretches, legs, begins + (time - begins) % (ends - begins), fraction))
    period = int(branch.info.settings.get("fold", 1)) * sample.period
    events = [
        (leg.name, s.end[0]) for leg, s in zip(legs, stretches, strict=True) if leg.name and not leg.soft
    ]
    cycle = _grouped(events, ends - begins)
    return _solution(system, dict(problem.values_of(z)), period, instants, cycle, course, problem)


def _stored_at(system: System, problem: Any, z: np.ndarray, ranges: np.ndarray, target: np.ndarray) -> float:
    """Seconds from the first leg's start to the state that the database tells of the orbit, `target`."""
    stretches = problem.stretches(z)
    if not np.isfinite(target).all():
        return 0.0
    neutral = _neutral(system, problem, stretches[0].start[1])
    found = []
    for number, stretch in enumerate(stretches):
        absent = [i for i in range(len(target)) if i not in stretch.exists]
        share, apart = _nearest(partial(_seen, stretch), target, ranges, (*neutral, *absent))
        found.append((round(apart, 9), number, share))
    _, number, share = min(found)
    stretch = stretches[number]
    begin, end = stretch.start[0], stretch.end[0]
    time = float(begin + share * (end - begin))
    near = AT_EVENT * (stretches[-1].end[0] - stretches[0].start[0])
    time = next((float(s.end[0]) for s in stretches if abs(s.end[0] - time) <= near), time)
    return time - float(stretches[0].start[0])


def _seen(stretch: Any, shares: np.ndarray) -> np.ndarray:
    """States of full length at instants in 0..1 of a leg."""
    return np.asarray(stretch.at(shares)[1])


def _nearest(
    at: Callable[[np.ndarray], np.ndarray], target: np.ndarray, ranges: np.ndarray, left_out: Sequence[int]
) -> tuple[float, float]:
    """The instant in 0..1 at which a motion is nearest to a state, and how near, in parts of the ranges."""
    scales = np.where(np.isfinite(ranges) & (ranges > 0.0), ranges, 1.0)
    scales[list(left_out)] = np.inf
    low, high = 0.0, 1.0
    for _ in range(ZOOMS):
        shares = np.linspace(low, high, SAMPLES)
        apart = np.abs((at(shares) - target) / scales).max(axis=1)
        best = int(np.argmin(apart))
        low, high = shares[max(best - 1, 0)], shares[min(best + 1, SAMPLES - 1)]
    return float(shares[best]), float(apart[best])


def _on(stretches: Sequence[Any], legs: Sequence[Any], time: float, fraction: float) -> Instant:
    """The state at a time of the motion; at an event, the one after it."""
    number = max(k for k, s in enumerate(stretches) if k == 0 or s.start[0] <= time + ROUNDED * abs(time))
    stretch = stretches[number]
    start, end = stretch.start[0], stretch.end[0]
    share = min(max((time - start) / (end - start), 0.0), 1.0) if end > start else 0.0
    share = 0.0 if share * (end - start) <= ROUNDED * abs(time) else share
    times, states = stretch.at(np.array([share]))
    state = np.where(np.isin(np.arange(states.shape[1]), stretch.exists), states[0], 0.0)
    last = legs[number - 1].name if share == 0.0 else ""
    return Instant(fraction, float(times[0]), legs[number].mode, state, stretch.exists, last, number, share)


def _grouped(events: Sequence[tuple[str, float]], period: float) -> tuple[tuple[str, ...], ...]:
    """Events in their order, in groups of those that happen together."""
    groups: list[list[str]] = []
    before = -np.inf
    for name, time in events:
        if time - before <= TOGETHER * period and groups:
            groups[-1].append(name)
        else:
            groups.append([name])
        before = time
    wraps = len(groups) > 1 and events[0][1] + period - before <= TOGETHER * period
    if wraps:
        groups[0] = [*groups.pop(), *groups[0]]
    return tuple(tuple(sorted(group)) for group in groups)


def _bounds(states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of each state while it exists; infinite, the wrong way round, of one that never
    does."""
    there = np.isfinite(states)
    return np.where(there, states, np.inf).min(axis=0), np.where(there, states, -np.inf).max(axis=0)


def _solution(
    system: System,
    values: dict[str, float],
    period: float,
    instants: Sequence[Instant],
    cycle: tuple[tuple[str, ...], ...],
    states: np.ndarray,
    problem: Any,
) -> Solution:
    magnitudes = magnitudes_of([state.scale for state in system.states], states)
    neutral = tuple(system.state_names[i] for i in _neutral(system, problem, instants[0].state))
    return Solution(values, float(period), tuple(instants), cycle, magnitudes, states, neutral)


def magnitudes_of(declared: Sequence[float | None], states: np.ndarray) -> np.ndarray:
    """Magnitudes of states by what is declared of them, and by their values over a solution, shape (k, n)."""
    low, high = _bounds(states)
    half = 0.5 * (high - low)
    sizes = np.where(np.isfinite(half) & (half > 1e-9 * np.abs(high)), half, np.abs(high))
    sizes = np.where(np.isfinite(sizes), sizes, 0.0)
    zero = sizes <= ZERO * sizes.max(initial=0.0)
    return np.array(
        [
            given if given is not None else 1.0 if none else size
            for given, size, none in zip(declared, sizes, zero, strict=True)
        ]
    )


def _neutral(system: System, problem: Any, state: np.ndarray) -> tuple[int, ...]:
    """Places of the states that a pinned direction moves alone, whatever the parameters."""
    moved = neutrals.directions(system, problem.pins, state, problem.line.parameters)
    return tuple(int(np.flatnonzero(v)[0]) for v in moved.T if np.count_nonzero(v) == 1)
