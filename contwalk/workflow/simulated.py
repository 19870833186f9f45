"""What a simulation gives, whichever kind of machine it was of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.flow.events import Event

LONGEST = 500_000  # steps, after which a motion that has not settled is given up
PARTS = 4  # samples to a step where extremes are looked for


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
        `ok`, or why it ended early, with a sentence where more than the status is known.
    settled : bool or None
        None where nobody asked.
    steps, evaluations : int
    note : str
        What to know of the start.
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
