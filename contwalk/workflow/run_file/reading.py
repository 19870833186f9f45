"""The run file: one study as data, read and checked as a whole before anything runs.

Text -> data with lines (`yaml_lines`), `--set` values (`overrides`), types (`model`), names and bounds
of the system (`parameters`, `starts`, `settings`) -> `RunFile`. See `docs/reference/run_file.md`.
"""

from __future__ import annotations

import copy
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contwalk.errors import ContwalkError
from contwalk.plugin_check.at_load import load_system
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import System
from contwalk.system.held import HeldError, settled
from contwalk.system.loading import is_path, load_declaration
from contwalk.system.names import HELD
from contwalk.workflow.file_names import output_of
from contwalk.workflow.run_file import settings
from contwalk.workflow.run_file.figures import FigureSpec, figures_of
from contwalk.workflow.run_file.kept_form import form_of
from contwalk.workflow.run_file.names import DIAGRAM_FIGURES, FIGURES
from contwalk.workflow.run_file.parameters import differ, given_values, path_ends, sweep_values
from contwalk.workflow.run_file.problems import Problems
from contwalk.workflow.run_file.settings import Mark, ReportAt
from contwalk.workflow.run_file.starts import StartReader, StartSpec
from contwalk.workflow.run_file.text import text_of_file
from contwalk.workflow.run_file.without_effect import without_effect

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import RunModel

__all__ = [
    "FIGURES",
    "FigureSpec",
    "Mark",
    "ReportAt",
    "RunFile",
    "StartSpec",
    "read_run_file",
    "read_run_text",
]


@dataclass(frozen=True, eq=False)
class RunFile:
    """A checked run file.

    Parameters
    ----------
    path : Path
        The file, as the user gave it; `text` is its content, `overrides` the `--set` values.
    data : dict
        The content with the overrides applied, as plain data.
    system_reference, system, model : str, System, mapping
        The reference, the loaded system, and its model choices.
    parameters : mapping
        All parameters: the system's defaults, then the preset, then `parameters`.
    free : str
        The continued parameter; `path` on a parameter path.
    parameter_path : tuple of two mappings, optional
        All parameters at both ends of the path.
    range : tuple of float
        Lower and upper end of the free parameter.
    direction : str
        `both`, `forward` (growing free parameter) or `backward`.
    stop_at : mapping
        Name of a parameter or observable to the values where a branch ends.
    follow, depth : frozenset of str, int
        Labels whose new branches are followed, and how many generations.
    events : mapping
        `stop`, `ignore` or `switch` for each of GR, OC, AZ, BE.
    second : tuple of (str, tuple of float), optional
        Of a curve in two parameters the second one, with its range.
    loci : Loci, optional
        Curves in two parameters from the special points of the study.
    sweep : tuple of (str, tuple of float), optional
        A parameter and the values at each of which the diagram is computed; see `studies`.
    engine : mapping
        Those of `step`, `min_step`, `max_step`, `max_angle`, `max_share`, `newton_iterations`, `method`,
        `discretization`, `tolerance`, `segments`, `phase` that are given or have a default.
    without_effect : mapping
        Sentences on what is asked for and cannot come about, by what they are of.
    """

    path: Path
    text: str
    overrides: tuple[str, ...]
    data: dict[str, Any]
    system_reference: str
    system: System
    model: Mapping[str, Any]
    parameters: Mapping[str, float]
    accuracy: float
    starts: tuple[StartSpec, ...]
    free: str
    range: tuple[float, float]
    output: Path
    parameter_path: tuple[Mapping[str, float], Mapping[str, float]] | None = None
    direction: str = "both"
    max_points: int = 1000
    stop_at: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    follow: frozenset[str] = frozenset()
    depth: int = 5
    effort: float = math.inf
    marks: tuple[Mark, ...] = ()
    events: Mapping[str, str] = field(default_factory=dict)
    report_at: ReportAt | None = None
    figures: tuple[FigureSpec, ...] = ()
    sweep: tuple[str, tuple[float, ...]] | None = None
    second: tuple[str, tuple[float, float]] | None = None
    loci: settings.Loci | None = None
    engine: Mapping[str, float | str] = field(default_factory=dict)
    without_effect: Mapping[str, str] = field(default_factory=dict)

    def config(self) -> str:
        """Text of a run file that asks for this study: the file's own, or with `--set` values in it."""
        if not self.overrides:
            return self.text
        from ruamel.yaml import YAML

        yaml = YAML(pure=True)
        yaml.default_flow_style = None  # innermost mappings and lists in one line
        stream = io.StringIO()
        yaml.dump(self.data, stream)
        return stream.getvalue()

    def same_study(self, other: str | Mapping[str, Any]) -> bool:
        """Whether a run file's text, or its data, asks for the same branches.

        Wording, defaults written out, the name of the output and the figures make no difference.
        """
        stored = self.settings_of(other)
        return stored is not None and stored == self.settings_of(self.data)

    def settings_of(self, other: str | Mapping[str, Any]) -> dict[str, Any] | None:
        """What decides the branches of a run file, by key, from its text or data; None where it is none."""
        from contwalk.workflow.run_file.form import study_of

        return study_of(other)

    def studies(self) -> tuple[RunFile, ...]:
        """One run file for each swept value, without a sweep; without one, itself alone."""
        if self.sweep is None:
            return (self,)
        name, values = self.sweep
        return tuple(self._at(name, value) for value in values)

    def _at(self, name: str, value: float) -> RunFile:
        def put(parameters: Mapping[str, float]) -> dict[str, float]:
            return {**parameters, name: value}

        ends = self.parameter_path
        return replace(
            self,
            sweep=None,
            parameters=put(self.parameters),
            parameter_path=None if ends is None else (put(ends[0]), put(ends[1])),
            starts=tuple(
                replace(start, parameters=put(start.parameters), given=put(start.given))
                for start in self.starts
            ),
        )


def read_run_file(path: str | Path, overrides: Sequence[str] = (), output: str | None = None) -> RunFile:
    """Read and check a run file.

    Parameters
    ----------
    path : str or Path
    overrides : sequence of str
        `KEY=VALUE`, as after `--set`: `continue.range=[1,6]`.
    output : str, optional
        The database's name instead of the file's `output`.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key; all that were found, the first one first.
    """
    return read_run_text(text_of_file(Path(path), str(path)), path, overrides, output)


def read_run_text(
    text: str, path: str | Path, overrides: Sequence[str] = (), output: str | None = None
) -> RunFile:
    """As `read_run_file`, from text. `path` names it in messages; paths are relative to its folder."""
    problems, model, system = opened(text, path, overrides)
    run = _checked(problems, model, system, Path(path), output)
    problems.raise_any()
    return replace(run, text=text, overrides=tuple(overrides))


def opened(text: str, path: str | Path, overrides: Sequence[str] = ()) -> tuple[Problems, RunModel, System]:
    """A run file's text with its types checked and its system loaded; what any command begins with."""
    document, model = form_of(text, str(path), overrides)
    problems = Problems(document)
    return problems, model, _load(problems, model, Path(path).parent)


def _load(problems: Problems, model: RunModel, base: Path) -> System:
    """The system; what is wrong with it is told at the key `system`, or `model`."""
    held = {HELD + name: text for name, text in model.parameters.items() if isinstance(text, str)}
    try:
        return load_system(model.system, model.model | held, base)
    except HeldError as error:
        problems.add(("parameters", error.name), error.sentence, error.remedy)
        raise problems.error() from error
    except ContwalkError as error:
        key = "model" if model.model and _can_be_declared(model.system, base) else "system"
        problems.add((key,), error.sentence, error.remedy)
        raise problems.error() from error
    except (Exception, SystemExit) as error:  # a plugin's own code, run while it is built
        problems.add(
            ("system",),
            f"the plugin '{model.system}' raised {type(error).__name__}: {error}.",
            "Correct the plugin, or choose another model.",
        )
        raise problems.error() from error


def _can_be_declared(reference: str, base: Path) -> bool:
    """Whether the plugin itself loads, so that only its model choices can be at fault."""
    try:
        load_declaration(reference, base)
    except ContwalkError:
        return False
    return True


def _checked(problems: Problems, model: RunModel, system: System, path: Path, output: str | None) -> RunFile:
    """The run file of a model, with a problem noted for all that does not fit the system."""
    given = given_values(problems, system, model)
    parameters = settled(system, system.defaults() | given)
    need_start(problems, model)
    free = settings.free_parameter(problems, system, model)
    ends = None if model.path is None else path_ends(problems, system, model.path, parameters)
    varying = (
        tuple(n for n in parameters if differ(ends[0][n], ends[1][n]))
        if ends
        else tuple(filter(None, [free, *(model.continue_.parameters or ())[1:]]))
    )
    low, high = settings.continued_range(problems, system, model, free)
    at_start = dict(parameters) if ends is None else ParameterLine("path", parameters, ends).at(low)
    reader = StartReader(problems, system, path.parent, at_start, given, varying, settable=ends is None)
    starts = reader.read(model.start)
    measured, loci = None, settings.loci(problems, system, model, free)
    second = settings.second_range(problems, system, model, free)
    if free is not None:
        settings.check_starts_in_range(problems, starts, free, (low, high))
        if loci is not None:
            settings.check_starts_in_range(problems, starts, loci.second, loci.range, ("loci", "range"))
        also = () if model.loci is None else (model.loci.with_,)
        measured = settings.Measured(problems, system, free, (*varying, *also))
    ranges = {} if free is None else {free: (low, high)}
    ranges |= {} if second is None else dict([second])
    ranges |= {} if loci is None else {loci.second: loci.range}
    return RunFile(
        path=path,
        text="",
        overrides=(),
        data=copy.deepcopy(problems.document.data),
        system_reference=model.system,
        system=system,
        model=dict(system.model),
        parameters=parameters,
        accuracy=model.accuracy,
        starts=starts,
        free=free or "",
        parameter_path=ends,
        range=(low, high),
        direction=settings.DIRECTIONS[model.continue_.direction],
        max_points=model.continue_.max_points,
        stop_at=settings.stops(problems, measured, model),
        follow=frozenset(model.diagram.follow),
        depth=model.diagram.depth,
        effort=math.inf if model.diagram.effort is None else model.diagram.effort,
        marks=settings.marks(problems, measured, model),
        events=model.events.model_dump(),
        report_at=settings.report_place(problems, system, model.report_at),
        output=_output(problems, model, path, output, starts),
        figures=figures_of(problems, system, model, DIAGRAM_FIGURES),
        sweep=sweep_values(problems, system, model, varying),
        engine=model.engine.model_dump(exclude_none=True),
        second=second,
        loci=loci,
        without_effect=without_effect(problems, model, system, ranges),
    )


def need_start(problems: Problems, model: RunModel) -> None:
    """Note a problem where the file says of no start."""
    if not model.start:
        from contwalk.workflow.run_file.form import allowed_start

        problems.add(("start",), "the key is missing.", allowed_start())


def _output(
    problems: Problems, model: RunModel, path: Path, output: str | None, starts: tuple[StartSpec, ...]
) -> Path:
    """The database to write: relative to the current directory, never a file that the run reads."""
    result = output_of(path, output, model.output)
    read = [(path, "the run file itself")]
    if is_path(model.system):
        read.append((path.parent / model.system, "the plugin"))
    read += [(start.file, "the database that a start is taken from") for start in starts if start.file]
    for file, what in read:
        if file.resolve() == result.resolve():
            problems.add(("output",), f"'{result}' is {what}.", "Give another name for the output.")
    return result
