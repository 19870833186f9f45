"""The figures that a run file asks for: their names, axes and files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contwalk import quantities
from contwalk.figure_formats import allowed_formats, unknown_format
from contwalk.system.declarations import System
from contwalk.workflow.quantities import listed
from contwalk.workflow.run_file.document import Key
from contwalk.workflow.run_file.names import FIGURES, MOTION_FIGURES, SAMPLE_FIGURES
from contwalk.workflow.run_file.problems import Problems, allowed
from contwalk.workflow.run_file.settings import BUILT_IN, PATH

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import FigureOptions, RunModel


@dataclass(frozen=True)
class FigureSpec:
    """A figure by its name, with the options (`x`, `y`, `file`, ...) that the file gives."""

    name: str
    options: Mapping[str, Any] = field(default_factory=dict)


def figures_of(
    problems: Problems, system: System, model: RunModel, kinds: tuple[str, ...]
) -> tuple[FigureSpec, ...]:
    """The figures of these kinds to be drawn; the names and axes of all are checked."""
    result = []
    for index, entry in enumerate(model.figures):
        if len(entry) != 1:
            problems.add(
                ("figures", index),
                f"has {len(entry)} names.",
                "Allowed: a name, or {name: {x: ..., y: ...}}.",
            )
        for name, options in entry.items():
            key = ("figures", index, name)
            if name not in FIGURES:
                problems.add(key, f"there is no figure '{name}'.", allowed(FIGURES, name))
            _check_axes(problems, system, key, options)
            _check_file(problems, model.figures[:index], key, options)
            if name in kinds:
                result.append(FigureSpec(name, options.model_dump(exclude_none=True)))
    return tuple(result)


def _check_file(
    problems: Problems, before: Sequence[dict[str, FigureOptions]], key: Key, options: FigureOptions
) -> None:
    """A file of a known format and of its own: a figure would be drawn over an earlier one without a word."""
    if options.file is not None and (wrong := unknown_format(Path(options.file))):
        problems.add((*key, "file"), f"'{options.file}' cannot be drawn: {wrong}.", allowed_formats())
    earlier = [of.file for entry in before for of in entry.values()]
    if options.file is not None and options.file in earlier:
        problems.add(
            (*key, "file"),
            f"'{options.file}' is the file of figure {earlier.index(options.file) + 1} too.",
            "Give each figure a file of its own.",
        )


def _check_axes(problems: Problems, system: System, key: Key, options: FigureOptions) -> None:
    observables = system.observable_names
    known = (*system.parameter_names, *system.state_names, *observables, *BUILT_IN, PATH)
    more = quantities.every_extreme(system.state_names)
    what = "neither a parameter, a state nor an observable"
    if key[-1] in SAMPLE_FIGURES:
        known, more, what = system.state_names, (), "not a state"
    if key[-1] in MOTION_FIGURES:
        known, more = (*system.state_names, *system.signal_names), ()
        what = "neither a state nor a signal" if system.signals else "not a state"
    if isinstance(options.y, tuple) and key[-1] != "time_series":
        problems.add((*key, "y"), f"'{key[-1]}' shows one quantity.", "Give one name.")
        return
    if options.z is not None and key[-1] != "phase_portrait":
        problems.add((*key, "z"), f"'{key[-1]}' has no third axis.", "Remove it.")
    _check_limits(problems, key, options)
    for name, wanted in (("full", options.full), ("together", options.together)):
        if wanted is not None and key[-1] != "multipliers":
            problems.add((*key, name), f"'{key[-1]}' has no {name}.", "It belongs to multipliers.")
    given = {"x": options.x, "y": options.y, "z": options.z}
    for axis, name in ((axis, name) for axis, names in given.items() for name in listed(names)):
        if name not in (*known, *more):
            problems.add(
                (*key, axis),
                f"'{name}' is {what} of '{system.name}'.",
                allowed(tuple(dict.fromkeys(known)), name),
            )


def _check_limits(problems: Problems, key: Key, options: FigureOptions) -> None:
    for name, limits in (("xlim", options.xlim), ("ylim", options.ylim)):
        if limits is None:
            continue
        if key[-1] != "bifurcation_diagram":
            problems.add((*key, name), f"'{key[-1]}' has no {name}.", "Remove it.")
        elif len(limits) != 2 or not limits[0] < limits[1]:
            shown = ", ".join(f"{value:.12g}" for value in limits)
            problems.add((*key, name), f"is [{shown}].", "Allowed: two numbers, the smaller one first.")
