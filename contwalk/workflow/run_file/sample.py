"""A run file as `contwalk sample` reads it: the section `sample` with the start that draws are put into."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from contwalk.errors import RunFileError, StartError
from contwalk.system import System
from contwalk.workflow.file_names import output_of
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.figures import FigureSpec, figures_of
from contwalk.workflow.run_file.motion_file import MotionFile
from contwalk.workflow.run_file.motions import Sampling
from contwalk.workflow.run_file.names import SAMPLE_FIGURES
from contwalk.workflow.run_file.parameters import check_bounds, given_values
from contwalk.workflow.run_file.problems import Problems, allowed
from contwalk.workflow.run_file.products import Product
from contwalk.workflow.run_file.reading import opened
from contwalk.workflow.run_file.simulate import only_start
from contwalk.workflow.run_file.starts import StartSpec
from contwalk.workflow.run_file.text import text_of_file


@dataclass(frozen=True, eq=False, kw_only=True)
class SampleFile(MotionFile):
    """A checked run file, for many motions: a `MotionFile` whose start gives what is not drawn.

    Parameters
    ----------
    sampling : Sampling
        The section itself.
    """

    sampling: Sampling


def read_sampling(path: str | Path, overrides: Sequence[str] = (), output: str | None = None) -> SampleFile:
    """Read and check a run file for `contwalk sample`.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key.
    """
    return read_sampling_text(text_of_file(Path(path), str(path)), path, overrides, output)


def read_sampling_text(
    text: str, path: str | Path, overrides: Sequence[str] = (), output: str | None = None
) -> SampleFile:
    """As `read_sampling` of a text; what it names is looked for beside the file of that path.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key.
    """
    problems, model, system = opened(text, path, overrides)
    if model.sample is None:
        raise RunFileError(
            f"{problems.document.where(('sample',))}: the key is missing.",
            "Say what is drawn and measured: {count: 1000, draw: {...}, measure: {...}, settled: {...}}.",
        )
    given = given_values(problems, system, model)
    start = only_start(problems, system, model, Path(path).parent, system.defaults() | given, given)
    _smooth_only(problems, system)
    _check(problems, system, model.sample, start)
    figures = figures_of(problems, system, model, SAMPLE_FIGURES)
    problems.raise_any()
    assert start is not None
    return SampleFile(
        path=Path(path),
        text=text,
        overrides=tuple(overrides),
        system_reference=model.system,
        system=system,
        start=start,
        sampling=model.sample,
        output=output_of(path, output, model.output),
        figures=figures or (FigureSpec("histogram"),),
    )


def _check(problems: Problems, system: System, sampling: Sampling, start: StartSpec | None) -> None:
    observables = tuple(observable.name for observable in system.observables)
    measured = sampling.measure.observable
    if measured not in observables:
        problems.add(
            ("sample", "measure", "observable"),
            f"'{measured}' is not an observable of '{system.name}'.",
            allowed(observables, measured),
        )
    _check_settled(problems, system, sampling)
    parameters = system.defaults() if start is None else start.parameters
    _check_draws(problems, system, sampling, parameters)
    products: list[tuple[Key, Product]] = [(("sample", "measure", "level"), sampling.measure.level)]
    if sampling.time_unit is not None:
        key: Key = ("sample", "time_unit", "length")
        products.append((key, sampling.time_unit.length))
        value = _value(problems, system, key, sampling.time_unit.length, parameters)
        if value is not None and not value > 0.0:
            problems.add(key, f"is {value:.12g}.", "Allowed: what is positive.")
    for key, each in products:
        _value(problems, system, key, each, parameters)


def _check_settled(problems: Problems, system: System, sampling: Sampling) -> None:
    key: Key = ("sample", "settled")
    try:
        system.start(sampling.settled.equilibrium)
    except StartError as error:
        problems.add((*key, "equilibrium"), error.sentence, error.remedy)
    for name in sampling.settled.within:
        if name not in system.state_names:
            problems.add(
                (*key, "within", name),
                f"'{name}' is not a state of '{system.name}'.",
                allowed(system.state_names, name),
            )
    if not sampling.settled.within:
        problems.add(
            (*key, "within"),
            "names no state.",
            f"Allowed: {{state: distance, ...}} {allowed(system.state_names)}",
        )


def _check_draws(
    problems: Problems, system: System, sampling: Sampling, parameters: Mapping[str, float]
) -> None:
    """Names, order and bounds of what is drawn; the ends must not depend on what is drawn too."""
    if not sampling.draw:
        problems.add(
            ("sample", "draw"), "draws nothing.", "Allowed: {state or parameter: [lowest, highest], ...}."
        )
    for name, ends in sampling.draw.items():
        key: Key = ("sample", "draw", name)
        if name not in (*system.state_names, *system.parameter_names):
            problems.add(
                key,
                f"'{name}' is neither a state nor a parameter of '{system.name}'.",
                allowed((*system.state_names, *system.parameter_names), name),
            )
            continue
        for other in {factor for end in ends for factor in end.names} & set(sampling.draw):
            problems.add(key, f"depends on '{other}', which is drawn too.", "Write its value out.")
        values = [_value(problems, system, key, end, parameters) for end in ends]
        if values[0] is None or values[1] is None:
            continue
        if not values[0] < values[1]:
            problems.add(
                key, f"is empty: [{values[0]:.12g}, {values[1]:.12g}].", "Allowed: [lowest, highest]."
            )
        for parameter in system.parameters:
            if parameter.name == name:
                check_bounds(problems, key, parameter, values[0])
                check_bounds(problems, key, parameter, values[1])


def _value(
    problems: Problems, system: System, key: Key, product: Product, parameters: Mapping[str, float]
) -> float | None:
    """The value of a product; None where a problem has been noted."""
    for name in product.names:
        if name not in system.parameter_names:
            problems.add(
                key, f"'{name}' is not a parameter of '{system.name}'.", allowed(system.parameter_names, name)
            )
            return None
    value = product.value(parameters)
    if not math.isfinite(value):
        problems.add(key, f"'{product.text}' is not finite at these parameters.", "Give a finite number.")
        return None
    return value


def _smooth_only(problems: Problems, system: System) -> None:
    """Note a problem for machines whose motion is not smooth."""
    acting = list(dict.fromkeys(transition.name for transition in system.acting))
    if len(system.modes) > 1 or acting:
        problems.add(
            ("system",),
            f"'{system.name}' changes its motion at {', '.join(acting) or 'its transitions'}; many motions "
            "are computed of smooth machines only.",
            "Allowed: systems of one mode whose transitions are watched. contwalk simulate takes any.",
        )
