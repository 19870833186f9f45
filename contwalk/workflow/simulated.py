"""What a simulation gives, whichever kind of machine it was of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from contwalk.flow.events.crossings import Event
from contwalk.flow.events.settling import Settling
from contwalk.system import System

LONGEST = 500_000  # steps, after which a motion that has not settled is given up
PARTS = 4  # samples to a step where extremes are looked for
DRAWN, MOST_DRAWN = 8, 200_000  # samples to a step in figures, and in all


@dataclass(frozen=True, eq=False)
class Simulated:
    """A computed motion.

    Parameters
    ----------
    times, values : ndarray, shapes (k,) and (k, n)
        At a transition its instant twice, with the states on both sides.
    modes : ndarray of int, shape (k,)
        Positions of the modes in the system.
    events : list of Event
    status, reason : str
        `ok`, `fallen` where the plugin says so of its end, or why it ended early, with a sentence where more
        than the status is known.
    settled : bool or None
        None where nobody asked.
    steps, evaluations : int
    note : str
        What to know of the start.
    drawn : tuple of ndarray, optional
        Times, states and modes for figures, so near to each other that curves have no corners; those that are
        stored if there are none.
    parameters : mapping
        Values of all parameters.
    """

    times: np.ndarray
    values: np.ndarray
    modes: np.ndarray
    events: list[Event]
    status: str
    reason: str
    settled: bool | None
    steps: int
    evaluations: int
    note: str = ""
    drawn: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)


def settling_of(system: System) -> Settling:
    """What says that a motion repeats itself, wherever it is along a neutral direction."""
    held = {neutral.pin for neutral in system.neutral}
    return Settling(
        [state.period for state in system.states], [state.name in held for state in system.states]
    )


def drawn_at(steps: np.ndarray, points: int) -> np.ndarray:
    """Instants at which a motion is drawn: some in each of its steps, by their ends, and those stored."""
    number = max(min(DRAWN, MOST_DRAWN // max(len(steps) - 1, 1)), 1)
    shares = np.linspace(0.0, 1.0, number + 1)[:-1]
    inner = (steps[:-1, None] + shares * np.diff(steps)[:, None]).ravel()
    return np.union1d(inner, np.linspace(steps[0], steps[-1], points))
