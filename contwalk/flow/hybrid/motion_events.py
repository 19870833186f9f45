"""The events of a motion, one after the other, without the steps between them.

Whole stretches with their events and resets are left to the compiled integrator. Where it is not sure of
itself (transitions at once, guards that rest at zero, events that may accumulate) the reference integrator
of `motions` goes on from the last event to the next; the steps of both are the same.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.flow.hybrid import event_records as answers
from contwalk.flow.hybrid.clocks import Clocks
from contwalk.flow.hybrid.event_integrator import METHOD, EventIntegrator
from contwalk.flow.hybrid.machine import HybridMachine, landed
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import parts
from contwalk.system import Transition

ROOM = 1000  # steps of a segment, after which compiled code comes back and goes on
MOST_STEPS = 1_000_000  # of a motion
ON_ITS_WAY, TIME_UP, TOO_MANY = "on_its_way", "time_up", "too_many_steps"


@dataclass(frozen=True, eq=False)
class Standpoint:
    """Where a motion stands: right after the event `last`, if there was one.

    `state` is of full length, and so is `noise`, its uncertainties; None stands for those of its rounding.
    """

    time: float
    mode: str
    state: np.ndarray
    last: str | None = None
    noise: np.ndarray | None = None


class MotionEvents:
    """Motions of a machine, event by event.

    Parameters
    ----------
    machine : HybridMachine
    control : Control
        Watched transitions are not looked at.
    ends : collection of str
        Transitions that end a motion before their reset.
    most_steps : int
        After which a motion is given up as `too_many_steps`.

    Attributes
    ----------
    at : Standpoint
        Where the motion stands: its end, when `events` has come to it.
    status : str
        `ON_ITS_WAY`, `TIME_UP`, the name of the transition that has ended it, or a status of a
        `MotionSegment` that says why it cannot go on.
    steps : int
    """

    def __init__(
        self,
        machine: HybridMachine,
        control: Control,
        ends: Collection[str] = (),
        most_steps: int = MOST_STEPS,
    ) -> None:
        self._machine, self._control, self._ends = machine, control, frozenset(ends)
        self._most_steps = most_steps
        # Jumps at instants of time are met segment by segment.
        self._compiles = control.method == METHOD and not machine.guards_jump_in_time
        self._applied: set[tuple[str, str]] = set()  # those that motions have come to
        self._unlearned = False
        self._integrator: EventIntegrator | None = None
        self.status, self.steps = ON_ITS_WAY, 0

    def events(self, begin: Standpoint, t1: float) -> Iterator[tuple[str, float]]:
        """Name and time of each event until t1, which is finite; the one that ends the motion is the last."""
        self.at, self.status, self.steps = begin, ON_ITS_WAY, 0
        self._now: list[tuple[str, str]] = []
        while self.status == ON_ITS_WAY:
            integrator = self._knowing(self.at.mode) if self._compiles else None
            if integrator is not None:
                yield from self._compiled(integrator, t1)
            if self.status == ON_ITS_WAY:
                yield from self._step_by_step(t1)

    # -- by compiled code ----------------------------------------------------------------------------------

    def _knowing(self, mode: str) -> EventIntegrator:
        """The integrator, which learns the modes and resets that motions come to."""
        weights = self._control.weights
        if self._integrator is None:
            self._integrator = EventIntegrator(
                self._machine, weights, [mode], room=ROOM, applied=self._applied, paced=True
            )
        elif self._unlearned or mode not in self._integrator.places:
            self._integrator.learn(self._machine, weights, [mode], self._applied)
        self._unlearned = False
        return self._integrator

    def _learn(self, transition: Transition) -> None:
        """Remember a transition that the integrator may not know."""
        key = transition.name, transition.source
        if key not in self._applied:
            self._applied.add(key)
            self._unlearned = True

    def _compiled(self, integrator: EventIntegrator, t1: float) -> Iterator[tuple[str, float]]:
        """Events as long as compiled code is sure and knows them; `at` is where it no longer is."""
        self._begin(integrator)
        while True:
            answer = integrator(t1, self._control.tolerance)
            happened = integrator.happened
            t, mode = float(integrator.clock[0]), integrator.modes[happened.mode]
            self.steps += happened.steps
            happened.steps = 0
            if self.steps > self._most_steps:
                self.at, self.status = Standpoint(t, mode, self._state(integrator, mode)), TOO_MANY
                return
            if answer == answers.FULL:
                continue
            if answer not in (answers.ARRIVED, answers.AWAY):
                if answer == answers.TIME_UP:
                    self.at = Standpoint(t, mode, self._state(integrator, mode))
                    self.status = TIME_UP
                return
            transition = integrator.transitions[int(integrator.itinerary[0])]
            name, happened.count = transition.name, 0
            if answer == answers.ARRIVED:
                self._pass(t, transition.source, name)
                self.at = Standpoint(t, mode, self._state(integrator, mode), name)
                yield name, t
                continue
            before = self._state(integrator, mode)
            if name in self._ends:
                self.at, self.status = Standpoint(t, mode, before), name
                yield name, t
                return
            self._pass(t, mode, name)
            after, noise = landed(self._machine, transition, t, before)
            self.at = Standpoint(t, transition.target, after, name, noise)
            yield name, t
            self._learn(transition)
            integrator = self._knowing(transition.target)
            self._begin(integrator)

    def _begin(self, integrator: EventIntegrator) -> None:
        at = self.at
        integrator.begin(at.time, at.state, at.mode, at.last, noise=at.noise)

    def _state(self, integrator: EventIntegrator, mode: str) -> np.ndarray:
        """The integrator's state in a mode, of full length."""
        place, state = integrator.places[mode], np.zeros(len(self._control.weights))
        state[place.states] = place.state
        return state

    def _pass(self, t: float, mode: str, name: str) -> None:
        """Remember an event, and those before it at the same instant."""
        if t != self.at.time:
            self._now = []
        self._now.append((mode, name))

    # -- by the reference ----------------------------------------------------------------------------------

    def _step_by_step(self, t1: float) -> Iterator[tuple[str, float]]:
        """The next event, and those at the same instant."""
        at, clocks = self.at, Clocks(self.at.time) if self._now else None
        for mode, name in self._now:
            assert clocks is not None
            clocks.record(at.time, self._machine.mode(mode), name)
        begins = at.time, at.state, at.mode
        for part in parts(self._machine, *begins, t1, self._control, at.last, noise=at.noise, clocks=clocks):
            self.steps += len(part.times) - 1
            t, before = float(part.times[-1]), part.states[-1]
            if part.transition in self._ends:
                self.at, self.status = Standpoint(t, part.mode, before), str(part.transition)
                yield str(part.transition), t
                return
            if part.status != "ok" or self.steps > self._most_steps:
                self.status = part.status if part.status != "ok" else TOO_MANY
                return
            if part.transition is None or part.after is None:
                self.at = Standpoint(t, part.mode, before)
                continue
            transition = self._machine.transition(part.transition, part.mode)
            self._pass(t, part.mode, part.transition)
            noise = landed(self._machine, transition, t, before)[1]
            self.at = Standpoint(t, transition.target, part.after, part.transition, noise)
            yield part.transition, t
            self._learn(transition)
            if len(part.times) > 1 and self._compiles:
                return
        self.status = TIME_UP
