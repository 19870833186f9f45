"""Parameter values of a run: defaults, preset, `parameters`, the ends of a `path`, a `sweep`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from contwalk.system.declarations import Parameter, System
from contwalk.system.held import HeldError, held_in, settled
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.problems import Problems, allowed

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import ParameterPath, RunModel


def parameter_named(problems: Problems, key: Key, system: System, name: str) -> Parameter | None:
    """The parameter of this name; a problem at `key` if the system has none."""
    held = held_in(system).get(name)
    if held is not None:
        what = f"'{name}' is held by the expression {held!r}."
        problems.add(key, what, "Change what it depends on, or give it a number under parameters.")
        return None
    for parameter in system.parameters:
        if parameter.name == name:
            return parameter
    problems.add(
        key, f"'{name}' is not a parameter of '{system.name}'.", allowed(system.parameter_names, name)
    )
    return None


def check_bounds(problems: Problems, key: Key, parameter: Parameter, value: float) -> None:
    """Note a problem at `key` where `value` lies outside the declared bounds."""
    if not parameter.allows(value):
        problems.add(
            key,
            f"{value:.12g} lies outside the bounds of '{parameter.name}'.",
            f"Allowed: {parameter.interval()} (unit {parameter.unit}).",
        )


def checked_values(
    problems: Problems, key: Key, system: System, values: Mapping[str, float]
) -> dict[str, float]:
    """The values of those names that are parameters, with a problem for each that is wrong."""
    result = {}
    for name, value in values.items():
        parameter = parameter_named(problems, (*key, name), system, name)
        if parameter is not None:
            check_bounds(problems, (*key, name), parameter, value)
            result[name] = value
    return result


def preset_values(problems: Problems, key: Key, system: System, name: str) -> dict[str, float]:
    """The values of a preset; a problem at `key` if there is none of this name."""
    if name not in system.presets:
        problems.add(
            key, f"'{name}' is not a preset of '{system.name}'.", allowed(tuple(system.presets), name)
        )
        return {}
    values = {known: float(value) for known, value in system.presets[name].items()}
    for parameter in system.parameters:
        if parameter.name in values:
            check_bounds(problems, key, parameter, values[parameter.name])
    return values


def numbers_of(model: RunModel) -> dict[str, float]:
    """The values under `parameters` that are no expressions."""
    return {name: value for name, value in model.parameters.items() if not isinstance(value, str)}


def given_values(problems: Problems, system: System, model: RunModel) -> dict[str, float]:
    """What the file says beyond the system's defaults: the preset, then `parameters`."""
    preset = {} if model.preset is None else preset_values(problems, ("preset",), system, model.preset)
    given = preset | checked_values(problems, ("parameters",), system, numbers_of(model))
    try:
        values = settled(system, system.defaults() | given)
    except HeldError as error:
        problems.add(("parameters", error.name), error.sentence, error.remedy)
        raise problems.error() from error
    for parameter in system.parameters:
        if parameter.name in held_in(system):
            check_bounds(problems, ("parameters", parameter.name), parameter, values[parameter.name])
    return given


def path_ends(
    problems: Problems, system: System, path: ParameterPath, base: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """All parameters at both ends of a path; what an end does not give is as in the run."""
    ends = []
    for word, end in (("from", path.from_), ("to", path.to)):
        key = ("path", word)
        if isinstance(end, str):
            ends.append({**base, **preset_values(problems, key, system, end)})
        else:
            ends.append({**base, **checked_values(problems, key, system, end)})
    if ends[0] == ends[1]:
        problems.add(("path",), "both ends have the same parameters.", "Give ends that differ.")
    return ends[0], ends[1]


def differ(a: float, b: float) -> bool:
    """Whether a parameter changes from one value to another: what nobody gives (NaN) does not."""
    return a != b and not (math.isnan(a) and math.isnan(b))


def _evenly(first: float, last: float, count: int) -> tuple[float, ...]:
    """Values evenly spread, the nearest numbers to what the decimals that were written give."""
    if count < 2:
        return (first,) * count
    low, high = Fraction(repr(first)), Fraction(repr(last))
    return tuple(float(low + (high - low) * Fraction(i, count - 1)) for i in range(count))


def sweep_values(
    problems: Problems, system: System, model: RunModel, varying: tuple[str, ...]
) -> tuple[str, tuple[float, ...]] | None:
    """The swept parameter and its values; `varying` names what the continuation itself changes."""
    if not model.sweep:
        return None
    if len(model.sweep) > 1:
        problems.add(("sweep",), f"sweeps {', '.join(model.sweep)}.", "Allowed: exactly one parameter.")
        return None
    ((name, written),) = model.sweep.items()
    key = ("sweep", name)
    parameter = parameter_named(problems, key, system, name)
    if name in varying:
        problems.add(key, f"'{name}' is what the branch changes already.", "Sweep another parameter.")
    values = written if isinstance(written, tuple) else _evenly(written.from_, written.to, written.count)
    if not values or len(set(values)) < len(values):
        problems.add(key, "lists no value, or one twice.", "Give different values, [0.1, 0.2].")
    if parameter is not None:
        for value in values:
            check_bounds(problems, key, parameter, value)
    for index, start in enumerate(model.start):
        if name in start.parameters:
            problems.add(
                ("start", index, "parameters", name), f"'{name}' is swept.", "Remove it here or in sweep."
            )
    return name, values
