"""The compiled walk through arcs: what it is told, in memory of its own, and what it answers."""

from __future__ import annotations

import numpy as np

from contwalk.flow import hybrid_plan as told
from contwalk.flow import plan, stages
from contwalk.flow.compiled import Entry
from contwalk.flow.explicit import _Call as Call
from contwalk.flow.guard import EPSILON
from contwalk.flow.hybrid_machine import HybridMachine
from contwalk.flow.tableaus.dop853 import DOP853

METHOD = "dop853"
ROOM = 20_000
_PARTS = ("hybrid_plan", "guard_kernel", "explicit_drivers", "plan", "stages")
_NAMES = tuple(f"contwalk.flow.{name}" for name in _PARTS)
WALK = Entry("contwalk.flow.hybrid_kernel", "walk", "q", "qdddd", _NAMES)


def warmup() -> None:
    """Compile what does not depend on the machine, or find it compiled."""
    _ = WALK.address, stages.code(METHOD)


class Walk:
    """Memory of a walk through some modes of a machine.

    Parameters
    ----------
    machine : HybridMachine
    weights : ndarray, shape (n,)
        Typical magnitudes of the states, of full length.
    columns : int
        Derivatives that are moved along.
    events : int
        The most events of one call.
    """

    def __init__(self, machine: HybridMachine, weights: np.ndarray, columns: int, events: int) -> None:
        self.machine, self.columns = machine, columns
        self.modes = [mode.name for mode in machine.system.modes]
        self.transitions = [transition.name for transition in machine.system.transitions]
        self._kept: list[np.ndarray] = []
        self.clock, self.happened = np.zeros(1), np.zeros(told.WORD + events, dtype=np.int64)
        self.times, self.shift = np.empty(ROOM + 1), np.zeros(columns)
        self._moving: dict[str, Call] = {}
        self._trial: list[Call] = []
        self._noise: dict[str, np.ndarray] = {}
        self._speeds: dict[str, np.ndarray] = {}
        modes = [self._mode(name, weights) for name in self.modes]
        transitions = [self._transition(name) for name in self.transitions]
        width = -(-columns // stages.WIDTH) * stages.WIDTH
        self.plan = self._integers(told.WALK_LENGTH, {
            told.MODES: self._keep(np.array(modes, dtype=np.int64)),
            told.TRANSITIONS: self._keep(np.array(transitions, dtype=np.int64)),
            told.CLOCK: self._keep(self.clock),
            told.HAPPENED: self._keep(self.happened),
            told.TIMES: self._keep(self.times),
            told.ROOM: ROOM,
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
        moving.give(plan.COUNTS, np.zeros(plan.COUNTS_LENGTH, dtype=np.int64))
        if self.columns:
            moving.tangents(np.zeros((n, self.columns)), [-1] * self.columns)
        trial = Call(flow.field, flow.c, METHOD, None)
        self._moving[name], self._noise[name] = moving, np.zeros(n + 1)
        acting = [i for i in range(len(flow.guards)) if flow.acting(i)]
        guards = [flow.guards[i] for i in acting]
        leads = [self.transitions.index(flow.transitions[i].name) for i in acting]
        count, vectors = len(guards), stages.vectors(DOP853) - stages.FIRST
        coefficients = np.zeros((4, vectors))
        for row, terms in enumerate(DOP853.dense):
            for stage, value in terms.items():
                coefficients[row, stage] = value
        self._trial.append(trial)
        return self._integers(told.MODE_LENGTH, {
            told.MOVING: moving.plan.ctypes.data,
            told.TRIAL: trial.plan.ctypes.data,
            told.SIZE: n,
            told.GUARDS: count,
            told.ADDRESSES: self._keep(np.array([g.address for g in guards], dtype=np.int64)),
            told.DEPARTURES: self._keep(np.array([g.departure_address for g in guards], dtype=np.int64)),
            told.DIRECTIONS: self._keep(np.array([g.direction for g in guards], dtype=np.int64)),
            told.LEADS: self._keep(np.array(leads, dtype=np.int64)),
            told.PARAMETERS: self._keep(flow.p),
            told.MEASURED: self._keep(np.zeros(9)),
            told.STANDING: self._keep(np.zeros(max(count, 1) * told.OF_GUARD)),
            told.NOISE: self._keep(self._noise[name]),
            told.DENSE: self._keep(np.zeros(7 * n)),
            told.SPARE: self._keep(np.zeros(n)),
            told.SAMPLES: self._keep(np.zeros(40)),
            told.COEFFICIENTS: self._keep(coefficients),
            told.STAGES: vectors,
        })  # fmt: skip

    def _transition(self, name: str) -> np.ndarray:
        transition = self.machine.transition(name)
        if transition.role == "watched":
            return np.zeros(told.TRANSITION_LENGTH, dtype=np.int64)
        jump, c = self.machine.jump(name)
        n, outputs = jump.n - 1, jump.m - 1
        self._speeds[name] = speeds = np.zeros(n + outputs)
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
        })  # fmt: skip

    def begin(self, t: float, x: np.ndarray, mode: str, last: str | None, first: str | None = None) -> None:
        """Put a full-length state in place, right after `last`, or right before `first`."""
        states = self.machine.mode(mode).states
        own = x[states]
        self.clock[0] = t
        self._moving[mode].vectors[stages.Y, : len(states)] = own
        noise = self._noise[mode]
        noise[0], noise[1:] = EPSILON * abs(t), EPSILON * np.abs(own)
        self.happened[:] = 0
        self.happened[told.MODE] = self.modes.index(mode)
        for place, name in ((told.LAST, last), (told.FIRST_OF_ALL, first)):
            self.happened[place] = -1 if name is None else self.transitions.index(name)

    def derivatives(self, mode: str) -> np.ndarray:
        """The columns of a mode, shape (states, columns): a view."""
        moving = self._moving[mode]
        return moving.split(moving.vectors[stages.Y])[1][:, : self.columns]

    def state(self, mode: str) -> np.ndarray:
        """The states of a mode: a view."""
        return self._moving[mode].vectors[stages.Y, : len(self.machine.mode(mode).states)]

    def velocity(self, transition: str) -> np.ndarray:
        """The field right after a transition that has happened last."""
        jump = self.machine.jump(transition)[0]
        return self._speeds[transition][jump.n - 1 :]

    def __call__(self, t1: float, tolerance: float) -> int:
        """Walk on; the answer is one of `hybrid_plan.ARRIVED`, .."""
        return WALK(self.plan.ctypes.data, t1, tolerance, DOP853.error_order, DOP853.stable)
