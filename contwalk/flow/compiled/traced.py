"""The functions of a plugin as programs in the inputs t, x, p."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from contwalk.errors import SystemDefinitionError
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow.compiled.compiled_field import CompiledField
from contwalk.flow.compiled.field import Field
from contwalk.flow.compiled.restricted import Restricted
from contwalk.memory import memory_of, remembered
from contwalk.system import Mode, Neutral, System
from contwalk.system.declarations import ParameterValues

TIME, STATE, PARAMETER, CONSTANT = "t", "x", "p", "m"

# What is remembered of one system, or of one mode, at most.
_MOST_KEPT = 32


def field_of(system: System, mode: str | None = None) -> CompiledField:
    """The compiled field of a mode, the first one by default, in the states that exist there."""
    chosen = system.mode(mode or system.modes[0].name)
    states = [(STATE, i) for i in system.states_of(chosen.name)]
    groups = {PARAMETER: len(system.parameters)}
    if chosen.constants:
        return Restricted(
            _shared_field(system, chosen), [i for _, i in states], list(chosen.constants.values())
        )
    return Field(field_program(system, chosen.name), states, groups, time=(TIME, 0))


def conserved_map(system: System, mode: str) -> Field:
    """The conserved quantities as a map of the states that exist in a mode, compiled."""

    def made() -> Field:
        states, copies = system.states_of(mode), [rebound(entry.of(mode)) for entry in system.conserved]
        program = trace(lambda tracer: [copy(*arguments(tracer, system, mode)) for copy in copies])
        groups = {PARAMETER: len(system.parameters)}
        inputs = [(STATE, i) for i in states]
        return Field(program, inputs, groups, time=(TIME, 0), outputs=len(copies))

    found: Field = remembered(memory_of(system, "conserved"), mode, _MOST_KEPT, made)
    return found


def generator_field(system: System, neutral: Neutral, mode: str) -> Field:
    """A neutral direction in the states that exist in a mode, compiled."""

    def made() -> Field:
        states, copy = system.states_of(mode), rebound(neutral.generator)

        def along(tracer: Tracer) -> list[Any]:
            v = np.full(len(system.states), 0.0, dtype=object)
            copy(*arguments(tracer, system, mode), v)
            return [v[i] for i in states]

        groups = {PARAMETER: len(system.parameters)}
        return Field(trace(along), [(STATE, i) for i in states], groups, time=(TIME, 0))

    found: Field = remembered(memory_of(system, "generators"), (neutral.name, mode), _MOST_KEPT, made)
    return found


def _shared_field(system: System, mode: Mode) -> Field:
    """The field of all modes with the function and the names of constants of this one.

    Machines that differ in their transitions only have the same modes, and share it.
    """
    names = tuple(mode.constants), system.state_names, system.parameter_names
    first = next(each for each in system.modes if each.field is mode.field)

    def made() -> Field:
        states = [(STATE, i) for i in range(len(system.states))]
        groups = {CONSTANT: len(mode.constants), PARAMETER: len(system.parameters)}
        return Field(shared_program(system, mode), states, groups, time=(TIME, 0))

    found: Field = remembered(memory_of(first, "fields"), names, _MOST_KEPT, made)
    return found


def shared_program(system: System, mode: Mode) -> Program:
    """dx/dt of a mode as if all states existed, its constants among the inputs; 0 for what is not written."""
    copy = rebound(mode.field)

    def whole(tracer: Tracer) -> list[Any]:
        n = len(system.states)
        x = np.array([tracer.symbol(STATE, i) for i in range(n)], dtype=object)
        constants = {name: tracer.symbol(CONSTANT, k) for k, name in enumerate(mode.constants)}
        dx = np.full(n, 0.0, dtype=object)
        copy(tracer.symbol(TIME, 0), x, _parameters(tracer, system, constants), dx)
        return list(dx)

    return trace(whole)


def field_program(system: System, mode: str | None = None) -> Program:
    """dx/dt of a mode, an output for each state that exists in it."""
    chosen = system.mode(mode or system.modes[0].name)
    copy = rebound(chosen.field)
    return trace(lambda tracer: rates(tracer, system, copy, chosen.name))


def arguments(tracer: Tracer, system: System, mode: str) -> tuple[Any, np.ndarray, ParameterValues]:
    """Symbols for t, x, shape (n,), and p; states that are not in the mode are zero, constants numbers."""
    x = np.full(len(system.states), 0.0, dtype=object)
    for i in system.states_of(mode):
        x[i] = tracer.symbol(STATE, i)
    return tracer.symbol(TIME, 0), x, _parameters(tracer, system, system.mode(mode).constants)


def _parameters(tracer: Tracer, system: System, constants: Mapping[str, Any]) -> ParameterValues:
    p = {name: tracer.symbol(PARAMETER, k) for k, name in enumerate(system.parameter_names)}
    return ParameterValues(**p, **constants)


def rates(tracer: Tracer, system: System, field: Callable[..., Any], name: str) -> list[Any]:
    """What a field (made ready for symbols) writes for the states that exist in the mode."""
    dx = np.full(len(system.states), None, dtype=object)
    field(*arguments(tracer, system, name), dx)
    for i in system.states_of(name):
        if dx[i] is None:
            raise SystemDefinitionError(
                f"The field of mode '{name}' does not write dx[{i}] (state {system.state_names[i]}).",
                "A field writes the rate of every state that exists in its mode.",
            )
    return [dx[i] for i in system.states_of(name)]
