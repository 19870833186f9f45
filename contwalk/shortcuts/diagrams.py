"""`cw.diagram`: a whole study in one call, and what it has found as one object."""

from __future__ import annotations

import hashlib
import io
import shutil
import tempfile
import weakref
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk import tables
from contwalk.branch import Branch, SpecialPoint
from contwalk.branch_words import small_diagram, table_of_branches, told_branch
from contwalk.equations.loading import PREFIX, is_equations
from contwalk.errors import ContwalkError, StartError
from contwalk.figure_formats import FORMATS
from contwalk.plugin_check.at_load import load_system
from contwalk.storage import open_database
from contwalk.storage.file_database import FileDatabase
from contwalk.system import System
from contwalk.system.loading import made
from contwalk.system.names import nearest
from contwalk.workflow.run_file.reading import read_run_text
from contwalk.workflow.runner import Reporter, run

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def diagram(
    system: System | str | Path,
    parameter: str,
    range: Sequence[float],
    *,
    start: Mapping[str, Any] | None = None,
    parameters: Mapping[str, float] | None = None,
    **run_file_keys: Any,
) -> DiagramFound:
    """Compute what a run file with its defaults computes.

    Parameters
    ----------
    system : System, str or Path
        A system, an installed one's name, or a plugin file.
    parameter : str
        The parameter that varies, within `range`.
    range : pair of float
    start : mapping, optional
        Values of states, `{"x": 1.0}`, or a start as a run file has it, `{"simulate": {...}}`. Without one:
        the start that the system declares, else where the motion from the origin settles; `start` of what
        comes back says which.
    parameters : mapping, optional
        Values of others than the defaults.
    **run_file_keys
        Further keys of a run file: `diagram={"follow": ["HB"]}`, `accuracy=1e-10`, `mark=...`.

    Returns
    -------
    DiagramFound
        `d.plot("x")`, `d["b1"]` a branch, `d["b1/HB1"]` a special point, `d.save(path)`.

    Raises
    ------
    ContwalkError
        For bad input; and where no start leads to a solution, with what became of each.
    """
    loaded = system if isinstance(system, System) else load_system(system, run_file_keys.pop("model", None))
    if not loaded.loaded_from:
        loaded = made(loaded, hashlib.sha256(str(id(loaded)).encode()).hexdigest())
    data: dict[str, Any] = {"system": _reference(loaded)}
    if loaded.model:
        data["model"] = dict(loaded.model)
    place = _place(loaded, parameter, range, parameters or {})
    if parameters or place:
        data["parameters"] = {**(parameters or {}), **place}
    more = {"parameter": parameter, "range": list(range), **run_file_keys.pop("continue_", {})}
    data |= {"continue": more, **run_file_keys}
    tried: list[str] = []
    for words, given in _starts(loaded, start):
        at = "".join(f", at {name} = {value:g}" for name, value in place.items())
        found = _computed(loaded, {**data, "start": given}, words + at)
        if isinstance(found, DiagramFound):
            return found
        tried.append(f"{words}: {found}")
    raise StartError(
        f"No start of '{loaded.name}' leads to a solution. {' '.join(tried)}",
        'Give one, as start={"x": 1.0}.',
    )


def _place(
    system: System, parameter: str, range: Sequence[float], given: Mapping[str, float]
) -> dict[str, float]:
    """The end of the range that is nearer to the parameter's default, where that lies outside."""
    default = system.defaults().get(parameter)
    if parameter in given or default is None or len(range) != 2:
        return {}
    inside = min(max(default, float(range[0])), float(range[1]))
    return {} if inside == default else {parameter: inside}


def _reference(system: System) -> Any:
    reference = system.loaded_from
    return {"equations": reference.removeprefix(PREFIX)} if is_equations(reference) else reference


def _starts(system: System, given: Mapping[str, Any] | None) -> Iterator[tuple[str, dict[str, Any]]]:
    """The starts that are tried, each with its words."""
    names = system.state_names
    if given is not None:
        kinds = ("equilibrium", "state", "simulate", "from", "search")
        if any(key in kinds and key not in names for key in given):
            yield "the given start", dict(given)
            return
        for name in given:
            if name not in names:
                raise StartError(f"The start names '{name}', which is no state.", nearest(name, names))
        yield from _from_state(system, {**dict.fromkeys(names, 0.0), **given}, "the given state")
        return
    if system.study is not None and system.study.start is not None:
        yield "the start of the system's study", dict(system.study.start)
    for start in system.starts:
        yield f"the equilibrium '{start.name}'", {"equilibrium": start.name}
    if any(state.start is not None for state in system.states):
        declared = {state.name: float(state.start or 0.0) for state in system.states}
        yield from _from_state(system, declared, "the declared state")
    origin = dict.fromkeys(names, 0.0)
    yield "the simulation from the origin until settled", {"simulate": {"state": origin, "until": "settled"}}


def _from_state(
    system: System, state: Mapping[str, float], words: str
) -> Iterator[tuple[str, dict[str, Any]]]:
    """A state as a guess of an equilibrium, and as where a simulation begins; forced machines simulate."""
    existing = {name: float(state[name]) for name in _existing(system)}
    near = f"the solution near {words}", {"state": existing}
    settled = {"simulate": {"state": existing, "until": "settled"}}
    simulated = f"the simulation from {words} until settled", settled
    yield from (simulated, near) if system.period is not None or system.transitions else (near, simulated)


def _existing(system: System) -> list[str]:
    return [system.state_names[i] for i in system.states_of(system.modes[0].name)]


def _computed(system: System, data: Mapping[str, Any], words: str) -> DiagramFound | str:
    """What a run file finds; where its start leads to nothing, a sentence."""
    folder = Path(tempfile.mkdtemp(prefix="contwalk-"))
    keep = False
    try:
        told = _Told()
        path = folder / f"{system.name}.h5"
        run_file = read_run_text(_yaml(data), Path("cw.diagram"), output=str(path))
        result = run(run_file, figures=False, reporter=told)
        failed = [branch for branch in result.branches if not len(branch)]
        if len(failed) == len(result.branches):
            return failed[0].outcome.message if failed else "there is no branch."
        keep = True
        moved = _moved(data, result.branches[0], run_file.accuracy)
        return DiagramFound(system, path, words, told.notes, moved)
    except StartError as error:
        return str(error)
    finally:
        if not keep:
            shutil.rmtree(folder, ignore_errors=True)


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


class _Told(Reporter):
    """Keeps the notes of a run."""

    def __init__(self) -> None:
        self.notes: list[str] = []

    def note(self, text: str) -> None:
        self.notes.append(text)


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


class DiagramFound:
    """Branches and special points that `cw.diagram` has found.

    Attributes
    ----------
    start : str
        Where it began, in words.
    notes : list of str
        What was said of the run as a whole.
    database : FileDatabase
        All of it, as `cw.open_database` gives it.
    """

    def __init__(self, system: System, path: Path, start: str, notes: Sequence[str], moved: str) -> None:
        self.system, self.path = system, path
        self.start = f"{start} ({moved})" if moved else start
        self.notes = list(notes)
        self.database: FileDatabase = open_database(path, trust=True)
        self._axes: Axes | None = None
        weakref.finalize(self, shutil.rmtree, str(path.parent), True)

    @property
    def branches(self) -> list[Branch]:
        """All branches in their order."""
        return self.database.branches()

    @property
    def special_points(self) -> dict[str, SpecialPoint]:
        """All special points by their whole names, as `b1/HB1`."""
        return {f"{branch.name}/{point.name}": point for branch in self for point in branch.special_points}

    def __getitem__(self, name: str) -> Any:
        """A branch by its name, or a special point, as `b1/HB1`."""
        branch, _, point = str(name).partition("/")
        known = [found.name for found in self]
        if branch not in known:
            raise KeyError(f"There is no branch '{branch}'. Known: {', '.join(known)}.")
        return self.database[branch].special(point) if point else self.database[branch]

    def __iter__(self) -> Iterator[Branch]:
        return iter(self.branches)

    def __len__(self) -> int:
        return len(self.database)

    def __repr__(self) -> str:
        lines = [f"diagram of {self.system.name}, from {self.start}", *map(told_branch, self)]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        title = f"diagram of {self.system.name}, from {self.start}"
        return small_diagram(self.branches) + tables.html(title, table_of_branches(self.branches))

    def plot(
        self, y: str | None = None, x: str | None = None, ax: Axes | None = None, **options: Any
    ) -> Axes:
        """Draw the diagram: `y` over `x`, the free parameter by default.

        Parameters
        ----------
        y, x : str, optional
            A state, an observable or a parameter; of orbits largest and least values of a state are drawn.
        ax : Axes, optional
            Where to draw; new axes by default.
        **options
            Those of `cw.plot_bifurcation_diagram`.

        Returns
        -------
        Axes
            `axes.figure` is the figure, which `d.save("x.png")` writes as well.
        """
        from contwalk.plotting import plot_bifurcation_diagram, units_of

        units = options.pop("units", units_of(self.system))
        self._axes = plot_bifurcation_diagram(self.branches, x, y, ax, units=units, **options)
        return self._axes

    def save(self, path: str | Path) -> Path:
        """Write the database to a file, `x.h5`; or the figure that was drawn last, `x.png`.

        Raises
        ------
        ContwalkError
            If it cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() in FORMATS:
            from contwalk.plotting import save

            return save(self.plot() if self._axes is None else self._axes, target)
        if target.suffix.lower() not in (".h5", ".hdf5"):
            raise ContwalkError(
                f"'{target}' is neither a database nor a figure.", f"Allowed: .h5, {', '.join(FORMATS)}."
            )
        try:
            shutil.copyfile(self.path, target)
        except OSError as error:
            raise ContwalkError(
                f"{target} cannot be written: {error.strerror}.", "Choose another name."
            ) from None
        return target
