"""The map of a hybrid machine from a state to the one after some events, with its derivative.

For the explicit pair of order 8 it is one call of compiled code. Where that is not sure of itself, as with
transitions that happen at once, and for the other methods, the segments are found one by one and
differentiated on their steps. What it costs is measured beside peers; tests show what it gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.errors import NotFinite
from contwalk.flow.hybrid.event_integrator import METHOD, EventIntegrator
from contwalk.flow.hybrid.event_records import ARRIVED
from contwalk.flow.hybrid.machine import HybridMachine, applied
from contwalk.flow.hybrid.motion_segment import Control, MotionSegment, far
from contwalk.flow.hybrid.motions import motion_segments
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.flow.hybrid.saltation import saltation
from contwalk.flow.integrate import tangents


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
    itinerary : tuple of str
        The transitions that have happened.
    steps : int
    """

    time: float
    state: np.ndarray
    mode: str
    monodromy: np.ndarray
    shift: np.ndarray
    velocity: np.ndarray
    itinerary: tuple[str, ...]
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
    modes : sequence of str, optional
        The modes that it leads through; all of them by default.
    method : str
        One of `flow.METHODS`.
    longest : float
        Time after which it is given up.

    Raises
    ------
    ValueError
        If the mode is not the one that `at` leads out of, or `just_after` leads into.
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
        modes: Sequence[str] | None = None,
        method: str = METHOD,
        longest: float = np.inf,
    ) -> None:
        system = machine.system
        into = [t.target for t in system.transitions if t.name == just_after]
        if (at and mode not in system.sources(at)) or (just_after and mode not in into):
            raise ValueError(f"a map from mode '{mode}' cannot begin with '{at or just_after}'")
        self.machine, self.mode, self.events = machine, mode, events
        self.weights = np.asarray(weights, dtype=float)
        self.at = None if at is None else machine.transition(at, mode)
        self.just_after, self.method, self.longest = just_after, method, longest
        self._columns = machine.mode(mode).states
        self._identity = np.eye(len(self._columns))
        self._span = longest
        if longest == np.inf:  # the integrator asks for an end
            flow = machine.mode(mode)
            self._span = far(flow, 0.0, self.weights[flow.states], self.weights[flow.states])
        self._entries: dict[str, np.ndarray] = {}
        through = modes or [each.name for each in system.modes]
        # Jumps at instants of time are met segment by segment.
        compiled = method == METHOD and not machine.guards_jump_in_time
        self._integrator = (
            EventIntegrator(machine, self.weights, through, len(self._columns), events) if compiled else None
        )

    def __call__(self, t0: float, x0: np.ndarray, tolerance: float) -> tuple[float, np.ndarray, np.ndarray]:
        """Time, full-length state and monodromy after the events; see `Mapped`."""
        if self._integrator is not None and self._integrated(self._integrator, t0, x0, tolerance):
            return float(self._integrator.clock[0]), *self._arrived(self._integrator)[1:]
        found = self._step_by_step(float(t0), np.asarray(x0, dtype=float), tolerance)
        return found.time, found.state, found.monodromy

    def mapped(self, t0: float, x0: np.ndarray, tolerance: float) -> Mapped:
        """Everything that is known after the events; x0 has shape (n,), of full length.

        Raises
        ------
        NotFinite
            If the motion ends before.
        """
        integrator = self._integrator
        if integrator is None or not self._integrated(integrator, t0, x0, tolerance):
            return self._step_by_step(float(t0), np.asarray(x0, dtype=float), tolerance)
        mode, state, monodromy = self._arrived(integrator)
        happened = [integrator.transitions[number] for number in integrator.itinerary]
        itinerary = tuple(transition.name for transition in happened)
        shift, velocity = self.machine.full(self.mode, integrator.shift), integrator.velocity(happened[-1])
        velocity, steps = self.machine.full(mode, velocity), integrator.happened.steps
        return Mapped(float(integrator.clock[0]), state, mode, monodromy, shift, velocity, itinerary, steps)

    def _integrated(self, integrator: EventIntegrator, t: float, x: np.ndarray, tolerance: float) -> bool:
        """Whether compiled code, which leaves its results in the integrator, is sure of them."""
        integrator.begin(t, np.asarray(x, dtype=float), self.mode, self.just_after, self.at)
        integrator.places[self.mode].columns[:] = self._identity
        return integrator(t + self._span, tolerance) == ARRIVED

    def _arrived(self, integrator: EventIntegrator) -> tuple[str, np.ndarray, np.ndarray]:
        """Mode, full-length state and monodromy."""
        mode, n = integrator.modes[integrator.happened.mode], len(self.weights)
        place = integrator.places[mode]
        if mode not in self._entries:
            self._entries[mode] = np.add.outer(n * place.states, self._columns).ravel()
        state, monodromy = np.zeros(n), np.zeros((n, n))
        state[place.states] = place.state
        monodromy.ravel()[self._entries[mode]] = place.columns.ravel()
        return mode, state, monodromy

    def _full(self, mode: str, derivatives: np.ndarray) -> np.ndarray:
        matrix = np.zeros((len(self.weights), len(self.weights)))
        matrix[np.ix_(self.machine.mode(mode).states, self._columns)] = derivatives
        return matrix

    def _step_by_step(self, t: float, x: np.ndarray, tolerance: float) -> Mapped:
        """Segment by segment, each differentiated on its steps."""
        mode, last, itinerary, steps = self.mode, self.just_after, [], 0
        columns, shift = np.eye(len(self._columns)), np.zeros(len(self._columns))
        if self.at is not None:
            matrix, own = saltation(self.machine, self.at, t, x)
            columns, shift, x = matrix, own, applied(self.machine, self.at, t, x)
            mode, last, itinerary = self.at.target, self.at.name, [self.at.name]
        if len(itinerary) < self.events:
            control = Control(tolerance, self.weights, self.method)
            motion = motion_segments(self.machine, t, x, mode, t + self.longest, control, last)
            for segment in motion:
                columns = self._along(segment, columns)
                if segment.transition is None or segment.after is None:
                    if not itinerary:  # nothing has happened: perhaps the start is past its guard
                        past_zero(self.machine, t, x, mode, self.weights)
                    raise NotFinite(_ended(segment, len(itinerary), self.events), "Start elsewhere.")
                happening = self.machine.transition(segment.transition, segment.mode)
                matrix, own = saltation(self.machine, happening, float(segment.times[-1]), segment.states[-1])
                columns, shift = matrix @ columns, own @ columns
                t, x, mode = float(segment.times[-1]), segment.after, happening.target
                itinerary.append(segment.transition)
                steps += len(segment.times) - 1
                if len(itinerary) == self.events:
                    break
                if segment.status != "ok":
                    raise NotFinite(_ended(segment, len(itinerary), self.events), "Start elsewhere.")
        flow = self.machine.mode(mode)
        velocity = self.machine.full(mode, flow.field(t, x[flow.states], flow.c))
        shifts, matrix = self.machine.full(self.mode, shift), self._full(mode, columns)
        return Mapped(t, x, mode, matrix, shifts, velocity, tuple(itinerary), steps)

    def _along(self, segment: MotionSegment, columns: np.ndarray) -> np.ndarray:
        if len(segment.times) == 1:
            return columns
        flow = self.machine.mode(segment.mode)
        start, sources = segment.states[0][flow.states], [-1] * columns.shape[1]
        return tangents(flow.field, flow.c, segment.times, start, columns, sources, self.method)[1]


def _ended(segment: MotionSegment, count: int, events: int) -> str:
    why = segment.reason or f"No transition happens until t = {segment.times[-1]:.10g}."
    return f"The motion ends after {count} of {events} events. {why}"
