"""A run file as `contwalk margins` reads it: the section `margins`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from contwalk.errors import RunFileError
from contwalk.system import System
from contwalk.workflow.file_names import database_named, output_of
from contwalk.workflow.run_file.checked_file import CheckedFile
from contwalk.workflow.run_file.document import Document, Key
from contwalk.workflow.run_file.motions import Margins
from contwalk.workflow.run_file.parameters import numbers_of
from contwalk.workflow.run_file.problems import Problems, allowed
from contwalk.workflow.run_file.reading import opened
from contwalk.workflow.run_file.starts import POINT
from contwalk.workflow.run_file.text import text_of_file

# Names of directions that are not given.
_DRAWN = re.compile(r"(mode|random)\d+(_re|_im)?")


@dataclass(frozen=True, eq=False, kw_only=True)
class MarginsFile(CheckedFile):
    """A checked run file for margins.

    Parameters
    ----------
    model, parameters : mapping
        What the file says of them; `parameters` must be those of the point.
    database : Path
        Where the point is.
    margins : Margins
        The section itself.
    document : Document
        Where each key stands.
    """

    model: dict[str, object]
    parameters: dict[str, float]
    database: Path
    margins: Margins
    document: Document

    def refusal(self, key: Key, sentence: str, remedy: str) -> RunFileError:
        """What is wrong with a key, and turns out when what it names is looked at."""
        return RunFileError(f"{self.document.where(key)}: {sentence}", remedy)


def read_margins(path: str | Path, overrides: Sequence[str] = (), output: str | None = None) -> MarginsFile:
    """Read and check a run file for `contwalk margins`.

    Raises
    ------
    RunFileError
        For every problem, with file, line and key.
    """
    text = text_of_file(Path(path), str(path))
    problems, model, system = opened(text, path, overrides)
    wanted = model.margins
    if wanted is None:
        problems.add(
            ("margins",),
            "the key is missing.",
            "Say which motion is pushed: {of: {from: walker.h5, point: b1/UZ1}, survive: {periods: 20}}.",
        )
        raise problems.error()
    if not POINT.fullmatch(wanted.of.point):
        problems.add(
            ("margins", "of", "point"),
            f"is '{wanted.of.point}'.",
            "Allowed: a branch and a point, b1/UZ1 or b1/12.",
        )
    if not wanted.states:
        problems.add(("margins", "states"), "is empty.", allowed(("all", *system.state_names)))
    for name in () if wanted.states == ("all",) else wanted.states:
        if name not in system.state_names:
            problems.add(
                ("margins", "states"),
                f"'{name}' is not a state of '{system.name}'.",
                allowed(system.state_names, name),
            )
    _check_repeated(problems, "states", wanted.states)
    if not isinstance(wanted.instants, int):
        _check_repeated(problems, "instants", wanted.instants)
    for name, shares in wanted.directions.items():
        _check_direction(problems, system, name, shares)
    if wanted.basin is not None:
        _check_basin(problems, system, wanted)
    if wanted.survive.periods is not None and wanted.survive.time is not None:
        problems.add(("margins", "survive"), "gives both periods and time.", "Give one of them.")
    for name in model.parameters:
        if name not in system.parameter_names:
            problems.add(
                ("parameters", name),
                f"'{name}' is not a parameter of '{system.name}'.",
                allowed(system.parameter_names, name),
            )
    problems.raise_any()
    return MarginsFile(
        path=Path(path),
        text=text,
        overrides=tuple(overrides),
        system_reference=model.system,
        system=system,
        model=dict(system.model),
        parameters=numbers_of(model),
        database=database_named(Path(path).parent, str(wanted.of.from_)),
        margins=wanted,
        output=output_of(path, output, model.output),
        document=problems.document,
    )


def _check_repeated(problems: Problems, key: str, given: Sequence[object]) -> None:
    """Each is pushed once: a second row would be the first."""
    twice = [value for k, value in enumerate(given) if value in given[:k]]
    if twice:
        problems.add(("margins", key), f"has {twice[0]} twice.", "Give each once.")


def _check_direction(problems: Problems, system: System, name: str, shares: Mapping[str, float]) -> None:
    key = "margins", "directions", name
    taken = name in system.state_names or _DRAWN.fullmatch(name) is not None
    if taken or not name.isidentifier():
        what = (
            "is the name of a state, or one that modes and drawn directions have" if taken else "is no name"
        )
        problems.add(key, f"{what}.", "Give the direction another name, of letters, digits and _.")
    for state in shares:
        if state not in system.state_names:
            problems.add(
                (*key, state),
                f"'{state}' is not a state of '{system.name}'.",
                allowed(system.state_names, state),
            )
    if not any(shares.values()):
        problems.add(key, "pushes nothing.", "Give the share of at least one state: {x: 1.0, v: -0.5}.")


def _check_basin(problems: Problems, system: System, wanted: Margins) -> None:
    key, basin = ("margins", "basin"), wanted.basin
    assert basin is not None
    if len(basin.states) != 2:
        problems.add(
            (*key, "states"), f"names {len(basin.states)} states.", "Give two: {x: [-2, 2], v: [-1, 1]}."
        )
    for name, (low, high) in basin.states.items():
        if name not in system.state_names:
            what = f"'{name}' is not a state of '{system.name}'."
            problems.add((*key, "states", name), what, allowed(system.state_names, name))
        elif set(low.names) | set(high.names):
            problems.add((*key, "states", name), "names a parameter.", "Give numbers, lowest first.")
        elif not low.value({}) < high.value({}):
            problems.add((*key, "states", name), f"is [{low.text}, {high.text}].", "Give [lowest, highest].")
    count = wanted.instants if isinstance(wanted.instants, int) else len(wanted.instants)
    if basin.instant >= count:
        problems.add(
            (*key, "instant"), f"is {basin.instant}, and there are {count}.", "They are numbered from 0."
        )
