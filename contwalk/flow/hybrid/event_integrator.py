"""The compiled event integrator: what it is told, in memory of its own, and what it answers."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from ctypes import addressof
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.events.guard_code import OUTPUTS
from contwalk.flow.explicit import stages
from contwalk.flow.explicit.driver_call import Call
from contwalk.flow.explicit.explicit_call import Counts, StepControl
from contwalk.flow.hybrid import guard_taylor
from contwalk.flow.hybrid.event_records import (
    MOST_BITS,
    PARTS,
    EventCall,
    GuardOnStep,
    Happened,
    ModeRecord,
    TransitionRecord,
)
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.tableaus.runge_kutta import DOP853
from contwalk.system import Transition

METHOD = "dop853"
ROOM = 20_000
INTEGRATE = Entry("contwalk.flow.hybrid.event_kernel", "integrate", "q", "qdddd")


def warmup() -> None:
    """Compile what does not depend on the machine, or find it compiled."""
    _ = INTEGRATE.address, stages.code(METHOD)
    guard_taylor.warmup()


@dataclass(frozen=True, eq=False)
class Place:
    """Where a mode's numbers are, as views.

    Parameters
    ----------
    states : ndarray of int
        Positions of its states among all.
    state : ndarray, shape (m,)
    columns : ndarray, shape (m, q)
        The derivatives that are moved along.
    noise : ndarray, shape (m + 1,)
        Uncertainties of the time and the states.
    counts : Counts
        Work done.
    """

    states: np.ndarray
    state: np.ndarray
    columns: np.ndarray
    noise: np.ndarray
    counts: Counts


class EventIntegrator:
    """Motions through some modes of a machine, with the events on their way: memory of compiled code.

    Parameters
    ----------
    machine : HybridMachine
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    modes : sequence of str
        A transition that leads to another one ends the motion before its reset.
    columns : int
        Derivatives that are moved along.
    events : int
        The most events of one call.
    room : int
        The most steps of a segment.
    marks : bool
        Whether the states at the steps of a segment are kept, and steps marked in which watched guards may
        pass zero.
    applied : collection of (str, str), optional
        Names and sources of the transitions whose resets are known; others end the motion before theirs. All
        that lead into one of the modes by default.
    paced : bool
        Whether it is unsure after an event whose guard returns to zero before it can be seen to leave it:
        events may accumulate there.
    """

    def __init__(
        self,
        machine: HybridMachine,
        weights: np.ndarray,
        modes: Sequence[str],
        columns: int = 0,
        events: int = 1,
        room: int = ROOM,
        marks: bool = False,
        *,
        applied: Collection[tuple[str, str]] | None = None,
        paced: bool = False,
    ) -> None:
        # Not the machine itself: machines keep their integrators.
        self._system, self.columns, self._marks = machine.system, columns, marks
        self._paced = int(paced)
        self.modes: list[str] = []
        self.transitions: list[Transition] = []
        self._numbered: dict[tuple[str, str], int] = {}
        self._kept: list[np.ndarray] = []
        self.clock, self.happened = np.zeros(1), Happened()
        self.itinerary = np.zeros(events, dtype=np.int64)
        self.times, self.marks = np.empty(room + 1), np.zeros(room, dtype=np.int64)
        self.shift = np.zeros(columns)
        self.places: dict[str, Place] = {}
        self.nodes: dict[str, np.ndarray] = {}
        self._calls: list[Call] = []
        self._instants: list[guard_taylor.GuardTaylor] = []
        self._speeds: dict[tuple[str, str], np.ndarray] = {}
        self._looked_at: dict[str, list[str]] = {}
        self._weighed: dict[str, tuple[Call, np.ndarray]] = {}
        self._mode_records: list[ModeRecord] = []
        self._transition_records: list[TransitionRecord] = []
        self._call = EventCall(
            clock=self._keep(self.clock),
            happened=self.happened.address,
            itinerary=self._keep(self.itinerary),
            times=self._keep(self.times),
            marks=self._keep(self.marks),
            room=room,
            events=events,
            columns=columns,
            width=-(-columns // stages.WIDTH) * stages.WIDTH,
            column=self._keep(np.empty(len(machine.system.states))),
            shift=self._keep(self.shift),
        )
        self.learn(machine, weights, modes, applied)

    def learn(
        self,
        machine: HybridMachine,
        weights: np.ndarray,
        modes: Sequence[str],
        applied: Collection[tuple[str, str]] | None = None,
    ) -> None:
        """Let it know further modes and resets; what it has of those that it knows stays as it is.

        Parameters are those of the class, `weights` of shape (n,). Modes and resets that it knows may be
        given again.
        """
        new = [name for name in modes if name not in self.places]
        self.modes += new
        for transition in (each for mode in new for each in machine.system.leaving(mode)):
            self._numbered[transition.name, transition.source] = len(self.transitions)
            self.transitions.append(transition)
        self._mode_records += [self._mode(machine.mode(name)) for name in new]
        self.weigh(weights, new)
        unknown = TransitionRecord(target=-1)
        self._transition_records += [unknown] * (len(self.transitions) - len(self._transition_records))
        for number, transition in enumerate(self.transitions):
            if self._transition_records[number].target < 0 and self._applies(transition, applied):
                self._transition_records[number] = self._transition(machine, transition)
        self._modes = (ModeRecord * len(self.modes))(*self._mode_records)
        self._transitions = (TransitionRecord * len(self.transitions))(*self._transition_records)
        self._call.modes, self._call.transitions = addressof(self._modes), addressof(self._transitions)

    def _applies(self, transition: Transition, applied: Collection[tuple[str, str]] | None) -> bool:
        """Whether it is to know the reset of a transition."""
        known = applied is None or (transition.name, transition.source) in applied
        return known and transition.role != "watched" and transition.target in self.places

    def _keep(self, array: np.ndarray) -> int:
        """The address of an array that lives as long as the integrator."""
        self._kept.append(array)
        return array.ctypes.data

    def _mode(self, flow: ModeFlow) -> ModeRecord:
        name, n = flow.name, len(flow.states)
        moving = Call(flow.field, flow.c, METHOD, None, self.columns)
        self._weighed[name] = moving, np.ones(n)
        counts = Counts()
        moving.controlled(StepControl(), counts)
        if self.columns:
            moving.tangents(np.zeros((n, self.columns)), [-1] * self.columns)
        trial = Call(flow.field, flow.c, METHOD, None)
        noise = np.zeros(n + 1)
        columns = moving.split(moving.vectors[stages.Y])[1][:, : self.columns]
        start = guard_taylor.GuardTaylor(flow.field, flow.c, flow.p, {
            "state": moving.vectors[stages.Y].ctypes.data,
            "velocity": moving.vectors[stages.FIRST].ctypes.data,
            "noise": noise.ctypes.data,
            "weights": self._keep(self._weighed[name][1]),
        })  # fmt: skip
        self.places[name] = Place(flow.states, moving.vectors[stages.Y, :n], columns, noise, counts)
        if self._marks:
            nodes = self.nodes[name] = np.zeros((len(self.times), moving.length))
            moving.give("nodes", nodes)
        numbers = self._numbers(flow)
        self._looked_at[name] = [flow.transitions[i].name for i in numbers]
        guards = [flow.guards[i] for i in numbers]
        leads = [self._number(flow.transitions[i]) for i in numbers]
        at_entry = [flow.transitions[i].at_entry for i in numbers]
        sloping = [g.slopes_address if at >= 0 else 0 for g, at in zip(guards, leads, strict=True)]
        count, vectors = len(guards), stages.vectors(DOP853) - stages.FIRST
        coefficients = np.zeros((4, vectors))
        for row, terms in enumerate(DOP853.dense):
            for stage, value in terms.items():
                coefficients[row, stage] = value
        self._calls += [moving, trial]
        self._instants.append(start)
        return ModeRecord(
            moving=moving.record.address,
            trial=trial.record.address,
            size=n,
            guards=count,
            addresses=self._keep(np.array([g.address for g in guards], dtype=np.int64)),
            sloping=self._keep(np.array(sloping, dtype=np.int64)),
            directions=self._keep(np.array([g.direction for g in guards], dtype=np.int64)),
            leads=self._keep(np.array(leads, dtype=np.int64)),
            levels=self._keep(np.array(at_entry, dtype=np.int64)),
            parameters=self._keep(flow.p),
            measured=self._keep(np.zeros(OUTPUTS)),
            standing=self._keep(np.zeros(max(count, 1) * len(GuardOnStep._fields_))),
            noise=self._keep(noise),
            dense=self._keep(np.zeros(7 * n)),
            spare=self._keep(np.zeros(n)),
            speed=self._keep(np.zeros(n)),
            samples=self._keep(np.zeros(2 * (PARTS + 1))),
            coefficients=self._keep(coefficients),
            stages=vectors,
            between=self._keep(np.zeros((PARTS - 1) * 2 * n)),
            instant=start.instant.address,
            paced=self._paced,
        )

    def _number(self, transition: Transition) -> int:
        """Of a transition that acts; -1 for one that is watched."""
        return -1 if transition.role == "watched" else self._numbered[transition.name, transition.source]

    def _transition(self, machine: HybridMachine, transition: Transition) -> TransitionRecord:
        jump, c = machine.jump(transition)
        n, outputs = jump.n - 1, jump.m - 1
        speeds = np.zeros(n + outputs)
        self._speeds[transition.name, transition.source] = speeds[n:]
        return TransitionRecord(
            jump=jump.rhs_jac_address,
            constants=self._keep(c),
            rows=self._keep(jump.row_ptr),
            entries=self._keep(jump.col),
            taken=self._keep(np.zeros(n + 1)),
            given=self._keep(np.zeros(jump.m + len(jump.col))),
            outputs=outputs,
            target=self.modes.index(transition.target),
            speeds=self._keep(speeds),
            slopes=self._keep(np.zeros((outputs + 1) * (n + 1))),
            leaves=self._own(transition.name, transition.target),
            passes=self._passed(transition.name, transition.target),
        )

    def weigh(self, weights: np.ndarray, modes: Collection[str] | None = None) -> None:
        """Put the typical magnitudes of the states in place, of full length; in all modes by default."""
        for name in self._weighed if modes is None else modes:
            moving, own = self._weighed[name]
            own[:] = weights[self.places[name].states]
            moving.weigh(own)

    def begin(
        self,
        t: float,
        x: np.ndarray,
        mode: str,
        last: str | None,
        first: Transition | None = None,
        noise: np.ndarray | None = None,
    ) -> None:
        """Put a full-length state in place, right after one named `last`, or right before `first`.

        `noise`, of full length, are its uncertainties; they are those of its own rounding by default.
        """
        place = self.places[mode]
        self.clock[0] = t
        place.state[:] = x[place.states]
        place.noise[0] = EPSILON * abs(t)
        place.noise[1:] = EPSILON * np.abs(place.state) if noise is None else noise[place.states]
        self.happened.clear()
        self.happened.mode = self.modes.index(mode)
        self.happened.own = 0 if last is None else self._own(last, mode)
        self.happened.passed = 0 if last is None else self._passed(last, mode)
        self.happened.first_of_all = -1 if first is None else self._number(first)

    def _numbers(self, flow: ModeFlow) -> list[int]:
        """Which of a mode's guards the integrator looks at."""
        return [i for i in range(len(flow.guards)) if self._marks or flow.acting(i)]

    def _own(self, last: str, mode: str) -> int:
        """A bit for each guard of a mode that one named `last`, which has led into it, leaves at zero."""
        return self._bits(mode, self._system.left_at_zero(last, mode))

    def _passed(self, last: str, mode: str) -> int:
        """As `_own`, for each of these that it has passed in its own direction."""
        return self._bits(mode, self._system.passed(last, mode))

    def _bits(self, mode: str, which: Collection[str]) -> int:
        """A bit for each guard that the integrator looks at and that is one of these."""
        names = self._looked_at[mode][:MOST_BITS]
        return sum(1 << k for k, name in enumerate(names) if name in which)

    def velocity(self, transition: Transition) -> np.ndarray:
        """The field right after a transition that has happened last, shape (m,) of the target's states."""
        return self._speeds[transition.name, transition.source]

    def __call__(self, t1: float, tolerance: float) -> int:
        """Go on; the answer is one of `event_records.ARRIVED`, .."""
        return INTEGRATE(self._call.address, t1, tolerance, DOP853.error_order, DOP853.stable)
