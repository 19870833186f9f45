"""The traced equations of a hybrid system as text: what decides a branch, for provenance."""

from __future__ import annotations

from typing import Any

from contwalk.fields.codegen import source
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import Tracer, trace
from contwalk.flow.traced import arguments, field_program
from contwalk.problems.hybrid.passage import passage_of
from contwalk.problems.hybrid.word import Leg
from contwalk.problems.tracing import parameter_symbols
from contwalk.system import System

_INPUTS = ("u", "T", "s", "a", "l", "b", "d", "t", "x", "p")


def equations_text(system: System, free: str | None) -> str:
    """Fields, guards, resets, conditions and the period, each traced.

    Raises
    ------
    UnsupportedOperation, SystemDefinitionError
        With the line of the plugin.
    """
    texts = [source(field_program(system, mode.name), _INPUTS) for mode in system.modes]
    for transition in system.transitions:
        leg = Leg(transition.source, transition)
        passage = passage_of(system, leg, transition.target, free, (), ())
        if transition.role == "watched":
            watched = passage.watched_program(transition.guard)
            texts.append(source(watched, _INPUTS))
        else:
            texts.append(source(passage.end_program, _INPUTS))
    for condition in system.conditions:
        mode, copy = system.sources(condition.at)[0], rebound(condition.function)

        def value(tracer: Tracer, mode: str = mode, copy: Any = copy) -> list[Any]:
            return [copy(*arguments(tracer, system, mode))]

        texts.append(source(trace(value), _INPUTS))
    if system.period is not None:
        period = rebound(system.period)
        texts.append(
            source(trace(lambda t: [period(parameter_symbols(t, system.parameter_names, free, ()))]), _INPUTS)
        )
    return "\n".join(texts)
