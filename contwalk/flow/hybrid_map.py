"""The map of a hybrid machine from a state to the one after some events, with its derivative.

For the explicit pair of order 8 it is one call of compiled code. Where that is not sure of itself, as with
transitions that happen at once, and for the other methods, the arcs are found one by one and differentiated on
their steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.errors import NotFinite
from contwalk.flow import hybrid_plan as told
from contwalk.flow.hybrid import Arc, arcs
from contwalk.flow.hybrid_machine import HybridMachine, applied
from contwalk.flow.saltation import saltation
from contwalk.flow.verbs import tangents
from contwalk.flow.walk import METHOD, Walk


@dataclass(frozen=True, eq=False)
class Mapped:
    """Where a motion is right after some events.

    Parameters
    ----------
    time : float
    state : ndarray, shape (n,)
        Of full length.
    mode : str
    monodromy : ndarray, shape (n, n)
        How deviations at the start are seen at this time: each event happens earlier or later for them. Rows
        and columns of states that do not exist are zero.
    shift : ndarray, shape (n,)
        Derivative of `time` by the state at the start. The state at the event itself, whenever it happens,
        changes by ``monodromy + outer(velocity, shift)``.
    velocity : ndarray, shape (n,)
        The field right after the last event.
    word : tuple of str
        The transitions that have happened.
    steps : int
    """

    time: float
    state: np.ndarray
    mode: str
    monodromy: np.ndarray
    shift: np.ndarray
    velocity: np.ndarray
    word: tuple[str, ...]
    steps: int


class StepMap:
    """The map over a number of events.

    Parameters
    ----------
    machine : HybridMachine
    mode : str
        The one that it begins in.
    events : int
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    at : str, optional
        The state is the one right before this transition, which is the first event.
    just_after : str, optional
        The state is one right after this transition.
    method : str
        One of `flow.METHODS`.
    longest : float
        Time after which it is given up.
    """

    def __init__(
        self,
        machine: HybridMachine,
        mode: str,
        events: int,
        weights: np.ndarray,
        *,
        at: str | None = None,
        just_after: str | None = None,
        method: str = METHOD,
        longest: float = np.inf,
    ) -> None:
        self.machine, self.mode, self.events = machine, mode, events
        self.weights = np.asarray(weights, dtype=float)
        self.at, self.just_after, self.method, self.longest = at, just_after, method, longest
        self._columns = machine.mode(mode).states
        self._walk = Walk(machine, self.weights, len(self._columns), events) if method == METHOD else None

    def __call__(self, t0: float, x0: np.ndarray, tolerance: float) -> tuple[float, np.ndarray, np.ndarray]:
        """Time, full-length state and monodromy after the events; see `Mapped`."""
        found = self.mapped(t0, x0, tolerance)
        return found.time, found.state, found.monodromy

    def mapped(self, t0: float, x0: np.ndarray, tolerance: float) -> Mapped:
        """Everything that is known after the events.

        Raises
        ------
        NotFinite
            If the motion ends before.
        StartError
            If a guard is past zero at the start.
        """
        raise NotImplementedError
