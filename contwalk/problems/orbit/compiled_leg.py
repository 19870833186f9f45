"""One kind of leg compiled: its field and the map at its end, as `PLAIN` and lifted (see `lifts`).

Modes that differ by constants and by what exists share one compiled field.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import UnsupportedOperation
from contwalk.fields.blame import first_switched
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow import CompiledField, Field, Restricted
from contwalk.memory import memory_of, remembered
from contwalk.problems.forcing import period_at
from contwalk.problems.kinks import Course, Place, inputs
from contwalk.problems.orbit.lifts import DIRECTIONS, PLAIN, STATES, TANGENT, lifted
from contwalk.problems.orbit.traced_leg import Scalar, TracedLeg

At = Callable[[np.ndarray], np.ndarray]
ORDERS = {"plain": 1, "tangent": 2, "mixed": 4, "jet": 4}


class CompiledLeg(TracedLeg):
    """A leg of one mode, ended by one transition, compiled when it is first used: see `TracedLeg`."""

    @cached_property
    def _fields(self) -> dict[tuple, Any]:
        return {}

    @cached_property
    def _switching(self) -> dict[tuple[str, str], Switching | None]:
        return {}

    @cached_property
    def _lines(self) -> dict[bytes, str]:
        return {}

    @cached_property
    def _own(self) -> np.ndarray:
        return np.array(self.states, dtype=int)

    @cached_property
    def _every(self) -> bool:
        """Whether all states exist in its mode, in their own order."""
        return list(self.states) == list(range(len(self.system.states)))

    def _compiled(self, key: tuple, program: Program, lift: str, outputs: int | None) -> Field:
        if key not in self._fields:
            states = [(group, i) for group in STATES[lift] for i in range(len(self.states))]
            groups = {**self.groups, **{group: len(self.columns) for group in DIRECTIONS[lift]}}
            if not self.forced:
                self.refuse_time(program)
            made = lifted(program, len(self.states), self.columns, lift)
            self._fields[key] = Field(
                made, states, groups, self.columns, time=("t", 0), differentiable=key[-1], outputs=outputs
            )
        return self._fields[key]

    def field(self, lift: str, implicit: bool = False) -> CompiledField:
        """The compiled field of a lift; an implicit method needs the Jacobian of any."""
        key = "field", lift, implicit or lift in (PLAIN, TANGENT)
        if key in self._fields:
            known: CompiledField = self._fields[key]
            return known
        constants = self.system.mode(self.leg.mode).constants
        if not constants:
            return self._compiled(key, self.program, lift, None)
        n = len(self.system.states)
        places = [n * group + i for group in range(len(STATES[lift])) for i in self.states]
        restricted = Restricted(self._shared.field(lift, key[-1]), places, list(constants.values()))
        self._fields[key] = restricted
        return restricted

    @cached_property
    def _shared(self) -> SharedField:
        """What the modes of this one's field have in common."""
        mode = self.system.mode(self.leg.mode)
        kept = tuple(quantity.of(mode.name) for quantity in self.system.conserved)
        kind = self.inputs, self.closing.periods, self.holding
        key, known = (mode.field, tuple(mode.constants), kept, *kind), memory_of(self.system, "shared fields")
        found: SharedField = remembered(known, key, _MOST_SHARED, lambda: SharedField(self))
        return found

    def end(self, lift: str) -> Field:
        """The map at the end: state after the transition, and the guard; of a lift, each with its
        derivatives.

        Outputs come order by order: (x+, h), then their first derivatives, and so on.
        """
        width = len(self.following) + (self.leg.transition is not None)
        return self._compiled(("end", lift, True), self.end_program, lift, ORDERS[lift] * width)

    def full(self, x: np.ndarray) -> np.ndarray:
        """States of the mode (k, n_i) or (n_i,) as states of the system; those that do not exist are zero.

        Shape (n_i,) or (k, n_i), and (n,) or (k, n).
        """
        if self._every:
            return np.array(x, dtype=float)
        result = np.zeros((*x.shape[:-1], len(self.system.states)))
        result[..., self._own] = x
        return result

    def parameters(self, values: np.ndarray) -> dict[str, float]:
        """The system's parameters by name, from scalars and fixed parameters."""
        given = inputs(self.groups, values, np.zeros(1), np.zeros((1, 0)))
        lam, names = given["l", 0], self.system.parameter_names
        known = {name: given["b", k] + lam * given["d", k] for k, name in enumerate(names)}
        return known if self.inputs.free is None else known | {self.inputs.free: lam}

    def clock(self, values: np.ndarray) -> tuple[float, float]:
        """The time at which it starts, and how long it lasts, from scalars and fixed parameters."""
        given = inputs(self.groups, values, np.zeros(1), np.zeros((1, 0)))
        if self.closing.periods is None:
            return given.get(("s", 0), 0.0), given["T", 0]
        return given.get(("s", 0), 0.0), self.closing.periods * period_at(
            self.system, self.parameters(values)
        )

    @cached_property
    def switching(self) -> Switching | None:
        """Where the field is smooth by pieces only; None where it is smooth."""
        shared = self._shared.program if self.system.mode(self.leg.mode).constants else self.program
        if not choices_of(shared):
            return None
        unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
        return Switching(self.program, unknowns, ("t", 0)) if choices_of(self.program) else None

    @cached_property
    def end_switching(self) -> Switching | None:
        """Where the map at the end is smooth by pieces only; None where it is smooth."""
        unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
        return Switching(self.end_program, unknowns, ("t", 0)) if choices_of(self.end_program) else None

    def switching_of(self, name: str, function: Scalar, side: str = "before") -> Switching | None:
        """Where a number on the leg, or after the transition at its end, is smooth by pieces only.

        None where it is smooth, or compares in too many ways.
        """
        key = name, side
        if key not in self._switching:
            copy = rebound(function)

            def value(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                return [copy(t, self._full_after(tracer) if side == "after" else x, p)]

            unknowns = [*[("u", k) for k in range(len(self.states))], *self.columns]
            try:
                program = trace(value)
            except UnsupportedOperation:
                self._switching[key] = None
            else:
                chooses = choices_of(program)
                self._switching[key] = Switching(program, unknowns, ("t", 0)) if chooses else None
        return self._switching[key]

    def course(
        self, values: np.ndarray, times: np.ndarray, states: np.ndarray, at: At | None = None
    ) -> Course | None:
        """A motion over it as it is looked at for kinks of the field; None where it has none.

        Parameters
        ----------
        values : ndarray
            Scalars and fixed parameters.
        times, states : ndarray, shapes (k,) and (k, n_i)
        at : callable, optional
            States at any times.
        """
        if self.switching is None:
            return None
        mode, known = self.system.mode(self.leg.mode), self.parameters(values)
        start, lasting = self.clock(values)

        def where(before: Place, after: Place, /, parameters: Any = None) -> str:
            places = [(start + lasting * t, self.full(x).tolist()) for t, x in (before, after)]
            then = [{**values, **mode.constants} for values in parameters or (known, known)]
            return first_switched(mode.field, places[0], places[1], then[0], then[1])

        def evaluate(times: np.ndarray, states: np.ndarray) -> Inputs:
            return inputs(self.groups, values, times, states)

        ends = self.leg.transition is not None
        return Course(self.switching, evaluate, times, states, at or _nowhere, where, ends, self._lines)


def _nowhere(times: np.ndarray) -> np.ndarray:
    raise ValueError("the motion is known at its own times only")


class SharedField:
    """The field over a leg, compiled once for all modes that differ by constants and by what exists."""

    def __init__(self, one: TracedLeg) -> None:
        self._one, self.program = one, one.whole_program()
        self._constants = len(one.system.mode(one.leg.mode).constants)
        self._fields: dict[tuple[str, bool], Field] = {}
        if not one.forced:
            one.refuse_time(self.program)

    def field(self, lift: str, differentiable: bool) -> Field:
        """Of a lift, with all states; its first parameters are the constants of the mode."""
        key = lift, differentiable
        if key not in self._fields:
            one, n = self._one, len(self._one.system.states)
            groups = {"m": self._constants, **one.groups}
            groups |= {group: len(one.columns) for group in DIRECTIONS[lift]}
            self._fields[key] = Field(
                lifted(self.program, n, one.columns, lift),
                [(group, i) for group in STATES[lift] for i in range(n)],
                groups,
                one.columns,
                time=("t", 0),
                differentiable=differentiable,
            )
        return self._fields[key]


# Fields of one system, each shared by several modes, that are kept.
_MOST_SHARED = 64
