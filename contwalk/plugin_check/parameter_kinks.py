"""Functions that jump, or have a corner, at a value of a parameter, whatever the states are: told beforehand.

A branch over that parameter ends there, or has a corner.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.fields.blame import first_switched
from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Inputs, Switching
from contwalk.fields.trace import Program, Tracer, trace
from contwalk.plugin_check.findings import Report, split_switch
from contwalk.plugin_check.samples import Samples, as_field
from contwalk.plugin_check.traced import Traced
from contwalk.problems.kink import Met, ParameterKink
from contwalk.problems.kinks import Course
from contwalk.problems.parameter_kinks import Way, choices_of_parameters, passed
from contwalk.system import Parameter, System
from contwalk.system.declarations import ParameterValues

# How far from its default a parameter is looked at where it has no bound, in units of it.
REACH = 2.0
# A part of the range: `abs` of a parameter that is never negative changes at its bound only.
AT_BOUND = 1e-8

Written = Callable[[Any, Any, Any, Any], None]


def check_parameter_kinks(
    report: Report, what: str, function: Traced, samples: Samples, mode: str | None = None
) -> None:
    """Tell of values of each parameter, within its bounds, at which a function jumps or has a corner."""
    constants = {} if mode is None else dict(function.system.mode(mode).constants)
    states = np.array([function.given(x) for x in samples.states])
    _check(report, what, function.program, as_field(function), function.system, samples, states, constants)


def check_kinks_of_period(report: Report, system: System, samples: Samples) -> None:
    """As `check_parameter_kinks`, of the period of what forces a system."""
    assert system.period is not None
    period = rebound(system.period)

    def recorded(tracer: Tracer) -> list[Any]:
        named = {name: tracer.symbol("p", k) for k, name in enumerate(system.parameter_names)}
        return [period(ParameterValues(**named))]

    def written(t: Any, x: Any, p: Any, out: Any) -> None:
        out[0] = period(p)

    try:
        program = trace(recorded)
    except ContwalkError:  # which is told of the period itself
        return
    _check(report, "period", program, written, system, samples, samples.states, {})


def _check(
    report: Report,
    what: str,
    program: Program,
    written: Written,
    system: System,
    samples: Samples,
    states: np.ndarray,
    constants: Mapping[str, float],
) -> None:
    names = {("p", k) for k in range(len(system.parameters))}
    switching = Switching(program, [], ("t", 0))
    if not switching.choices or not choices_of_parameters(switching, names).choices:
        return
    given = {("p", k): value for k, value in enumerate(samples.values)}

    def evaluate(times: np.ndarray, places: np.ndarray) -> Inputs:
        return {("t", 0): times, **{("x", i): x for i, x in enumerate(places.T)}, **given}

    def still(times: np.ndarray) -> np.ndarray:
        return states

    unknowns = [("x", i) for i in range(states.shape[1])]
    for k, parameter in enumerate(system.parameters):
        low, high = _range(parameter)

        def at(share: float, name: str = parameter.name, low: float = low, high: float = high) -> str:
            return f"{name} = {low + share * (high - low):.10g}"

        def blame(
            one: float, other: float, row: int, k: int = k, low: float = low, high: float = high
        ) -> str:
            name, place = system.parameters[k].name, (float(samples.times[row]), states[row].tolist())
            values = ({**samples.parameters, **constants, name: low + s * (high - low)} for s in (one, other))
            return first_switched(written, place, place, *values)

        switching = Switching(program, [*unknowns, ("p", k)], ("t", 0))
        course = Course(switching, evaluate, samples.times, states, still, lambda *_: "", of=f"the {what}")
        met = passed(course, Way({("p", k): low}, {("p", k): high}, at, blame))
        _tell(report, what, [each for each in met if each.kink.order < 2 and each.share > AT_BOUND])


def _range(parameter: Parameter) -> tuple[float, float]:
    """Between which values a parameter is looked at."""
    default, (low, high) = float(parameter.default), parameter.bounds
    reach = REACH * abs(default) or 1.0
    return default - reach if low is None else float(low), default + reach if high is None else float(high)


def _tell(report: Report, what: str, met: list[Met[ParameterKink]]) -> None:
    """Tell of the first value, and how many others there are."""
    if not met:
        return
    first = min(met, key=lambda each: each.kink.order).kink
    place, words = split_switch(first.where)
    told = replace(first, where=words)
    sentence = told.sentence("orbits") if told.order else told.refusal("orbits").sentence
    others = f" So it is at {len(met) - 1} more values." if len(met) > 1 else ""
    report.warning(what, sentence + others, place)
