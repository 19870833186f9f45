"""What is compiled of a hybrid system, for all its parameters: fields, guards, maps of transitions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.derivative import ancestors
from contwalk.fields.kernel import refuse_raising
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import choices_of
from contwalk.fields.trace import Outputs, Program, Tracer, trace
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments, field_of, field_program
from contwalk.flow.events.guard import Guard
from contwalk.flow.events.guard_code import GuardCode, GuardCodes
from contwalk.flow.events.guard_derivatives import Derivatives
from contwalk.flow.events.jump_instants import TimeChoices
from contwalk.flow.events.resolving import Resolving
from contwalk.memory import memory_of, remembered
from contwalk.system import System, Transition

_UNWRITTEN = "unwritten"


class ModeCode:
    """The field of one mode, and the guards of the transitions out of it.

    Attributes
    ----------
    states : ndarray of int
        Positions of the states that exist in it.
    transitions : tuple of Transition
        Those out of it, watched ones included, in the order of their declaration.
    guards : tuple of Guard
        Theirs.
    field : CompiledField
        dx/dt of the states that exist.
    """

    def __init__(self, system: System, name: str, codes: GuardCodes) -> None:
        self.system, self.name = system, name
        self.states = np.array(system.states_of(name), dtype=int)
        self.transitions = system.leaving(name)
        self.field = field_of(system, name)
        self.guards = tuple(self._guard(t, codes(t.guard, name)) for t in self.transitions)
        self._derivatives: dict[int, Derivatives] = {}

    def _guard(self, of: Transition, code: GuardCode) -> Guard:
        return Guard(self.system, of.name, of.guard, of.direction, self.name, code=code, field=self.field)

    def derivatives(self, number: int) -> Derivatives:
        """Higher derivatives of a guard by time, traced when they are first asked for."""
        if number not in self._derivatives:
            guard = self.transitions[number].guard
            self._derivatives[number] = Derivatives(self.system, guard, self.name)
        return self._derivatives[number]

    @cached_property
    def chooses(self) -> bool:
        """Whether the field, or a guard, is smooth by pieces only."""
        programs = [field_program(self.system, self.name), *(guard.code.program for guard in self.guards)]
        return any(choices_of(program) for program in programs)

    @cached_property
    def time_choices(self) -> TimeChoices:
        """What of the guards changes with the time alone."""
        return TimeChoices([guard.code.program for guard in self.guards])

    @cached_property
    def resolving(self) -> Resolving:
        """The field with the guards as further states: control of their errors resolves them too."""
        return Resolving(self.field, [guard.code for guard in self.guards])


class HybridCode:
    """Everything of a system, compiled when it is first used."""

    def __init__(self, system: System) -> None:
        self.system = system
        self._guards = GuardCodes(system)
        self._modes: dict[str, ModeCode] = {}
        self._jumps: dict[tuple[str, str], Field] = {}

    def mode(self, name: str) -> ModeCode:
        """A mode by its name."""
        if name not in self._modes:
            self._modes[name] = ModeCode(self.system, name, self._guards)
        return self._modes[name]

    def jump(self, transition: Transition) -> Field:
        """Reset, then relabelling: from (t, x) in the source's states to the target's, and the guard last."""
        key = transition.name, transition.source
        if key not in self._jumps:
            program = _jump_program(self.system, transition)
            self._jumps[key] = _of_time_and_state(self.system, transition.source, program)
        return self._jumps[key]


def hybrid_code(system: System) -> HybridCode:
    """The code of a system; traced and compiled only once."""
    return remembered(memory_of(system, "hybrid code"), None, 1, lambda: HybridCode(system))


# -- tracing -------------------------------------------------------------------------------------------------


def _of_time_and_state(system: System, mode: str, program: Program) -> Field:
    """A program as a map whose first input is the time, and whose others are the states of a mode."""
    refuse_raising(program)
    outputs = max(len(leaf.nodes) for leaf in program.leaves() if isinstance(leaf, Outputs))
    states = [(TIME, 0), *((STATE, i) for i in system.states_of(mode))]
    return Field(program, states, {PARAMETER: len(system.parameters)}, outputs=outputs)


def _jump_program(system: System, transition: Transition) -> Program:
    """The states of the target after reset and relabelling, and the guard before them."""
    guard = rebound(transition.guard)
    reset = None if transition.reset is None else rebound(transition.reset)
    relabel = next((rebound(s.map) for s in system.symmetries if s.name == transition.relabel), None)

    def after(tracer: Tracer) -> list[Any]:
        t, x, p = arguments(tracer, system, transition.source)
        value = guard(t, x, p)
        if reset is not None:
            x = _written(tracer, reset, t, x, p)
        if relabel is not None:
            x = _written(tracer, relabel, t, x, p)
        return [*(x[i] for i in system.states_of(transition.target)), value]

    program = trace(after)
    _refuse_unwritten(system, transition, program)
    return program


def _written(tracer: Tracer, function: Callable[..., Any], t: Any, x: np.ndarray, p: Any) -> np.ndarray:
    """What a reset or a map writes; symbols of their own stand for what it does not write."""
    result = np.full(len(x), None, dtype=object)
    function(t, x, p, result)
    for i in range(len(x)):
        if result[i] is None:
            result[i] = tracer.symbol(_UNWRITTEN, i)
    return result


def _refuse_unwritten(system: System, transition: Transition, program: Program) -> None:
    """Raise where states of the target depend on what the reset does not write."""
    outputs: Sequence[int] = [
        node for leaf in program.leaves() if isinstance(leaf, Outputs) for node in leaf.nodes
    ]
    keys = [program.graph.nodes[node] for node in ancestors(program.graph, outputs)]
    missing = sorted({key[2] for key in keys if key[0] == "input" and key[1] == _UNWRITTEN})
    if missing:
        names = ", ".join(f"x_plus[{i}] (state {system.state_names[i]})" for i in missing)
        raise SystemDefinitionError(
            f"The reset of transition '{transition.name}' does not write {names}, "
            f"which mode '{transition.target}' begins with.",
            "A reset writes every state that exists in the mode it leads to.",
        )
