"""The compiled walk through arcs: what it is told, in memory of its own, and what it answers."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk.flow.compiled.entry_points import Entry
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.events.guard_code import OUTPUTS
from contwalk.flow.explicit import plan, stages
from contwalk.flow.explicit.runge_kutta import Call
from contwalk.flow.hybrid import course, course_plan
from contwalk.flow.hybrid import walk_plan as told
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow
from contwalk.flow.tableaus.dop853 import DOP853
from contwalk.system import Transition

METHOD = "dop853"
ROOM = 20_000
WALK = Entry("contwalk.flow.hybrid.walk_kernel", "walk", "q", "qdddd")


def warmup() -> None:
    """Compile what does not depend on the machine, or find it compiled."""
    _ = WALK.address, stages.code(METHOD)
    course.warmup()


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
    counts : ndarray of int
        Work done, as `plan` has it.
    """

    states: np.ndarray
    state: np.ndarray
    columns: np.ndarray
    noise: np.ndarray
    counts: np.ndarray


class Walk:
    """Memory of a walk through some modes of a machine.

    Parameters
    ----------
    machine : HybridMachine
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    modes : sequence of str
        A transition that leads to another one ends the walk before its reset.
    columns : int
        Derivatives that are moved along.
    events : int
        The most events of one call.
    room : int
        The most steps of an arc.
    marks : bool
        Whether the states at the steps of an arc are kept, and steps marked in which watched guards may pass
        zero.
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
    ) -> None:
        self.machine, self.columns, self._marks = machine, columns, marks
        self.modes = list(modes)
        self.transitions = [each for mode in modes for each in machine.system.leaving(mode)]
        self._kept: list[np.ndarray] = []
        self.clock, self.happened = np.zeros(1), np.zeros(told.WORD + events, dtype=np.int64)
        self.times, self.marks = np.empty(room + 1), np.zeros(room, dtype=np.int64)
        self.shift = np.zeros(columns)
        self.places: dict[str, Place] = {}
        self.nodes: dict[str, np.ndarray] = {}
        self._calls: list[Call] = []
        self._courses: list[course.Course] = []
        self._speeds: dict[tuple[str, str], np.ndarray] = {}
        places = [self._mode(name, weights) for name in self.modes]
        transitions = [self._transition(transition) for transition in self.transitions]
        width = -(-columns // stages.WIDTH) * stages.WIDTH
        self.plan = self._integers(told.WALK_LENGTH, {
            told.MODES: self._keep(np.array(places, dtype=np.int64)),
            told.TRANSITIONS: self._keep(np.array(transitions, dtype=np.int64)),
            told.CLOCK: self._keep(self.clock),
            told.HAPPENED: self._keep(self.happened),
            told.TIMES: self._keep(self.times),
            told.MARKS: self._keep(self.marks),
            told.ROOM: room,
            told.EVENTS: events,
            told.COLUMNS: columns,
            told.WIDTH: width,
            told.COLUMN: self._keep(np.empty(len(machine.system.states))),
            told.SHIFT: self._keep(self.shift),
        })  # fmt: skip

    def _keep(self, array: np.ndarray) -> int:
        """The address of an array that lives as long as the walk."""
        self._kept.append(array)
        return array.ctypes.data

    def _integers(self, length: int, entries: dict[int, int]) -> np.ndarray:
        made = np.zeros(length, dtype=np.int64)
        for place, number in entries.items():
            made[place] = number
        return made

    def _mode(self, name: str, weights: np.ndarray) -> np.ndarray:
        flow = self.machine.mode(name)
        n, own = len(flow.states), weights[flow.states]
        moving = Call(flow.field, flow.c, METHOD, None, self.columns)
        moving.weigh(own)
        moving.give(plan.MEMORY, np.zeros(plan.MEMORY_LENGTH))
        if self.columns:
            moving.tangents(np.zeros((n, self.columns)), [-1] * self.columns)
        trial = Call(flow.field, flow.c, METHOD, None)
        noise = np.zeros(n + 1)
        columns = moving.split(moving.vectors[stages.Y])[1][:, : self.columns]
        start = course.Course(flow.field, flow.c, flow.p, {
            course_plan.STATE: moving.vectors[stages.Y].ctypes.data,
            course_plan.VELOCITY: moving.vectors[stages.FIRST].ctypes.data,
            course_plan.NOISE: noise.ctypes.data,
            course_plan.WEIGHTS: self._keep(np.ascontiguousarray(own)),
        })  # fmt: skip
        counts = moving.give(plan.COUNTS, np.zeros(plan.COUNTS_LENGTH, dtype=np.int64))
        self.places[name] = Place(flow.states, moving.vectors[stages.Y, :n], columns, noise, counts)
        if self._marks:
            nodes = self.nodes[name] = np.zeros((len(self.times), moving.length))
            moving.give(plan.NODES, nodes)
        numbers = self._numbers(flow)
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
        self._courses.append(start)
        return self._integers(told.MODE_LENGTH, {
            told.MOVING: moving.plan.ctypes.data,
            told.TRIAL: trial.plan.ctypes.data,
            told.SIZE: n,
            told.GUARDS: count,
            told.ADDRESSES: self._keep(np.array([g.address for g in guards], dtype=np.int64)),
            told.SLOPING: self._keep(np.array(sloping, dtype=np.int64)),
            told.DIRECTIONS: self._keep(np.array([g.direction for g in guards], dtype=np.int64)),
            told.LEADS: self._keep(np.array(leads, dtype=np.int64)),
            told.LEVELS: self._keep(np.array(at_entry, dtype=np.int64)),
            told.PARAMETERS: self._keep(flow.p),
            told.MEASURED: self._keep(np.zeros(OUTPUTS)),
            told.STANDING: self._keep(np.zeros(max(count, 1) * told.OF_GUARD)),
            told.NOISE: self._keep(noise),
            told.DENSE: self._keep(np.zeros(7 * n)),
            told.SPARE: self._keep(np.zeros(n)),
            told.SPEED: self._keep(np.zeros(n)),
            told.SAMPLES: self._keep(np.zeros(2 * (told.PARTS + 1))),
            told.COEFFICIENTS: self._keep(coefficients),
            told.STAGES: vectors,
            told.BETWEEN: self._keep(np.zeros((told.PARTS - 1) * 2 * n)),
            told.COURSE: start.plan.ctypes.data,
        })  # fmt: skip

    def _number(self, transition: Transition) -> int:
        """Of a transition that acts; -1 for one that is watched."""
        return -1 if transition.role == "watched" else self.transitions.index(transition)

    def _transition(self, transition: Transition) -> np.ndarray:
        if transition.role == "watched" or transition.target not in self.modes:
            return self._integers(told.TRANSITION_LENGTH, {told.TARGET: -1})
        jump, c = self.machine.jump(transition)
        n, outputs = jump.n - 1, jump.m - 1
        self._speeds[transition.name, transition.source] = speeds = np.zeros(n + outputs)
        return self._integers(told.TRANSITION_LENGTH, {
            told.JUMP: jump.rhs_jac_address,
            told.CONSTANTS: self._keep(c),
            told.ROWS: self._keep(jump.row_ptr),
            told.ENTRIES: self._keep(jump.col),
            told.TAKEN: self._keep(np.zeros(n + 1)),
            told.GIVEN: self._keep(np.zeros(jump.m + len(jump.col))),
            told.OUTPUTS: outputs,
            told.TARGET: self.modes.index(transition.target),
            told.SPEEDS: self._keep(speeds),
            told.SLOPES: self._keep(np.zeros((outputs + 1) * (n + 1))),
            told.LEAVES: self._own(transition.name, transition.target),
            told.PASSES: self._passed(transition.name, transition.target),
        })  # fmt: skip

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
        self.happened[:] = 0
        self.happened[told.MODE] = self.modes.index(mode)
        self.happened[told.OWN] = 0 if last is None else self._own(last, mode)
        self.happened[told.PASSED] = 0 if last is None else self._passed(last, mode)
        self.happened[told.FIRST_OF_ALL] = -1 if first is None else self.transitions.index(first)

    def _numbers(self, flow: ModeFlow) -> list[int]:
        """Which of a mode's guards the walk looks at."""
        return [i for i in range(len(flow.guards)) if self._marks or flow.acting(i)]

    def _own(self, last: str, mode: str) -> int:
        """A bit for each guard of a mode that one named `last`, which has led into it, leaves at zero."""
        return self._bits(mode, self.machine.system.left_at_zero(last, mode))

    def _passed(self, last: str, mode: str) -> int:
        """As `_own`, for each of these that it has passed in its own direction."""
        return self._bits(mode, self.machine.system.passed(last, mode))

    def _bits(self, mode: str, which: Collection[str]) -> int:
        """A bit for each guard that the walk looks at and that is one of these."""
        flow = self.machine.mode(mode)
        names = [flow.transitions[i].name for i in self._numbers(flow)]
        return sum(1 << k for k, name in enumerate(names[: told.MOST_BITS]) if name in which)

    def velocity(self, transition: Transition) -> np.ndarray:
        """The field right after a transition that has happened last."""
        jump = self.machine.jump(transition)[0]
        return self._speeds[transition.name, transition.source][jump.n - 1 :]

    def __call__(self, t1: float, tolerance: float) -> int:
        """Walk on; the answer is one of `hybrid_plan.ARRIVED`, .."""
        return WALK(self.plan.ctypes.data, t1, tolerance, DOP853.error_order, DOP853.stable)
