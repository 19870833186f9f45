"""From the `start` entries of a run file to starts of the diagram."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.continuation.opening import opened
from contwalk.continuation.settings import Settings
from contwalk.continuation.work import Start
from contwalk.errors import StartError
from contwalk.problems.orbit.discretization import Discretization
from contwalk.storage.hdf5 import Hdf5Database
from contwalk.workflow.run_file import RunFile, StartSpec


@dataclass(frozen=True)
class Place:
    """A state to start from, with the values of all parameters there.

    `orbit` says that it lies on a periodic orbit, of `period` seconds; with `until` a simulation finds it.
    """

    state: np.ndarray
    parameters: dict[str, float]
    origin: str
    period: float | None = None
    until: float | str | None = None
    orbit: bool = False


def places(run_file: RunFile) -> tuple[list[Place], list[str]]:
    """All states that a study starts from, and notes on what does not exist.

    Raises
    ------
    StartError
        For a start that does not exist, or a point of another database that cannot be read.
    """
    found: list[Place] = []
    notes: list[str] = []
    for spec in run_file.starts:
        try:
            found += _places(run_file, spec)
        except StartError as error:
            if not spec.optional:
                where = f"{run_file.path}, line {spec.line}, key start: " if spec.line else ""
                raise StartError(f"{where}{error.sentence}", error.remedy) from error
            notes.append(error.sentence)
    if not found:
        raise StartError(f"{run_file.path}: nothing to start from. {' '.join(notes)}", "Change `start`.")
    return found, notes


def _places(run_file: RunFile, spec: StartSpec) -> list[Place]:
    parameters = dict(spec.parameters)
    if spec.kind == "equilibrium":
        name = str(spec.name)
        states = run_file.system.named_states(name, parameters)
        several = len(states) > 1
        return [
            Place(x, parameters, f"equilibrium {name}" + (f" ({i})" if several else ""))
            for i, x in enumerate(states, start=1)
        ]
    if spec.kind == "state" and spec.state is not None:
        return [Place(spec.state, parameters, "the given state")]
    if spec.kind == "from":
        return [_stored_place(run_file, spec)]
    assert spec.state is not None
    return [Place(spec.state, parameters, "the simulation", until=spec.until or "settled", orbit=True)]


def _stored_place(run_file: RunFile, spec: StartSpec) -> Place:
    """A point of another database; its parameters, changed by those the run file gives."""
    assert spec.file is not None
    assert spec.point is not None
    names = run_file.system.state_names
    with Hdf5Database.open(spec.file) as db:
        branch_name, point_name = spec.point.split("/")
        branch = db.branch(branch_name)
        if branch.info.states != names:
            raise StartError(
                f"{spec.file} holds states {', '.join(branch.info.states)}, not {', '.join(names)}.",
                "Start from a database of the same system and model.",
            )
        if point_name.isdigit():
            if int(point_name) >= len(branch):
                raise StartError(
                    f"Branch {branch_name} of {spec.file} has {len(branch)} points, numbered from 0.",
                    "Give one of them.",
                )
            row = branch.points[int(point_name)]
            state, period = np.array(row["state"]), float(row["period"])
            stored = {**branch.info.parameters, **dict(zip(branch.info.free, row["free"], strict=True))}
        else:
            try:
                point = branch.special(point_name)
            except KeyError as error:
                raise StartError(str(error.args[0]), f"In {spec.file}.") from error
            state = np.array([point.state[name] for name in names])
            period = float(point.period or np.nan)
            stored = dict(point.parameters)
    fold = int(branch.info.settings.get("fold", 1))
    known = {k: float(v) for k, v in stored.items() if k in run_file.system.parameter_names}
    parameters = {**run_file.system.defaults(), **known, **spec.given}
    low, high = run_file.range
    if run_file.parameter_path is None and not low <= parameters[run_file.free] <= high:
        raise StartError(
            f"{spec.point} of {spec.file} has {run_file.free} = {parameters[run_file.free]:.10g}, "
            f"outside the range [{low:g}, {high:g}].",
            "Widen continue.range, or start from another point.",
        )
    origin = f"{spec.point} of {spec.file.name}"
    if not np.isfinite(period):
        return Place(state, parameters, origin)
    return Place(state, parameters, origin, period=fold * period, orbit=True)


def starts(
    run_file: RunFile, found: list[Place], settings: Settings, discretization: Discretization
) -> Iterator[Start]:
    """Starts of the diagram, each corrected to a solution when its turn comes."""
    at = run_file.range[0] if run_file.parameter_path is not None else None
    system, free, path = run_file.system, run_file.free, run_file.parameter_path
    for place in found:
        given = system, place.parameters, free, place.state, settings, path, at, discretization
        if place.orbit or system.period is not None:
            from contwalk.continuation.opening_orbits import opened_orbit  # compiled flows

            opening = opened_orbit(*given, place.period, place.until)
        else:
            opening = opened(*given)
        yield Start(system, free, place.parameters, opening, place.origin)
