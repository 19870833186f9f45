"""The motion along an orbit over some periods, with what happens on the way: for pictures of the machine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.system import System
from contwalk.workflow.stored.orbits import Orbit


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion.

    Parameters
    ----------
    times, states : ndarray, shapes (k,) and (k, n)
        At an event, its instant twice, with the states on both sides.
    events : tuple of (float, str)
        Times and names of the events, the one with which it begins left out.
    period : float
        Seconds.
    begins : str
        Name of the event that it begins right after; empty where there is none.
    there : ndarray of bool, shape (k, n), optional
        Which states exist at the instants, where not all do in each mode.
    """

    times: np.ndarray
    states: np.ndarray
    events: tuple[tuple[float, str], ...]
    period: float
    begins: str = ""
    there: np.ndarray | None = None

    @property
    def marks(self) -> tuple[tuple[float, str], ...]:
        """All events, the one that it begins after included."""
        return ((float(self.times[0]), self.begins), *self.events) if self.begins else self.events

    @property
    def jumps(self) -> np.ndarray:
        """Rows right after an event, shape (j,): those that have the instant of the row before."""
        return np.flatnonzero(np.diff(self.times) == 0.0) + 1

    def broken(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Times and values along the motion, (k, m), with a row of NaN at each event."""
        jumps = self.jumps
        return np.insert(self.times, jumps, self.times[jumps]), np.insert(values, jumps, np.nan, axis=0)


def motion_along(system: System, orbit: Orbit, periods: int = 1) -> Motion:
    """The motion along an orbit over whole periods, from the orbit's first state on.

    States that are angles go on turning.
    """
    rounds, length = periods * orbit.closures, float(orbit.times[-1] - orbit.times[0])
    growth = _growth(system, orbit)
    starts = np.array([*orbit.breaks, len(orbit.times)], dtype=int)
    times: list[np.ndarray] = []
    there: list[np.ndarray] = []
    states: list[np.ndarray] = []
    events: list[tuple[float, str]] = []
    for number in range(rounds):
        own = orbit.times + number * length
        again = orbit.states + number * growth
        if times:
            own = own.copy()
            own[orbit.times == orbit.times[0]] = times[-1][-1]
        # Without an event, the first row is the last one of the round before.
        first = 0 if orbit.events or not times else 1
        times.append(own[first:])
        states.append(again[first:])
        there += [] if orbit.there is None else [orbit.there[first:]]
        events += [(float(own[row - 1]), name) for row, name in zip(starts, orbit.events, strict=False)]
    begins = orbit.events[-1] if orbit.events else ""
    period = orbit.closures * length
    exist = np.concatenate(there) if there else None
    return Motion(np.concatenate(times), np.concatenate(states), tuple(events), period, begins, exist)


def _growth(system: System, orbit: Orbit) -> np.ndarray:
    """By how much each state is larger after a round: whole turns of angles."""
    if orbit.turns is not None:
        return orbit.turns
    periods = np.array([state.period or np.inf for state in system.states])
    grown = orbit.states[-1] - orbit.states[0]
    turns = np.round(grown / periods)
    return np.where(turns != 0.0, turns * np.where(np.isfinite(periods), periods, 0.0), 0.0)
