"""What `cw.diagram` computes: a run in a file of its own, and what Ctrl-C leaves for the same call."""

from __future__ import annotations

import atexit
import io
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.errors import Interrupted, StartError
from contwalk.number_words import plural
from contwalk.storage import open_database
from contwalk.system import System
from contwalk.workflow.reporter import NoteKeeper
from contwalk.workflow.run_file.form import study_of
from contwalk.workflow.run_file.reading import read_run_text
from contwalk.workflow.runner import RunResult, run

NOTHING_KEPT = "Interrupted before the first point: nothing is kept."
# What Ctrl-C has stopped, by what was asked for. The system stays too, since its reference may be its `id`.
_STOPPED: dict[str, tuple[Path, System]] = {}


@dataclass(frozen=True)
class Computed:
    """A database that is computed.

    Parameters
    ----------
    path : Path
    folder : Path, optional
        What is removed with it; None where the file is the user's own.
    moved : str
        How far the start was from the first solution, in words.
    """

    path: Path
    folder: Path | None
    moved: str


def begins_so(path: Path, data: Mapping[str, Any]) -> bool:
    """Whether a stored run has the start of a run file."""
    with open_database(path) as stored:
        before = study_of(stored.header.config)
    return before is not None and before["start"] == (study_of(_plain(data)) or before)["start"]


def computed(
    system: System, data: Mapping[str, Any], told: NoteKeeper, output: Path | None
) -> Computed | str:
    """The database of a run file; where its start leads to nothing, a sentence.

    Parameters
    ----------
    system : System
    data : mapping
        The run file.
    told : NoteKeeper
    output : Path, optional
        The file; one that exists is gone on with.

    Raises
    ------
    Interrupted
        After Ctrl-C. Without an `output` what was found is kept for a call that asks for the same.
    """
    text = _yaml(data)
    asked = text + system.source
    folder = None if output is not None else _STOPPED.pop(asked, (None,))[0] or _new_folder()
    path = folder / f"{system.name}.h5" if folder is not None else Path(output or "")
    going_on, kept = path.exists(), False
    try:
        run_file = read_run_text(text, Path("cw.diagram"), output=str(path))
        result = _run_or_none(run_file, going_on, told)
        if result is None or result.interrupted:
            points = _points(path)
            kept = points > 0
            if kept and folder is not None:
                _STOPPED[asked] = folder, system
            told.interrupted("Interrupted:")
            raise Interrupted(_told_stop(path, points, folder is None))
        failed = [branch for branch in result.branches if not len(branch)]
        if len(failed) == len(result.branches):
            return failed[0].outcome.message if failed else "there is no branch."
        kept = True
        return Computed(path, folder, _moved(data, result.branches[0], run_file.accuracy))
    except StartError as error:
        return str(error)
    finally:
        if not kept and folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
        elif not kept and not going_on:
            path.unlink(missing_ok=True)


def _new_folder() -> Path:
    """A folder that this process does not leave behind."""
    folder = Path(tempfile.mkdtemp(prefix="contwalk-"))
    atexit.register(shutil.rmtree, folder, True)
    return folder


def _run_or_none(run_file: Any, going_on: bool, told: NoteKeeper) -> RunResult | None:
    """What a run leaves; None where Ctrl-C comes beside the computing itself."""
    try:
        return run(run_file, resume=going_on, figures=False, reporter=told)
    except KeyboardInterrupt:
        return None


def _points(path: Path) -> int:
    """How many points a file has, if there is one."""
    if not path.exists():
        return 0
    with open_database(path) as stored:
        return sum(map(len, stored))


def _told_stop(path: Path, points: int, own: bool) -> str:
    if not points:
        return NOTHING_KEPT
    again = "the same call with resume=True" if own else "the same call"
    kept = f"Interrupted. {plural(points, 'point')} are kept, and {again} goes on from there. "
    return f"{kept}Until then cw.open_database('{path}') shows them."


def _moved(data: Mapping[str, Any], branch: Branch, accuracy: float) -> str:
    """How far a start that was given as a state lies from the solution that it led to."""
    given = data["start"].get("state")
    free = data["continue"]["parameter"]
    if not given or branch.info.problem != "equilibrium" or not len(branch):
        return ""
    value = data.get("parameters", {}).get(free)
    if value is None:
        value = branch.info.parameters.get(free)
    rows = np.abs(branch[free] - value) if value is not None else np.zeros(len(branch))
    row = int(np.argmin(rows))
    moves = {name: float(branch[name][row]) - value for name, value in given.items()}
    name = max(moves, key=lambda each: abs(moves[each]))
    seen = abs(moves[name]) > accuracy * max(1.0, abs(given[name]))
    return f"{name} moved by {moves[name]:.3g}" if seen else ""


def _yaml(data: Mapping[str, Any]) -> str:
    from ruamel.yaml import YAML

    yaml = YAML(pure=True)
    yaml.default_flow_style = None
    stream = io.StringIO()
    yaml.dump(_plain(data), stream)
    return stream.getvalue()


def _plain(value: Any) -> Any:
    """A value in the kinds that YAML has."""
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, list | tuple | set | frozenset | type(range(0))):
        return [_plain(each) for each in value]
    return str(value) if isinstance(value, Path) else value
