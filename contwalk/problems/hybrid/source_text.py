"""The traced equations of a hybrid system as text: what decides a branch, for provenance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from contwalk.fields.codegen import source
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.flow.compiled.traced import CONSTANT, TIME, arguments, field_program, shared_program
from contwalk.problems.orbit.itinerary import Leg
from contwalk.problems.orbit.passage import passage_of
from contwalk.problems.orbit.traced_leg import TIME as OF_LEG
from contwalk.problems.orbit.traced_leg import ScalarInputs
from contwalk.problems.tracing import (
    parameter_symbols,
    refuse_time,
    refuse_time_of,
    state_symbols,
    time_refused,
)
from contwalk.system import Mode, System, Transition
from contwalk.system.declarations import ParameterValues

_INPUTS = ("u", "T", "s", "a", "l", "b", "d", "t", "x", "p", "m")


def equations_text(system: System, free: str | None) -> str:
    """Fields, guards, resets, conditions and the period, each function traced once.

    Raises
    ------
    UnsupportedOperation, SystemDefinitionError
        With the line of the plugin.
    """
    modes = {mode.code: mode for mode in system.modes}
    programs = [_field(system, mode) for mode in modes.values()]
    transitions = {_functions_of(system, transition): transition for transition in system.transitions}
    for one, program in zip(modes.values(), programs, strict=True):
        _refuse_time(system, [program], one.field, f"field of mode '{one.name}'")
    for transition in transitions.values():
        found = _transition(system, transition, free)
        _refuse_clock(system, found, transition)
        programs += found
    for condition in system.conditions:
        mode, copy = system.sources(condition.at)[0], rebound(condition.function)

        def value(tracer: Tracer, mode: str = mode, copy: Any = copy) -> list[Any]:
            return [copy(*arguments(tracer, system, mode))]

        programs.append(trace(value))
    if system.period is not None:
        period = rebound(system.period)
        programs.append(trace(lambda t: [period(parameter_symbols(t, system.parameter_names, free, ()))]))
    texts = [source(program, _INPUTS) for program in programs]
    return "\n".join([*texts, *_tables(system)])


def _refuse_time(
    system: System, programs: Sequence[Program], function: Callable[..., Any], what: str
) -> None:
    if system.period is None and any(program.reads(TIME) for program in programs):
        raise time_refused(system, function, what)


def _refuse_clock(system: System, programs: Sequence[Program], transition: Transition) -> None:
    """Refuse a guard or a reset that depends on time in a system that has no period."""
    if system.period is not None or not any(
        program.reads(time) for program in programs for time in (TIME, OF_LEG)
    ):
        return
    refuse_time_of(system, transition.source, transition.guard, f"guard of transition '{transition.name}'")
    if transition.reset is not None:
        what = f"reset of transition '{transition.name}'"
        refuse_time(system, transition.source, transition.reset, what)


def _tables(system: System) -> list[str]:
    """What modes and transitions are besides their functions."""
    modes = [f"mode {m.name}: {m.states} {dict(m.constants)}" for m in system.modes if m.constants]
    if not modes:
        return []
    return modes + [
        f"{t.name}: {t.source} to {t.target}, {t.role}, {t.direction}" for t in system.transitions
    ]


def _functions_of(system: System, transition: Transition) -> tuple:
    """Equal for transitions that are the same but for modes whose constants differ."""
    shared = system.mode(transition.source).constants
    own = (transition.name, *shared) if shared else (transition.name, transition.source)
    return (*own, transition.guard, transition.reset, transition.relabel)


def _field(system: System, mode: Mode) -> Program:
    return shared_program(system, mode) if mode.constants else field_program(system, mode.name)


def _transition(system: System, transition: Transition, free: str | None) -> list[Program]:
    """Guard, reset and relabelling."""
    mode = system.mode(transition.source)
    if not mode.constants:
        leg = Leg(transition.source, transition)
        passage = passage_of(system, leg, transition.target, ScalarInputs(free))
        watched = transition.role == "watched"
        return [passage.watched_program(transition.guard) if watched else passage.end_program]
    guard, maps = rebound(transition.guard), []
    if transition.reset is not None:
        maps.append(rebound(transition.reset))
    if transition.relabel is not None:
        maps.append(rebound(system.symmetry(transition.relabel).map))
    whole = [trace(lambda tracer: [guard(*_given(tracer, system, mode, free))])]
    for map_ in maps:

        def image(tracer: Tracer, map_: Any = map_) -> list[Any]:
            out = np.full(len(system.states), 0.0, dtype=object)
            map_(*_given(tracer, system, mode, free), out)
            return list(out)

        whole.append(trace(image))
    return whole


def _given(
    tracer: Tracer, system: System, mode: Mode, free: str | None
) -> tuple[Any, np.ndarray, ParameterValues]:
    """Time, states and parameters as if all states existed, with the mode's constants as inputs."""
    known = parameter_symbols(tracer, system.parameter_names, free, ())
    constants = {name: tracer.symbol(CONSTANT, k) for k, name in enumerate(mode.constants)}
    x = state_symbols(tracer, len(system.states))
    return tracer.symbol(TIME, 0), x, ParameterValues(**vars(known), **constants)
