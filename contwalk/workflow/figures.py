"""The figures a run file asks for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import ORBITS, Branch
from contwalk.errors import NO_LINE, ContwalkError, plugin_line
from contwalk.system import System

STRIDES = 3  # periods of a stick figure whose events are marks, and so leave room


def draw_figure(
    name: str,
    branches: Sequence[Branch],
    system: System | None,
    path: Path,
    options: Mapping[str, Any],
    units: Mapping[str, str] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> Path:
    """Draw one figure of a diagram into a file (PNG, SVG or PDF by its suffix).

    Parameters
    ----------
    name : str
        One of `run_values.DIAGRAM_FIGURES`, or `time_series`.
    system : System, optional
        For figures of machines and motions, and for units.
    options : mapping
        `x`, `y` and `z` where the figure takes them, `full` and `together` of multipliers; `points`, pairs
        of a branch and a stored point, for figures of points.
    units : mapping, optional
        Units by name, instead of the system's.
    report : callable
        Given a sentence on what the figure lacks.

    Raises
    ------
    ContwalkError
        If it cannot be drawn, whatever is the reason.
    """
    try:
        _draw(name, branches, system, path, options, units, report)
    except ContwalkError:
        raise
    except (Exception, SystemExit) as error:  # the plugin's `draw` may do anything, and so may its motion
        where = plugin_line(error)
        raise ContwalkError(
            f"The figure '{name}' cannot be drawn: {type(error).__name__}"
            f"{'' if where == NO_LINE else f' at {where}'}: {error}.",
            "Mend the plugin if it is its line, or choose another figure or point.",
        ) from error
    return path


def _draw(
    name: str,
    branches: Sequence[Branch],
    system: System | None,
    path: Path,
    options: Mapping[str, Any],
    units: Mapping[str, str] | None,
    report: Callable[[str], None],
) -> None:
    from contwalk import plotting

    if units is None and system is not None:
        units = plotting.units_of(system)
    x, y = options.get("x"), options.get("y")
    axes: Any
    if name == "bifurcation_diagram":
        # Curves in two parameters have a figure of their own; they would lie across the diagram.
        branches = [branch for branch in branches if branch.info.problem != "locus"] or branches
        axes = plotting.plot_bifurcation_diagram(
            branches, x, y, units=units, xlim=options.get("xlim"), ylim=options.get("ylim"), report=report
        )
    elif name == "eigenvalues":
        axes = plotting.plot_eigenvalues(branches, units=units)
    elif name == "multipliers":
        shown = {name: bool(options.get(name)) for name in ("full", "together")}
        axes = plotting.plot_multiplier_panels(branches, **shown, units=units, report=report)
    elif name == "stability_map":
        axes = plotting.plot_stability_map(branches, x or branches[0].info.free[0], str(y), units=units)
    elif name == "locus":
        axes = plotting.plot_locus(branches, x, y, units=units, report=report)
    elif name == "chart":
        axes = _chart(branches, system, (x, y), units, report)
    elif name in _OF_MACHINES:
        if system is None:
            raise ContwalkError(f"The figure '{name}' needs the system.", "Install it again.")
        axes = _OF_MACHINES[name](branches, system, {"report": report, **options})
    else:
        raise ContwalkError(f"There is no figure named '{name}'.", "See docs/reference/figures.md.")
    plotting.save(axes[0] if isinstance(axes, list) else axes, path)


def _chart(
    branches: Sequence[Branch],
    system: System | None,
    names: tuple[str | None, str | None],
    units: Mapping[str, str] | None,
    report: Callable[[str], None],
) -> Any:
    """Regions filled by what a computation at a place of each finds there."""
    from contwalk import plotting
    from contwalk.studies.charts import chart

    if system is None:
        raise ContwalkError("The figure 'chart' needs the system.", "Install it again.")
    x, y = names
    found = chart(system, branches, None if x is None or y is None else (x, y))
    return plotting.plot_chart(branches, found, units=units, report=report)


def _phase_plane(branches: Sequence[Branch], system: System, options: Mapping[str, Any]) -> Any:
    """The plane of two states at the parameters of the first point that is named, with the orbits of all."""
    from contwalk import plotting
    from contwalk.workflow.phase_plane import drawn_plane
    from contwalk.workflow.stored.orbits import columns_of, orbit_at

    names = [options.get(axis) or (*system.state_names, "")[k] for k, axis in enumerate("xy")]
    points = options.get("points") or [(branches[0], 0)]
    orbits = [orbit_at(system, *point) for point in points if point[0].info.problem in ORBITS]
    plane = drawn_plane(system, points, names, [orbit.states for orbit in orbits])
    curves = [columns_of(system, orbit, names) for orbit in orbits]
    return plotting.plot_phase_plane(
        plane, curves, stable=[orbit.stable for orbit in orbits], units=plotting.units_of(system)
    )


def _phase_portrait(branches: Sequence[Branch], system: System, options: Mapping[str, Any]) -> Any:
    """Orbits of special points and ends, or of the points that are named, integrated once more."""
    from contwalk import plotting
    from contwalk.workflow.stored.orbits import columns_of, jumps_of, orbit_at, orbits_of

    x, y = (
        options.get(axis) or system.state_names[min(k, len(system.states) - 1)] for k, axis in enumerate("xy")
    )
    names = [x, y, *([options["z"]] if options.get("z") else [])]
    if options.get("points"):
        orbits = [orbit_at(system, branch, point) for branch, point in options["points"]]
        groups = [(", ".join(dict.fromkeys(orbit.branch for orbit in orbits)), orbits)]
    else:
        origins = {branch.name: branch.info.origin for branch in branches}
        groups = [
            (", from ".join(filter(None, (orbits[0].branch, origins[orbits[0].branch]))), orbits)
            for orbits in orbits_of(system, branches, options["report"])
        ]
    portraits = []
    for title, orbits in groups:
        several = len({orbit.branch for orbit in orbits}) > 1
        portraits.append(
            plotting.Portrait(
                title,
                [columns_of(system, orbit, names) for orbit in orbits],
                [f"{orbit.branch}/{orbit.label}" if several else orbit.label for orbit in orbits],
                [orbit.stable for orbit in orbits],
                [orbit.admissible for orbit in orbits],
                [jumps_of(system, orbit, names) for orbit in orbits],
            )
        )
    return plotting.plot_phase_panels(portraits, names, units=plotting.units_of(system))[0]


def _machine(branches: Sequence[Branch], system: System, options: Mapping[str, Any]) -> Any:
    """The machine at the start of the first branch that has points."""
    from contwalk import plotting

    branch = next((branch for branch in branches if len(branch)), None)
    if branch is None:
        raise ContwalkError("There is no point to draw the machine at.", "Run the diagram first.")
    row = branch.points[_start(branch)]
    parameters = {**branch.info.parameters, branch.info.free[0]: float(row["free"][0])}
    known = {name: parameters[name] for name in system.parameter_names if name in parameters}
    return plotting.plot_machine(system, row["state"], known)


def _stick_figure(branches: Sequence[Branch], system: System, options: Mapping[str, Any]) -> Any:
    """The machine at instants of one orbit, by default that of the start."""
    from contwalk import plotting
    from contwalk.plotting.event_marks import MANY
    from contwalk.plotting.machine import require_draw, walks
    from contwalk.workflow.stored.orbit_motions import motion_along
    from contwalk.workflow.stored.orbits import titled

    require_draw(system)
    orbit = _orbit(branches, system, options, "stick figure")
    motion = motion_along(system, orbit)
    if walks(system) and len(motion.marks) > MANY:
        motion = motion_along(system, orbit, STRIDES)
    given = system, motion.times, motion.states, orbit.parameters
    title = titled(orbit)
    if walks(system):
        return plotting.plot_stick_figure(*given, title=title, events=motion.marks)
    return plotting.plot_stick_panels(*given, title=title, events=motion.marks)


def _time_series(branches: Sequence[Branch], system: System, options: Mapping[str, Any]) -> Any:
    """States, or what is asked for, over one period of one orbit, by default that of the start."""
    from contwalk import plotting
    from contwalk.plotting.style import whole_title
    from contwalk.workflow.quantities import check_names, listed, values_along
    from contwalk.workflow.stored.orbit_motions import motion_along
    from contwalk.workflow.stored.orbits import titled, without_absent

    names = listed(options.get("y")) or list(system.state_names)
    check_names(system, names)
    orbit = _orbit(branches, system, options, "time series")
    motion = motion_along(system, orbit)
    values = values_along(system, names, motion.times, motion.states, orbit.parameters)
    times, values = motion.broken(without_absent(system, names, values, motion.there))
    happened: dict[str, list[float]] = {}
    for time, name in motion.events:
        happened.setdefault(name, []).append(time)
    units = plotting.units_of(system)
    panels = plotting.plot_time_series_panels(times, values, names, events=happened, units=units)
    whole_title(panels[0].figure, titled(orbit))
    return panels


def _orbit(branches: Sequence[Branch], system: System, options: Mapping[str, Any], what: str) -> Any:
    """The orbit of the point that is named, else of the start of the first branch of orbits."""
    from contwalk.workflow.stored.orbits import orbit_at

    if options.get("points"):
        return orbit_at(system, *options["points"][0])
    for branch in branches:
        if branch.info.problem in ORBITS and len(branch):
            return orbit_at(system, branch, _start(branch))
    raise ContwalkError(
        f"No branch has periodic orbits, so there is no {what}.",
        "Follow a Hopf point (diagram: {follow: [HB]}), or start on an orbit.",
    )


def _start(branch: Branch) -> int:
    """The row at which a branch begins; where orbits were born of others, the one in the middle."""
    if branch.info.parent is not None and branch.info.problem in ORBITS:
        return len(branch) // 2
    return int(np.abs(branch.points["s"]).argmin())


_OF_MACHINES: dict[str, Callable[[Sequence[Branch], System, Mapping[str, Any]], Any]] = {
    "machine": _machine,
    "phase_plane": _phase_plane,
    "phase_portrait": _phase_portrait,
    "stick_figure": _stick_figure,
    "time_series": _time_series,
}
