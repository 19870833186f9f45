"""`contwalk simulate`: one motion with its events, as files and figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.errors import ContwalkError, NotFinite
from contwalk.numerics.threads import one_thread
from contwalk.problems.equilibrium.declared import named_equilibria
from contwalk.storage.csv_files import write_csv
from contwalk.system.falling import FALLEN
from contwalk.system.held import settled
from contwalk.workflow.made_with import made_with
from contwalk.workflow.quantities import listed, values_along
from contwalk.workflow.run_file.figures import FigureSpec
from contwalk.workflow.run_file.simulate import SimulationFile
from contwalk.workflow.run_file.starts import StartSpec

if TYPE_CHECKING:
    from contwalk.problems.stored_itinerary import StoredItinerary
    from contwalk.workflow.simulated import Simulated


@dataclass(frozen=True, eq=False)
class SimulationResult:
    """What a simulation left behind.

    Parameters
    ----------
    trajectory : storage.trajectory.Trajectory
    files, figures : list of Path
    settled : bool or None
        None where nobody asked.
    steps, evaluations : int
    reason : str
        Why the motion ended early, where more is known than the status says.
    note : str
        What to know of the start.
    """

    trajectory: Any
    files: list[Path]
    figures: list[Path]
    settled: bool | None
    steps: int
    evaluations: int
    reason: str = ""
    note: str = ""


@one_thread()
def simulate(
    run: SimulationFile,
    *,
    force: bool = False,
    figures: bool = True,
    progress: Callable[[float], None] | None = None,
) -> SimulationResult:
    """Integrate the motion that a run file describes, and write it.

    Parameters
    ----------
    run : SimulationFile
    force : bool
        Replace files that exist.
    figures : bool
        Draw the figures too.
    progress : callable, optional
        Told the time that has been reached.

    Raises
    ------
    ContwalkError
        For bad input, before anything is written.
    """
    from contwalk.storage.failures import refuse_existing
    from contwalk.storage.trajectory import write_trajectory

    names = [(spec, run.file(_figure_file(run, number))) for number, spec in enumerate(run.figures)]
    names = [(spec, _named(run, spec, path)) for spec, path in names] if figures else []
    tables = [run.file("trajectory.csv"), run.file("events.csv")]
    database = run.file("trajectory.h5")
    refuse_existing([database, *tables, *(path for _, path in names)], force)
    motion = moved(run, progress)
    trajectory = _trajectory(run, motion)
    write_trajectory(database, trajectory, new=not force)
    _write_tables(trajectory, tables)
    fine = trajectory
    if motion.drawn is not None:
        fine = replace(trajectory, **dict(zip(("times", "values", "modes"), motion.drawn, strict=True)))
    drawn = [_drawn(run, spec, path, fine) for spec, path in names]
    counts = motion.settled, motion.steps, motion.evaluations
    return SimulationResult(trajectory, [database, *tables], drawn, *counts, motion.reason, motion.note)


def moved(run: SimulationFile, progress: Callable[[float], None] | None = None) -> Simulated:
    """The motion that a run file describes; nothing is written.

    `progress` is told the time that has been reached.

    Raises
    ------
    ContwalkError
        For a start that is none, and a field without a value there.
    """
    state, parameters, itinerary = start_of(run.system, run.start)
    parameters = settled(run.system, parameters)
    report = progress or (lambda t: None)
    if run.iterates:
        from contwalk.workflow.simulating_maps import iterated

        if itinerary is not None:
            from contwalk.workflow.simulating_hybrid import on_orbit

            state = on_orbit(run.system, itinerary).state
        number, points = math.floor(float(run.simulation.until)), run.simulation.points
        motion = iterated(run.system, parameters, state + run.perturbation, number, points, report)
    elif run.smooth:
        motion = _smoothly(run, state + run.perturbation, parameters, report)
    else:
        motion = _through_transitions(run, state, itinerary, parameters, report)
    return replace(motion, parameters=parameters)


def start_of(system: Any, spec: StartSpec) -> tuple[np.ndarray, dict[str, float], StoredItinerary | None]:
    """The state that a motion begins with, all parameters, and the itinerary of a stored hybrid orbit.

    Raises
    ------
    StartError
        For an equilibrium that does not exist there, and a stored point that cannot be read.
    """
    parameters = dict(spec.parameters)
    if spec.state is not None:
        return np.array(spec.state, dtype=float), parameters, None
    if spec.kind == "from":
        from contwalk.workflow.stored.points import stored_point

        assert spec.file is not None
        with spec.errors_placed():
            found = stored_point(spec.file, str(spec.point), system)
        return found.state, {**found.parameters, **spec.given}, found.itinerary
    with spec.errors_placed():
        states = named_equilibria(system, str(spec.name), parameters)
    return np.array(states[0], dtype=float), parameters, None


def _smoothly(
    run: SimulationFile, state: np.ndarray, parameters: Mapping[str, float], progress: Callable[[float], None]
) -> Simulated:
    """The motion of a machine of one mode, on which nothing acts but its field."""
    from contwalk.flow import dense
    from contwalk.flow.events.motion import magnitudes, segment_parts
    from contwalk.flow.hybrid.functions_without_value import line_without_value
    from contwalk.workflow.simulated import LONGEST, PARTS, Simulated, drawn_at, settling_of

    system, settings = run.system, run.simulation
    machine = _machine(run, parameters)
    if not np.isfinite(machine.field(0.0, state, machine.c)).all():
        mode = system.modes[0]
        functions = {f"field of mode '{mode.name}'": mode.field}
        blame = line_without_value(system, mode.name, functions, 0.0, state, parameters)
        raise NotFinite(
            f"The field is not finite at the start.{blame}", "Start elsewhere, or mend the plugin."
        )
    settles = settings.until == "settled"
    end = np.inf if settles else float(settings.until)
    weights = magnitudes(machine, 0.0, state, end, [s.scale for s in system.states], settings.method)
    settling = settling_of(system)
    parts, settled, status = [], False, "ok"
    for part in segment_parts(machine, 0.0, state, end, settings.tolerance, weights, settings.method):
        parts.append(part)
        progress(float(part.times[-1]))
        status = part.status
        if settles and len(part.times) > 1:
            even = np.linspace(part.times[0], part.times[-1], PARTS * (len(part.times) - 1) + 1)
            samples = dense(machine.field, machine.c, part.times, part.states, even, settings.method)
            settled = settling.add(samples, len(part.times) - 1)
            if settled or sum(len(part.times) - 1 for part in parts) >= LONGEST:
                break
    times = np.concatenate([parts[0].times, *(part.times[1:] for part in parts[1:])])
    states = np.concatenate([parts[0].states, *(part.states[1:] for part in parts[1:])])
    at, values, fine, curve = times, states, times, states
    if len(times) > 1:
        at, fine = np.linspace(times[0], times[-1], settings.points), drawn_at(times, settings.points)
        values, curve = (
            dense(machine.field, machine.c, times, states, each, settings.method) for each in (at, fine)
        )
    return Simulated(
        times=at,
        values=values,
        modes=np.zeros(len(at), dtype=int),
        events=[event for part in parts for event in part.events],
        status=status,
        reason="",
        settled=settled if settles else None,
        steps=len(times) - 1,
        evaluations=sum(part.evaluations for part in parts),
        drawn=(fine, curve, np.zeros(len(fine), dtype=int)),
    )


def _through_transitions(
    run: SimulationFile,
    state: np.ndarray,
    itinerary: StoredItinerary | None,
    parameters: Mapping[str, float],
    progress: Callable[[float], None],
) -> Simulated:
    """The motion of a machine with transitions that act."""
    from contwalk.workflow.simulating_hybrid import Beginning, on_orbit, simulated

    beginning = Beginning(state, run.start.mode or run.system.modes[0].name, run.start.at)
    if itinerary is not None:
        beginning = on_orbit(run.system, itinerary)
    beginning = replace(beginning, state=beginning.state + run.perturbation)
    with run.start.errors_placed():
        return simulated(run.system, parameters, beginning, run.simulation, run.report_at, progress)


def _trajectory(run: SimulationFile, motion: Simulated) -> Any:
    """The motion as it is stored."""
    from contwalk.storage.trajectory import Trajectory

    system, events = run.system, motion.events
    return Trajectory(
        system=system.name,
        states=system.state_names,
        parameters=dict(motion.parameters),
        times=motion.times,
        values=motion.values,
        modes=motion.modes,
        mode_names=tuple(mode.name for mode in system.modes),
        event_names=tuple(event.name for event in events),
        event_modes=tuple(event.mode for event in events),
        event_times=np.array([event.time for event in events]),
        event_rising=np.array([event.rising for event in events], dtype=bool),
        event_before=np.array([event.before for event in events]).reshape(-1, len(system.states)),
        event_after=np.array([event.after for event in events]).reshape(-1, len(system.states)),
        status=motion.status,
        header={
            "config": run.text,
            "overrides": list(run.overrides),
            "model": {key: str(value) for key, value in system.model.items()},
            "provenance": made_with(run.path, run.system_reference, system),
        },
    )


def _machine(run: SimulationFile, parameters: Mapping[str, float]) -> Any:
    """The system at these parameters with everything that is watched."""
    from contwalk.flow.compiled.traced import field_of
    from contwalk.flow.events.guard import Guard
    from contwalk.flow.events.motion import Machine

    system, place = run.system, run.report_at
    field = field_of(system)
    guards = [Guard(system, t.name, t.guard, t.direction, field=field) for t in system.transitions]
    if place is not None and place.section is not None:
        name, level = place.section
        column = system.state_names.index(name)

        def passed(t: Any, x: Any, p: Any) -> Any:
            return x[column] - level

        guards.append(Guard(system, f"{name} = {level:g}", passed, str(place.direction), field=field))
    p = np.array([parameters[name] for name in system.parameter_names], dtype=float)
    return Machine(field, p, field.constants(p), guards, system.modes[0].name)


def _write_tables(trajectory: Any, paths: list[Path]) -> None:
    """The instants and the events as CSV, all digits kept."""
    motion, events = paths
    names, modes = trajectory.states, trajectory.mode_names
    instants = zip(
        trajectory.times.tolist(), trajectory.values.tolist(), trajectory.modes.tolist(), strict=True
    )
    several = len(modes) > 1
    rows = ([t, *x, *([modes[mode]] if several else [])] for t, x, mode in instants)
    happened = zip(
        trajectory.event_names,
        trajectory.event_times.tolist(),
        trajectory.event_rising.tolist(),
        trajectory.event_before.tolist(),
        trajectory.event_after.tolist(),
        trajectory.event_modes,
        strict=True,
    )
    event_rows = (
        [name, t, "rising" if rising else "falling", mode, *before, *after]
        for name, t, rising, before, after, mode in happened
    )
    heads = (
        ["t", *names, *(["mode"] if several else [])],
        [
            "event",
            "t",
            "direction",
            "mode_after",
            *(f"before.{n}" for n in names),
            *(f"after.{n}" for n in names),
        ],
    )
    for path, head, lines in zip((motion, events), heads, (rows, event_rows), strict=True):
        write_csv(path, head, lines)


def _figure_file(run: SimulationFile, number: int) -> str:
    name = run.figures[number].name
    same = [spec.name for spec in run.figures[:number]].count(name)
    return f"{name}{f'_{same + 1}' if same else ''}.png"


def _named(run: SimulationFile, spec: FigureSpec, default: Path) -> Path:
    return run.output.parent / spec.options["file"] if "file" in spec.options else default


def _drawn(run: SimulationFile, spec: FigureSpec, path: Path, trajectory: Any) -> Path:
    from contwalk import plotting

    if spec.name == "stick_figure":
        return plotting.save(_stick_figure(run, trajectory), path)
    units = plotting.units_of(run.system)
    if spec.name == "phase_portrait":
        axes = [spec.options[axis] for axis in ("x", "y", "z") if axis in spec.options]
        _, values = _with_gaps(run, trajectory, axes)
        return plotting.save(plotting.plot_phase_portrait([values], axes, units=units), path)
    asked = listed(spec.options.get("y"))
    times, values = _with_gaps(run, trajectory, asked or trajectory.states)
    exist = ~np.isnan(values).all(axis=0) | bool(asked)  # those that no mode has are not even named
    shown, values = [n for n, k in zip(asked or trajectory.states, exist, strict=True) if k], values[:, exist]
    events: dict[str, list[float]] = {}
    for name, t in zip(trajectory.event_names, trajectory.event_times.tolist(), strict=True):
        events.setdefault(name, []).append(t)
    panels = plotting.plot_time_series_panels(times, values, shown, events=events, units=units)
    return plotting.save(panels[0], path)


def _stick_figure(run: SimulationFile, trajectory: Any) -> Any:
    from contwalk import plotting
    from contwalk.plotting.machine import walks

    given = run.system, trajectory.times, trajectory.values, run.start.parameters
    events = list(zip(trajectory.event_times.tolist(), trajectory.event_names, strict=True))
    if walks(run.system):
        return plotting.plot_stick_figure(*given, events=events)
    return plotting.plot_stick_panels(*given, events=events)[0]


def _with_gaps(run: SimulationFile, trajectory: Any, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Instants and values as they are drawn: a gap at each jump, and nothing of states that do not exist."""
    system, times = run.system, trajectory.times
    values = values_along(system, names, times, trajectory.values, run.start.parameters)
    for number, mode in enumerate(system.modes):
        own = [system.state_names[i] for i in system.states_of(mode.name)]
        absent = np.array(
            [k for k, name in enumerate(names) if name in system.state_names and name not in own], dtype=int
        )
        values[np.ix_(np.flatnonzero(trajectory.modes == number), absent)] = np.nan
    jumps = np.flatnonzero((np.diff(times) == 0.0) & (np.diff(trajectory.values, axis=0) != 0.0).any(axis=1))
    return np.insert(times, jumps + 1, times[jumps]), np.insert(values, jumps + 1, np.nan, axis=0)


def why(status: str, t: float, reason: str = "") -> ContwalkError | None:
    """The error for a motion that cannot go on; None where it has not ended early, or has fallen."""
    if status in ("ok", FALLEN):
        return None
    if status in ("chatter", "sticking") or (status == "not_finite" and reason):
        return NotFinite(f"The motion ended early. {reason}", "What came before is stored.")
    words = {
        "not_finite": "the field is not finite beyond",
        "step_too_small": "steps became too small to go on at",
    }.get(status, f"{status} at")
    why = f". {reason}" if reason else f": {words} t = {t:.10g}."
    return NotFinite(
        f"The motion ended early{why} What came before is stored.",
        "Look at the states there, or choose simulate.method: radau5 for a stiff machine.",
    )
