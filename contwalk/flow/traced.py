"""The functions of a plugin as programs in the inputs t, x, p."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow.field import Field
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

TIME, STATE, PARAMETER = "t", "x", "p"


def field_of(system: System, mode: str | None = None) -> Field:
    """The compiled field of a mode, the first one by default, in the states that exist there."""
    states = [(STATE, i) for i in system.states_of(mode or system.modes[0].name)]
    groups = {PARAMETER: len(system.parameters)}
    return Field(field_program(system, mode), states, groups, time=(TIME, 0))


def field_program(system: System, mode: str | None = None) -> Program:
    """dx/dt of a mode, an output for each state that exists in it."""
    chosen = next(m for m in system.modes if mode in (None, m.name))
    copy = rebound(chosen.field)
    return trace(lambda tracer: rates(tracer, system, copy, chosen.name))


def scalar_program(
    system: System, function: Callable[[Any, Any, Any], Any], mode: str | None = None
) -> Program:
    """A number h(t, x, p), traced together with the field of a mode: outputs h, then dx/dt."""
    chosen = next(m for m in system.modes if mode in (None, m.name))
    copies = rebound(function), rebound(chosen.field)

    def both(tracer: Tracer) -> list[Any]:
        value = copies[0](*arguments(tracer, system, chosen.name))
        return [value, *rates(tracer, system, copies[1], chosen.name)]

    return trace(both)


def arguments(tracer: Tracer, system: System, mode: str) -> tuple[Any, np.ndarray, ParameterValues]:
    """Symbols for t, x and p; states that do not exist in the mode are zero."""
    x = np.full(len(system.states), 0.0, dtype=object)
    for i in system.states_of(mode):
        x[i] = tracer.symbol(STATE, i)
    p = {name: tracer.symbol(PARAMETER, k) for k, name in enumerate(system.parameter_names)}
    return tracer.symbol(TIME, 0), x, ParameterValues(**p)


def rates(tracer: Tracer, system: System, field: Callable[..., Any], name: str) -> list[Any]:
    """What a field (made ready for symbols) writes for the states that exist in the mode."""
    dx = np.full(len(system.states), None, dtype=object)
    field(*arguments(tracer, system, name), dx)
    for i in system.states_of(name):
        if dx[i] is None:
            raise ValueError(f"'{name}' does not write entry {i} of its last argument")
    return [dx[i] for i in system.states_of(name)]
