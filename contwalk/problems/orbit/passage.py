"""One kind of leg, compiled, with what is watched on it: guards with their rates, and conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.fields.derivative import directional
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import may_jump
from contwalk.fields.trace import Tracer, trace
from contwalk.flow import Field
from contwalk.flow.events.guard_derivatives import MOST_NODES
from contwalk.memory import memory_of, remembered
from contwalk.problems.orbit.compiled_leg import CompiledLeg
from contwalk.problems.orbit.itinerary import Leg
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.traced_leg import NOTHING_MORE, ONE_PERIOD, Closing, Scalar, ScalarInputs
from contwalk.problems.orbit.watched_numbers import Watched
from contwalk.system import Condition, System, Transition


class Passage(CompiledLeg):
    """A leg of one mode, ended by one transition, and what is watched on it: see `TracedLeg`."""

    def watched(self, name: str, function: Scalar) -> Watched:
        """A scalar along the leg, with its rate over the leg's own time, T dh/dt."""
        key = "watched", name, True
        if key not in self._fields:
            self._fields[key] = self._watching([function])
        return self._fields[key]

    def _watching(self, functions: Sequence[Scalar]) -> Watched:
        """Scalars along the leg, each with its rate, as maps of the states and their rates."""
        copies, n = [rebound(function) for function in functions], len(self.states)
        program = trace(lambda tracer: [copy(*self._arguments(tracer)) for copy in copies])
        if not self.forced:
            self.refuse_time(program)
        graph = program.graph
        inputs = [graph.input("u", k) for k in range(n)]
        moving = {graph.input("t", 0): graph.one}
        moving |= {node: graph.input("r", k) for k, node in enumerate(inputs)}

        def measured(outputs: tuple[int, ...]) -> list[int]:
            changes = directional(graph, list(outputs), moving)
            return [node for pair in zip(outputs, changes, strict=True) for node in pair]

        states = [(group, k) for group in ("u", "r") for k in range(n)]
        map_ = Field(
            program.transformed(measured),
            states,
            self.groups,
            self.columns,
            time=("t", 0),
            outputs=2 * len(copies),
        )
        return Watched(lambda: self.field(PLAIN), len(self.columns), map_, may_jump(program))

    @cached_property
    def guards_jump(self) -> bool:
        """Whether a guard out of the mode may jump."""
        try:
            return self.guards().jumps
        except UnsupportedOperation:  # together they compare too often; each is looked at by itself
            return True

    @cached_property
    def leaving(self) -> tuple[Transition, ...]:
        """The transitions out of the leg's mode, watched ones included."""
        return self.system.leaving(self.leg.mode)

    def of_time_alone(self, transition: Transition) -> bool:
        """Whether a guard reads no state: a clock, a sampling instant."""
        key = "of time alone", transition.name, True
        if key not in self._fields:
            copy = rebound(transition.guard)
            self._fields[key] = not trace(lambda tracer: [copy(*self._arguments(tracer))]).reads("u")
        return bool(self._fields[key])

    def guards(self) -> Watched:
        """The guards of `leaving`, each with its rate as `watched` has it, evaluated together.

        Raises
        ------
        UnsupportedOperation
            If together they compare the state in too many ways.
        """
        key = "guards", True
        if key not in self._fields:
            self._fields[key] = self._watching([transition.guard for transition in self.leaving])
        return self._fields[key]

    def guard_derivative(self, transition: Transition, order: int) -> Field:
        """A derivative of a guard over the leg's own time along the motion, of an order from one, as a map.

        Raises
        ------
        UnsupportedOperation
            If its graph is larger than MOST_NODES.
        """
        key = "guard derivative", transition.name, order, True
        if key not in self._fields:
            copy = rebound(transition.guard)
            program = trace(lambda tracer: [copy(*self._arguments(tracer)), *self._rates(tracer)])
            graph = program.graph

            def derivative(outputs: tuple[int, ...]) -> list[int]:
                value, *rates = outputs
                inputs = [graph.input("u", k) for k in range(len(self.states))]
                moving = {graph.input("t", 0): graph.one, **dict(zip(inputs, rates, strict=True))}
                for _ in range(order):
                    if len(graph.nodes) > MOST_NODES:
                        raise UnsupportedOperation(
                            f"Derivative {order} of '{transition.name}' by time is too large.",
                            "Shorten the field or the guard.",
                        )
                    (value,) = directional(graph, [value], moving)
                return [value]

            self._compiled(key, program.transformed(derivative), PLAIN, 1)
        return self._fields[key]

    @cached_property
    def conditions(self) -> tuple[Condition, ...]:
        """The conditions at the leg's transition."""
        return tuple(c for c in self.system.conditions if c.at == self.leg.name)

    def conditioned(self) -> Field:
        """All conditions at the leg's transition, as a map of the state before it.

        Raises
        ------
        UnsupportedOperation
            If together they compare the state in too many ways.
        """
        key = "conditions", True
        if key not in self._fields:
            copies = [(rebound(c.function), c.side) for c in self.conditions]

            def all_of(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                after = self._full_after(tracer) if any(side == "after" for _, side in copies) else x
                return [copy(t, after if side == "after" else x, p) for copy, side in copies]

            self._compiled(key, trace(all_of), PLAIN, len(copies))
        return self._fields[key]

    def condition(self, condition: Condition) -> Field:
        """One condition at the leg's transition, as a map of the state before it."""
        key = "condition", condition.name, True
        if key not in self._fields:
            copy, after = rebound(condition.function), condition.side == "after"

            def value(tracer: Tracer) -> list[Any]:
                t, x, p = self._arguments(tracer)
                return [copy(t, self._full_after(tracer) if after else x, p)]

            self._compiled(key, trace(value), PLAIN, 1)
        return self._fields[key]


# Passages of one system that are kept.
_MOST_KNOWN = 256


def passage_of(
    system: System,
    leg: Leg,
    target: str,
    inputs: ScalarInputs,
    closing: Closing = NOTHING_MORE,
    holding: bool = True,
) -> Passage:
    """As `Passage(...)`, traced and compiled only once for the same arguments."""
    given = leg, target, inputs, closing, holding
    known = memory_of(system, "passages")
    found: Passage = remembered(known, given, _MOST_KNOWN, lambda: Passage(system, *given))
    return found


def closure_of(
    system: System, inputs: ScalarInputs, closing: Closing = ONE_PERIOD, holding: bool = True, mode: str = ""
) -> Passage:
    """The one leg of orbits without events, in the first mode by default: of a forced system, over so many
    periods of the force.
    """
    mode = mode or system.modes[0].name
    closing = closing if system.period is not None else replace(closing, periods=None)
    return passage_of(system, Leg(mode), mode, inputs, closing, holding)
