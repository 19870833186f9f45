"""A run file as `contwalk simulate` reads it: the section `simulate` with its start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contwalk.system import System
from contwalk.system.modes import ITERATED
from contwalk.workflow.file_names import output_of
from contwalk.workflow.run_file import settings
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.figures import FigureSpec, figures_of
from contwalk.workflow.run_file.model import RunModel
from contwalk.workflow.run_file.motion_file import MotionFile
from contwalk.workflow.run_file.motions import Simulation
from contwalk.workflow.run_file.names import MOTION_FIGURES
from contwalk.workflow.run_file.parameters import given_values
from contwalk.workflow.run_file.problems import Problems, allowed
from contwalk.workflow.run_file.reading import need_start, opened
from contwalk.workflow.run_file.settings import ReportAt
from contwalk.workflow.run_file.starts import StartReader, StartSpec
from contwalk.workflow.run_file.text import text_of_file


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulationFile(MotionFile):
    """A checked run file, for one motion: a `MotionFile` with these besides.

    Parameters
    ----------
    perturbation : ndarray, shape (n,)
        What is added to the state at the start.
    simulation : Simulation
        The section itself.
    report_at : ReportAt, optional
        A section whose crossings are events too.
    accuracy : float
        What results are to be known to.
    """

    perturbation: np.ndarray
    simulation: Simulation
    report_at: ReportAt | None
    accuracy: float

    @property
    def smooth(self) -> bool:
        """Whether there is one mode, nothing acts on it but its field, and nothing ends its motions."""
        system = self.system
        return len(system.modes) == 1 and not system.acting and system.fallen is None

    @property
    def iterates(self) -> bool:
        """Whether a map is iterated so many times, and nothing else is watched."""
        plain = self.system.fallen is None and self.report_at is None
        return plain and self.system.modes[0].kind == ITERATED and self.simulation.until != "settled"


def read_simulation(
    path: str | Path, overrides: Sequence[str] = (), output: str | None = None
) -> SimulationFile:
    """Read and check a run file for `contwalk simulate`.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key.
    """
    text = text_of_file(Path(path), str(path))
    problems, model, system = opened(text, path, overrides)
    given = given_values(problems, system, model)
    start = only_start(problems, system, model, Path(path).parent, system.defaults() | given, given)
    simulation = model.simulate or Simulation()
    perturbation = _perturbation(problems, system, simulation.perturb)
    figures = motion_figures(problems, system, model)
    place = settings.report_place(problems, system, model.report_at)
    problems.raise_any()
    assert start is not None
    return SimulationFile(
        path=Path(path),
        text=text,
        overrides=tuple(overrides),
        system_reference=model.system,
        system=system,
        start=start,
        perturbation=perturbation,
        simulation=simulation,
        report_at=place,
        accuracy=model.accuracy,
        output=output_of(path, output, model.output),
        figures=figures,
    )


def only_start(
    problems: Problems,
    system: System,
    model: RunModel,
    base: Path,
    parameters: Mapping[str, float],
    given: Mapping[str, float],
) -> StartSpec | None:
    """The one start of a file; a problem is noted where there is none, or more than one.

    Of one that a run simulates to come to its first solution it is the state that sets out.
    """
    need_start(problems, model)
    starts = StartReader(problems, system, base, parameters, given, (), settable=True).read(model.start)
    if len(starts) > 1:
        names = [spec.name for spec in starts if spec.name is not None]
        problems.add(
            ("start",),
            f"has {len(starts)} starts{': ' * bool(names)}{', '.join(names)}.",
            "Give one of them.",
        )
    return starts[0] if starts else None


def motion_figures(problems: Problems, system: System, model: RunModel) -> tuple[FigureSpec, ...]:
    """The figures of a motion; time series of all states where none is asked for."""
    for index, entry in enumerate(model.figures):
        options = entry.get("phase_portrait")
        if options is not None and (options.x is None or options.y is None):
            key: Key = ("figures", index, "phase_portrait")
            remedy = (
                f"Give two states, {{phase_portrait: {{x: NAME, y: NAME}}}}. {allowed(system.state_names)}"
            )
            problems.add(key, "says of no plane.", remedy)
        if "stick_figure" in entry and system.draw is None:
            remedy = "Remove it, or declare System(..., draw=draw) in the plugin."
            problems.add(("figures", index, "stick_figure"), f"'{system.name}' declares no draw.", remedy)
    found = figures_of(problems, system, model, MOTION_FIGURES)
    return found or (FigureSpec("time_series"),)


def _perturbation(problems: Problems, system: System, values: Mapping[str, float]) -> np.ndarray:
    names = system.state_names
    for name in values:
        if name not in names:
            problems.add(
                ("simulate", "perturb", name),
                f"'{name}' is not a state of '{system.name}'.",
                allowed(names, name),
            )
    return np.array([values.get(name, 0.0) for name in names])
