"""A motion as a file: what it passed through, and what happened on the way. `docs/schema.md` describes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from contwalk.errors import DatabaseError
from contwalk.files.drafts import drafted
from contwalk.storage.failures import check_input, creating, failures_of
from contwalk.storage.hdf5_file import stated_form, whole_number
from contwalk.storage.known_keys import Header
from contwalk.storage.plain_file import PlainFile
from contwalk.storage.schema import FORMAT, encode
from contwalk.storage.seal import append_seal
from contwalk.storage.snapshot import open_snapshot

TRAJECTORY = "contwalk trajectory"
SAMPLES = "contwalk samples"
MARGINS = "contwalk margins"
VERSION = 1
_COMMANDS = {TRAJECTORY: "simulate", SAMPLES: "sample", MARGINS: "margins"}


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A computed motion.

    Parameters
    ----------
    system : str
    states : tuple of str
        Names of the columns.
    parameters : mapping
        Values of all parameters.
    times, values : ndarray, shapes (k,) and (k, n)
        At a transition its instant twice, with the states on both sides.
    event_names : tuple of str
        Of the events in the order of time; `event_times` (e,), `event_rising` (e,), the states
        `event_before` and `event_after` (e, n), and `event_modes`, the modes after them, belong to them.
    status : str
        `ok` or why it ended early.
    header : mapping
        The run file's text as `config`, and `provenance`.
    modes : ndarray of int, shape (k,)
        Which mode the motion is in, as a position in `mode_names`.
    mode_names : tuple of str
    """

    system: str
    states: tuple[str, ...]
    parameters: Mapping[str, float]
    times: np.ndarray
    values: np.ndarray
    event_names: tuple[str, ...]
    event_times: np.ndarray
    event_rising: np.ndarray
    event_before: np.ndarray
    event_after: np.ndarray
    event_modes: tuple[str, ...]
    modes: np.ndarray
    mode_names: tuple[str, ...]
    status: str = "ok"
    header: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Samples:
    """Measured numbers of many motions, with what each began from.

    Parameters
    ----------
    system : str
    drawn : tuple of str
        Names of the columns of `draws` (k, d): drawn states and parameters.
    measured : str
        What `values` (k,) are, with their unit; NaN where nothing could be measured.
    settled, crossed : ndarray of bool, shape (k,)
        Whether the motion came to rest; whether the level was crossed at all.
    ends : ndarray, shape (k,)
        The time at which it settled or was given up, in the same unit.
    header : mapping
    """

    system: str
    drawn: tuple[str, ...]
    measured: str
    draws: np.ndarray
    values: np.ndarray
    settled: np.ndarray
    crossed: np.ndarray
    ends: np.ndarray
    header: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Margins:
    """How far a solution may be pushed.

    Parameters
    ----------
    system : str
    states : tuple of str
        Names of all states.
    rows : tuple of mapping
        One for each state and sign at each instant: `number`, `instant`, `fraction`, `state`, `sign`,
        `vector` (the push of size 1), `border` (None where none was met), `several`, `borders`, `ends`,
        `simulations`, `farthest` (the largest push that was tried; NaN in older files).
    instants : tuple of mapping
        `fraction` of the closure, `time`, `mode` and `state`, a list of n numbers.
    header : mapping
    basin : mapping
        Empty where none was asked for: `states`, the names of the two, `places`, ndarray of shape (k, 2), and
        `labels`, a tuple of what each comes to.
    """

    system: str
    states: tuple[str, ...]
    rows: tuple[Mapping[str, Any], ...]
    instants: tuple[Mapping[str, Any], ...]
    header: Mapping[str, Any] = field(default_factory=dict)
    basin: Mapping[str, Any] = field(default_factory=dict)


def write_trajectory(path: Path, trajectory: Trajectory, new: bool = False) -> Path:
    """Write a motion; a file that exists is replaced when the new one is complete, or kept if it is `new`.

    Raises
    ------
    DatabaseError
        If it cannot be written, or would go over another.
    """

    def fill(file: h5py.File) -> None:
        file["times"] = trajectory.times
        file["values"] = trajectory.values
        file["values"].attrs["states"] = list(trajectory.states)
        file["modes"] = trajectory.modes
        file["modes"].attrs["names"] = list(trajectory.mode_names)
        events = file.create_group("events")
        events["name"] = np.array(trajectory.event_names, dtype=h5py.string_dtype())
        events["mode"] = np.array(trajectory.event_modes, dtype=h5py.string_dtype())
        for name in ("times", "rising", "before", "after"):
            events[name] = getattr(trajectory, f"event_{name}")
        file.attrs["parameters"] = encode(dict(trajectory.parameters), "the parameters")
        file.attrs["status"] = trajectory.status

    return _written(path, TRAJECTORY, trajectory.system, trajectory.header, fill, new)


def read_trajectory(path: str | Path) -> Trajectory:
    """Read a motion.

    Raises
    ------
    DatabaseError
        If the file is missing, damaged, or of something else.
    """

    def take(file: PlainFile) -> Trajectory:
        mode_names = file.names("modes", "names", "modes")
        return Trajectory(
            system=file.text("system"),
            states=file.names("values", "states", "n"),
            parameters=file.mapping("parameters", Mapping[str, float]),
            times=file.array("times", "k"),
            values=file.array("values", "k n"),
            modes=_places(file.array("modes", "k", "iu"), len(mode_names)),
            mode_names=mode_names,
            event_names=tuple(file.texts("events/name", "e")),
            event_modes=tuple(file.texts("events/mode", "e")),
            event_times=file.array("events/times", "e"),
            event_rising=file.array("events/rising", "e", "b"),
            event_before=file.array("events/before", "e n"),
            event_after=file.array("events/after", "e n"),
            status=file.text("status"),
            header=file.mapping("header", Header),
        )

    return _read(path, TRAJECTORY, take)


def write_samples(path: Path, samples: Samples) -> Path:
    """Write samples; a file that exists is replaced when the new one is complete."""

    def fill(file: h5py.File) -> None:
        for name in ("draws", "values", "settled", "crossed", "ends"):
            file[name] = getattr(samples, name)
        file["draws"].attrs["names"] = list(samples.drawn)
        file["values"].attrs["measured"] = samples.measured

    return _written(path, SAMPLES, samples.system, samples.header, fill)


def read_samples(path: str | Path) -> Samples:
    """Read samples; `DatabaseError` as for `read_trajectory`."""

    def take(file: PlainFile) -> Samples:
        return Samples(
            system=file.text("system"),
            drawn=file.names("draws", "names", "d"),
            measured=file.text("measured", "values"),
            draws=file.array("draws", "k d"),
            values=file.array("values", "k"),
            settled=file.array("settled", "k", "b"),
            crossed=file.array("crossed", "k", "b"),
            ends=file.array("ends", "k"),
            header=file.mapping("header", Header),
        )

    return _read(path, SAMPLES, take)


def write_margins(path: Path, margins: Margins) -> Path:
    """Write margins; a file that exists is replaced when the new one is complete."""
    rows, text = margins.rows, h5py.string_dtype()

    def fill(file: h5py.File) -> None:
        for name in ("instant", "sign", "simulations", "several", "farthest"):
            file[name] = np.array([row[name] for row in rows])
        vectors = [row["vector"] for row in rows]
        file["vector"] = np.array(vectors, dtype=float).reshape(len(rows), len(margins.states))
        file["border"] = np.array([np.nan if row["border"] is None else row["border"] for row in rows])
        for name in ("state", "ends"):
            file[name] = np.array([row[name] for row in rows], dtype=text)
        found = [border for row in rows for border in row["borders"]]
        file["borders/value"] = np.array(found, dtype=float)
        file["borders/row"] = np.array([k for k, row in enumerate(rows) for _ in row["borders"]], dtype=int)
        instants = file.create_group("instants")
        for name in ("fraction", "time", "state"):
            instants[name] = np.array([entry[name] for entry in margins.instants], dtype=float)
        instants["mode"] = np.array([entry["mode"] for entry in margins.instants], dtype=text)
        instants["state"].attrs["states"] = list(margins.states)
        if margins.basin:
            file["basin/places"] = margins.basin["places"]
            file["basin/places"].attrs["states"] = list(margins.basin["states"])
            file["basin/labels"] = np.array(margins.basin["labels"], dtype=text)

    return _written(path, MARGINS, margins.system, margins.header, fill)


def read_margins(path: str | Path) -> Margins:
    """Read margins; `DatabaseError` as for `read_trajectory`."""

    def take(file: PlainFile) -> Margins:
        fractions, times = (file.array(f"instants/{name}", "i").tolist() for name in ("fraction", "time"))
        modes, states = file.texts("instants/mode", "i"), file.array("instants/state", "i n").tolist()
        instant = _places(file.array("instant", "r", "iu"), len(times))
        border, unknown = file.array("border", "r"), np.full(len(instant), np.nan)
        columns: dict[str, list[Any]] = {
            "instant": instant.tolist(),
            "sign": file.array("sign", "r", "fi").tolist(),
            "simulations": file.array("simulations", "r", "iu").tolist(),
            "several": file.array("several", "r", "b").tolist(),
            "state": file.texts("state", "r"),
            "ends": file.texts("ends", "r"),
            "farthest": (file.array("farthest", "r") if "farthest" in file else unknown).tolist(),
            "border": [None if np.isnan(value) else value for value in border.tolist()],
        }
        if "vector" in file:  # older files have only pushes of one state
            columns["vector"] = file.array("vector", "r n").tolist()
        borders: dict[int, list[float]] = {}
        of_rows = _places(file.array("borders/row", "b", "iu"), len(instant))
        for row, value in zip(of_rows.tolist(), file.array("borders/value", "b").tolist(), strict=True):
            borders.setdefault(row, []).append(value)
        rows = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
        return Margins(
            system=file.text("system"),
            states=file.names("instants/state", "states", "n"),
            rows=tuple(
                {"number": k, **row, "fraction": fractions[row["instant"]], "borders": borders.get(k, [])}
                for k, row in enumerate(rows)
            ),
            instants=tuple(
                {"fraction": f, "time": t, "mode": mode, "state": state}
                for f, t, mode, state in zip(fractions, times, modes, states, strict=True)
            ),
            header=file.mapping("header", Header),
            basin=_basin(file),
        )

    return _read(path, MARGINS, take)


def _places(found: np.ndarray, count: int) -> np.ndarray:
    """Numbers of things of which there are `count`."""
    if len(found) and not 0 <= found.min() <= found.max() < count:
        raise ValueError("it names what is not there")
    return found


def is_of_margins(path: str | Path) -> bool:
    """Whether a file is one that `contwalk margins` has written; no for what is none that can be read."""
    try:
        return _stated(Path(path)) == MARGINS
    except DatabaseError:
        return False


def _basin(file: PlainFile) -> dict[str, Any]:
    if "basin" not in file:
        return {}
    return {
        "states": file.names("basin/places", "states", "two"),
        "places": file.array("basin/places", "points two"),
        "labels": tuple(file.texts("basin/labels", "points")),
    }


def _written(
    path: Path,
    form: str,
    system: str,
    header: Mapping[str, Any],
    fill: Callable[[h5py.File], None],
    new: bool = False,
) -> Path:
    """A whole file beside the old one, then in its place."""

    def opened(name: Path) -> h5py.File:
        return h5py.File(name, "x", locking=False)  # its own lock would be in the way of the draft's

    with creating(path):
        with drafted(path, opened, new) as draft:
            with draft.file as file:
                file.attrs["format"] = form
                file.attrs["schema_version"] = VERSION
                file.attrs["system"] = system
                file.attrs["header"] = encode(dict(header), "the header")
                fill(file)
            append_seal(draft.path)
        draft.lock.release()
    return path


def _stated(path: Path) -> str:
    """What a file tells to be; empty for one of another program."""
    check_input(path)
    with failures_of(path, "read"), open_snapshot(path) as file:
        return stated_form(file)


def _read(path: str | Path, form: str, take: Callable[[PlainFile], Any]) -> Any:
    path = Path(path)
    check_input(path)
    with failures_of(path, "read"), open_snapshot(path) as file:
        stated, version = stated_form(file), 0
        if stated == form:
            version = whole_number(file, "schema_version")
            if version == VERSION:
                return take(PlainFile(file))
    if stated == form:
        raise DatabaseError(
            f"{path} has version {version} of its format; this contwalk reads version {VERSION}.",
            "Read it with the newer contwalk that wrote it: pip install --upgrade contwalk",
        )
    what, command = form.removeprefix("contwalk "), _COMMANDS[form]
    known = {each: f"it is {each}" for each in _COMMANDS} | {FORMAT: "it is a database of branches"}
    raise DatabaseError(
        f"{path} holds no {what}: {known.get(stated, 'it is an HDF5 file of another program')}.",
        f"Name a file that contwalk {command} has written.",
    )
