"""`cw.diagram`: a whole study in one call, and what it has found as one object."""

from __future__ import annotations

import hashlib
import shutil
import weakref
from collections.abc import Iterator, Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contwalk import tables
from contwalk.branch import Branch, SpecialPoint
from contwalk.branch_words import small_diagram, table_of_branches, told_branch
from contwalk.equations.loading import PREFIX, is_equations
from contwalk.errors import ContwalkError, StartError, interruptible
from contwalk.figure_formats import FORMATS
from contwalk.plugin_check.at_load import load_system
from contwalk.shortcuts.computing import NOTHING_KEPT, Computed, begins_so, computed
from contwalk.storage import open_database
from contwalk.storage.file_database import FileDatabase
from contwalk.system import System
from contwalk.system.loading import made
from contwalk.system.names import nearest
from contwalk.workflow.notebook_line import watcher
from contwalk.workflow.reporter import NoteKeeper

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def diagram(
    system: System | str | Path,
    parameter: str,
    range: Sequence[float],
    *,
    start: Mapping[str, Any] | None = None,
    parameters: Mapping[str, float] | None = None,
    output: str | Path | None = None,
    resume: bool = False,
    **run_file_keys: Any,
) -> DiagramFound:
    """Compute what a run file with its defaults computes.

    After Ctrl-C the same call goes on, to the same bits; in another process it does so with an `output`, and
    `resume`. In notebooks a line of the cell shows how far it is.

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
    output : str or Path, optional
        The database to write, `x.h5`. Without one it goes with the diagram, and `d.save` keeps it.
    resume : bool
        Go on with an output that exists.
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
    KeyboardInterrupt
        After Ctrl-C, with a sentence that says what is kept.
    """
    with interruptible(NOTHING_KEPT), watcher(_ends(range)) as told:
        target = _target(output, resume)
        return _diagram(system, parameter, range, start, parameters, target, run_file_keys, told)


def _target(output: str | Path | None, resume: bool) -> Path | None:
    if output is not None and Path(output).exists() and not resume:
        raise ContwalkError(f"{output} exists.", "Go on with it by resume=True, or give another output.")
    return None if output is None else Path(output)


def _ends(range: Sequence[float]) -> tuple[float, float]:
    """The range for who shows how far it is; empty where it is none, which reading it refuses."""
    numbers = [float(value) for value in range if isinstance(value, Real)]
    return (min(numbers), max(numbers)) if numbers else (0.0, 0.0)


def _diagram(
    system: System | str | Path,
    parameter: str,
    range: Sequence[float],
    start: Mapping[str, Any] | None,
    parameters: Mapping[str, float] | None,
    target: Path | None,
    run_file_keys: dict[str, Any],
    told: NoteKeeper,
) -> DiagramFound:
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
    starts, tried = list(_starts(loaded, start)), list[str]()
    if target is not None and target.exists():  # one of them was the run's; else it is refused
        starts = [each for each in starts if begins_so(target, {**data, "start": each[1]})] or starts[:1]
    for words, given in starts:
        at = "".join(f", at {name} = {value:g}" for name, value in place.items())
        found = computed(loaded, {**data, "start": given}, told, target)
        if isinstance(found, Computed):
            return DiagramFound(loaded, found, words + at, told.notes)
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

    def __init__(self, system: System, found: Computed, start: str, notes: Sequence[str]) -> None:
        self.system, self.path = system, found.path
        self.start = f"{start} ({found.moved})" if found.moved else start
        self.notes = list(notes)
        self.database: FileDatabase = open_database(self.path, trust=True)
        self._axes: Axes | None = None
        if found.folder is not None:
            weakref.finalize(self, shutil.rmtree, str(found.folder), True)

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
