"""The run file that `contwalk init SYSTEM` writes: valid as it stands, every key explained by a comment."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping

import numpy as np

from contwalk.errors import RunFileError, StartError
from contwalk.plugin_check.samples import samples_of
from contwalk.python_functions import plain
from contwalk.system.declarations import Parameter, ParameterValues, System
from contwalk.workflow.run_file.names import FIGURES, FOLLOWED

_PLAIN = re.compile(r"[./\w][./\w-]*")
_WORDS_OF_YAML = ("null", "true", "false", "yes", "no", "on", "off", "y", "n")

_EVENTS = "# events: {GR: stop, OC: switch, AZ: ignore, BE: stop}   # stop, ignore or switch\n"
_REST = """\
# The keys below are optional; what stands behind the # is an example or the default.
# author: NAME   # who stands behind the study: kept in the database
# description: TEXT   # what it is of: kept in the database
# preset: {preset}   # a named parameter set of the system; `parameters` go on top of it
# path: {{from: {{{example}: {low}}}, to: {{{example}: {high}}}}}   # instead of a parameter and its range
diagram: {{follow: [BP, HB, PD], depth: 5}}   # labels of {labels}; all, or none
# mark: {{{example}: [{value}], max_re: [0.0, extremum]}}   # values to locate, and extrema of an observable
{events}# report_at: {report_at}   # where the state of an orbit is taken
# output: {system}.h5   # the default is this file's name with .h5, in the current directory
# figures: [bifurcation_diagram]   # of {figures}
# loci: {loci}   # curves in two parameters from the special points
# sweep: {sweep}   # the whole diagram at each value; or NAME: {{from: 0, to: 1, count: 11}}
# engine: {{max_step: 0.1, max_angle: 20}}   # for experts: step, min_step, newton_iterations
# simulate: {simulate}   # contwalk simulate: one motion from the start
# sample: {sample}   # contwalk sample: many motions
# margins: {margins}   # contwalk margins: how far a stored motion may be pushed
"""


def starting_file(system: System, reference: str) -> str:
    """A commented run file for this system.

    Parameters
    ----------
    system : System
    reference : str
        What `system:` shall say: the installed name, or the plugin's path relative to the run file.

    Raises
    ------
    RunFileError
        If the system has no parameter that can be continued.
    """
    parameter, (low, high) = _continued(system)
    study = system.study
    values = {**system.defaults(), **(study.parameters if study else {})}
    about = _one_line(system.about or system.reference)
    lines = [
        f"# {_one_line(system.name)}{': ' + about if about else ''}",
        "contwalk: 1   # version of this format",
        f"system: {_text(reference)}",
    ]
    if system.model:
        choices = ", ".join(f"{name}: {_text(value)}" for name, value in system.model.items())
        lines.append(
            f"model: {{{choices}}}   # model choices; what is not chosen does not exist in the system"
        )
    lines += ["parameters:", *_parameter_lines(system, values)]
    lines.append("accuracy: 1e-8   # requested relative error of special points")
    lines += _start_lines(system, values)
    lines.append(
        f"continue: {{parameter: {_text(parameter.name)}, range: [{low!r}, {high!r}], direction: both, "
        "max_points: 1000}"
    )
    if study is not None and study.events:
        lines.append(f"events: {_flow(study.events)}   # what is done at a limit: stop, ignore or switch")
    rest = _REST.format(
        events="" if study is not None and study.events else _EVENTS,
        system=system.name,
        preset=next(iter(system.presets), "null"),
        example=parameter.name,
        low=repr(low),
        high=repr(high),
        value=repr(float(parameter.default)),
        labels=", ".join(FOLLOWED),
        figures=", ".join(FIGURES),
        report_at=_report_example(system),
        sweep=_sweep_example(system, parameter),
        loci=_loci_example(system, parameter),
        margins="{of: {from: results.h5, point: b1/0}, survive: {periods: 20}}",
        simulate=f"{{until: settled, points: 1000, perturb: {{{system.state_names[0]}: 0.01}}}}",
        sample=_sample_example(system),
    )
    return "\n".join([*lines, rest])


def _continued(system: System) -> tuple[Parameter, tuple[float, float]]:
    """The study's parameter and range; else the first parameter with room around its default, and a range."""
    if system.study is not None:
        name, between = system.study.parameter, system.study.range
        return next(p for p in system.parameters if p.name == name), (float(between[0]), float(between[1]))
    for parameter in system.parameters:
        low, high = _around(parameter)
        if low < high:
            return parameter, (low, high)
    raise RunFileError(
        f"System '{system.name}' has no parameter that could be continued.",
        "Declare a parameter whose bounds leave room around its default.",
    )


def _around(parameter: Parameter) -> tuple[float, float]:
    """A range around a parameter's default, within its bounds."""
    value = float(parameter.default)
    ends = sorted((0.5 * value, 2.0 * value)) if value else [-1.0, 1.0]
    low, high = parameter.bounds
    return (
        ends[0] if low is None else max(ends[0], float(low)),
        ends[1] if high is None else min(ends[1], float(high)),
    )


def _flow(value: object) -> str:
    """A value in YAML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_text(key)}: {_flow(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _text(value)


def _parameter_lines(system: System, values: Mapping[str, float]) -> list[str]:
    # What a start has of a conserved quantity need not be given: its line is a comment.
    entries = [
        f"  # {parameter.name}: "
        if math.isnan(values[parameter.name])
        else f"  {parameter.name}: {float(values[parameter.name])!r}"
        for parameter in system.parameters
    ]
    width = max(len(entry) for entry in entries)
    lines = []
    for entry, parameter in zip(entries, system.parameters, strict=True):
        about = _one_line(parameter.about)
        comment = f"{_one_line(parameter.unit)}, {parameter.interval()}{': ' + about if about else ''}"
        if math.isnan(values[parameter.name]):
            comment = f"{comment}; conserved: without a value, that of the start"
        lines.append(f"{entry:<{width}}   # {comment}")
    return lines


def _start_lines(system: System, values: Mapping[str, float]) -> list[str]:
    """The study's start; else the first named equilibrium that exists, a simulation for a forced or impacting
    system, or zeros.
    """
    if system.study is not None and system.study.start is not None:
        return [f"start: {_flow(system.study.start)}"]
    names = [start.name for start in system.starts]
    for name in names:
        if _exists(system, name, values):
            return [
                f"# equilibria known by name: {', '.join(names)}; or give the {{state: {{...}}}} itself",
                f"start: {{equilibrium: {_text(name)}}}",
            ]
    guess = _guess(system)
    existing = [(system.states[i], guess[i]) for i in system.states_of(system.modes[0].name)]
    state = f"{{{', '.join(f'{declared.name}: {value!r}' for declared, value in existing)}}}"
    units = ", ".join(f"{declared.name} [{_one_line(declared.unit)}]" for declared, _ in existing)
    if system.period is not None or system.transitions:
        return [
            f"# states: {units}",
            "# a guess: give a state from which the motion settles on an orbit",
            f"start: {{simulate: {{state: {state}, until: settled}}}}",
        ]
    return [
        f"# states: {units}; a guess near an equilibrium is enough",
        "# or begin where a motion settles, at rest or on an orbit: "
        "{simulate: {state: {...}, until: settled}}",
        f"start: {{state: {state}}}",
    ]


def _guess(system: System) -> list[float]:
    """The start that is declared; else states, zero if possible, at which no guard of the first mode is zero,
    or past it, at the defaults.
    """
    if any(state.start is not None for state in system.states):
        return [float(state.start or 0.0) for state in system.states]
    tried = [np.zeros(len(system.states)), *np.round(samples_of(system, None).states, 2)]
    return min(tried, key=lambda x: _passed(system, x)).tolist()


def _passed(system: System, x: np.ndarray) -> int:
    """How many guards of the first mode are zero, past it, or without a value at a state."""
    mode, passed = system.modes[0], 0
    p = ParameterValues(**{**system.defaults(), **mode.constants})
    for transition in system.leaving(mode.name):
        try:
            value = float(plain(transition.guard)(0.0, x, p))
        except (Exception, SystemExit):
            return len(system.transitions) + 1
        before = {"falling": value > 0.0, "rising": value < 0.0, "both": value != 0.0}
        passed += transition.role != "watched" and not before[transition.direction]
    return passed


def _exists(system: System, name: str, values: Mapping[str, float]) -> bool:
    try:
        return bool(system.named_states(name, values))
    except StartError:
        return False


def _report_example(system: System) -> str:
    if system.acting:
        return f"{{event: {system.acting[0].name}, side: before}}"
    name = system.state_names[0]
    return f"{{section: {{{name}: 0.0}}, direction: rising}}"


def _sweep_example(system: System, continued: Parameter) -> str:
    known = [parameter for parameter in system.parameters if not math.isnan(parameter.default)]
    others = [parameter for parameter in known if parameter is not continued]
    return f"{{{others[-1].name}: [{float(others[-1].default)!r}]}}" if others else "null"


def _loci_example(system: System, continued: Parameter) -> str:
    """Curves over another parameter that has room around its default; null where there is none."""
    for parameter in reversed(system.parameters):
        low, high = _around(parameter)
        if parameter is not continued and low < high:
            return f"{{with: {_text(parameter.name)}, range: [{low!r}, {high!r}], of: all, follow: all}}"
    return "null"


def _sample_example(system: System) -> str:
    """What could be measured of many motions; nothing without an observable and a place to rest."""
    if not (system.observables and system.starts):
        return "null"
    state = system.state_names[0]
    return (
        f"{{count: 1000, draw: {{{state}: [0, 1]}}, until: 1000, "
        f"measure: {{observable: {system.observables[0].name}, level: 0.1}}, "
        f"settled: {{equilibrium: {_text(system.starts[0].name)}, within: {{{state}: 1e-4}}}}}}"
    )


def _text(value: object) -> str:
    """A value in YAML that is read back as it is."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if not isinstance(value, str):
        return str(value)
    plain = _PLAIN.fullmatch(value) and not value[0].isdigit() and value.lower() not in _WORDS_OF_YAML
    starts_a_number = value[:2] in (".n", ".N", ".i", ".I") or (value[:1] == "." and value[1:2].isdigit())
    return value if plain and not starts_a_number else json.dumps(value, ensure_ascii=False)


def _one_line(text: str) -> str:
    """Text that stays inside a comment."""
    return " ".join(text.split())
