"""A motion as a file: what it passed through, and what happened on the way. `docs/schema.md` describes it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from contwalk.errors import DatabaseError
from contwalk.files.drafts import drafted
from contwalk.storage.failures import check_input, creating, failures_of
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
        file.attrs["parameters"] = json.dumps(dict(trajectory.parameters))
        file.attrs["status"] = trajectory.status

    return _written(path, TRAJECTORY, trajectory.system, trajectory.header, fill, new)


def read_trajectory(path: str | Path) -> Trajectory:
    """Read a motion.

    Raises
    ------
    DatabaseError
        If the file is missing, damaged, or of something else.
    """

    def take(file: h5py.File) -> Trajectory:
        events = file["events"]
        return Trajectory(
            system=str(file.attrs["system"]),
            states=tuple(str(name) for name in file["values"].attrs["states"]),
            parameters=json.loads(file.attrs["parameters"]),
            times=file["times"][()],
            values=file["values"][()],
            modes=file["modes"][()],
            mode_names=tuple(str(name) for name in file["modes"].attrs["names"]),
            event_names=tuple(events["name"].asstr()[()]),
            event_modes=tuple(events["mode"].asstr()[()]),
            **{f"event_{name}": events[name][()] for name in ("times", "rising", "before", "after")},
            status=str(file.attrs["status"]),
            header=json.loads(file.attrs["header"]),
        )

    return _read(path, TRAJECTORY, take)


_ARRAYS = ("draws", "values", "settled", "crossed", "ends")


def write_samples(path: Path, samples: Samples) -> Path:
    """Write samples; a file that exists is replaced when the new one is complete."""

    def fill(file: h5py.File) -> None:
        for name in _ARRAYS:
            file[name] = getattr(samples, name)
        file["draws"].attrs["names"] = list(samples.drawn)
        file["values"].attrs["measured"] = samples.measured

    return _written(path, SAMPLES, samples.system, samples.header, fill)


def read_samples(path: str | Path) -> Samples:
    """Read samples; `DatabaseError` as for `read_trajectory`."""

    def take(file: h5py.File) -> Samples:
        return Samples(
            system=str(file.attrs["system"]),
            drawn=tuple(str(name) for name in file["draws"].attrs["names"]),
            measured=str(file["values"].attrs["measured"]),
            **{name: file[name][()] for name in _ARRAYS},
            header=json.loads(file.attrs["header"]),
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

    def take(file: h5py.File) -> Margins:
        borders: dict[int, list[float]] = {}
        for row, value in zip(
            file["borders/row"][()].tolist(), file["borders/value"][()].tolist(), strict=True
        ):
            borders.setdefault(row, []).append(value)
        instants = file["instants"]
        fractions, times = instants["fraction"][()].tolist(), instants["time"][()].tolist()
        modes, states = instants["mode"].asstr()[()].tolist(), instants["state"][()].tolist()
        columns = {name: file[name][()].tolist() for name in ("instant", "sign", "simulations", "several")}
        columns |= {name: file[name].asstr()[()].tolist() for name in ("state", "ends")}
        if "vector" in file:  # older files have only pushes of one state
            columns["vector"] = file["vector"][()].tolist()
        unknown = np.full(len(columns["sign"]), np.nan)
        columns["farthest"] = (file["farthest"][()] if "farthest" in file else unknown).tolist()
        columns["border"] = [None if np.isnan(value) else value for value in file["border"][()].tolist()]
        rows = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
        return Margins(
            system=str(file.attrs["system"]),
            states=tuple(str(name) for name in instants["state"].attrs["states"]),
            rows=tuple(
                {"number": k, **row, "fraction": fractions[row["instant"]], "borders": borders.get(k, [])}
                for k, row in enumerate(rows)
            ),
            instants=tuple(
                {"fraction": f, "time": t, "mode": mode, "state": state}
                for f, t, mode, state in zip(fractions, times, modes, states, strict=True)
            ),
            header=json.loads(file.attrs["header"]),
            basin=_basin(file),
        )

    return _read(path, MARGINS, take)


def is_of_margins(path: str | Path) -> bool:
    """Whether a file is one that `contwalk margins` has written; no for what is none that can be read."""
    try:
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("format") == MARGINS)
    except OSError:
        return False


def _basin(file: h5py.File) -> dict[str, Any]:
    if "basin" not in file:
        return {}
    places = file["basin/places"]
    return {
        "states": tuple(str(name) for name in places.attrs["states"]),
        "places": places[()],
        "labels": tuple(file["basin/labels"].asstr()[()]),
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
                file.attrs["header"] = json.dumps(dict(header))
                fill(file)
            append_seal(draft.path)
        draft.lock.release()
    return path


def _read(path: str | Path, form: str, take: Callable[[h5py.File], Any]) -> Any:
    path = Path(path)
    check_input(path)
    with failures_of(path, "read"), open_snapshot(path) as file:
        stated, version = file.attrs.get("format"), file.attrs.get("schema_version")
        if stated == form and version == VERSION:
            return take(file)
    if stated == form:
        raise DatabaseError(
            f"{path} has version {version} of its format; this contwalk reads version {VERSION}.",
            "Read it with the newer contwalk that wrote it: pip install --upgrade contwalk",
        )
    what, command = form.removeprefix("contwalk "), _COMMANDS[form]
    other = stated.decode(errors="replace") if isinstance(stated, bytes) else stated
    found = {None: "it is an HDF5 file of another program", "contwalk": "it is a database of branches"}
    raise DatabaseError(
        f"{path} holds no {what}: {found.get(other, f'it is {other}')}.",
        f"Name a file that contwalk {command} has written.",
    )
