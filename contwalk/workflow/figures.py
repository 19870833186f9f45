"""The figures a run file asks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.system import System

# Branches whose multipliers have a panel each; more are drawn into one.
MOST_PANELS = 6


def draw_figure(
    name: str, branches: Sequence[Branch], system: System | None, path: Path, options: Mapping[str, Any]
) -> Path:
    """Draw one figure of a diagram into a file (PNG, SVG or PDF by its suffix).

    Parameters
    ----------
    name : str
        One of `run_values.FIGURES`.
    system : System, optional
        For units, and for the figure `machine`.
    options : mapping
        `x`, `y` and `z` where the figure takes them; `points`, names of stored points, for a phase portrait.
    """
    from contwalk import plotting

    units = plotting.units_of(system) if system is not None else None
    x, y = options.get("x"), options.get("y")
    axes: Any
    if name == "bifurcation_diagram":
        axes = plotting.plot_bifurcation_diagram(
            branches, x, y, units=units, xlim=options.get("xlim"), ylim=options.get("ylim")
        )
    elif name == "eigenvalues":
        axes = plotting.plot_eigenvalues(branches, units=units)
    elif name == "multipliers":
        several = 1 < sum(branch.info.problem != "equilibrium" for branch in branches) <= MOST_PANELS
        drawn = plotting.plot_multiplier_panels if several else plotting.plot_multipliers
        axes = drawn(branches, units=units)
    elif name == "stability_map":
        axes = plotting.plot_stability_map(branches, x or branches[0].info.free[0], str(y), units=units)
    elif name == "machine":
        axes = _machine(branches, system)
    elif name == "phase_portrait":
        axes = _phase_portrait(branches, system, options)
    else:
        raise ContwalkError(f"There is no figure named '{name}'.", "See docs/reference/figures.md.")
    plotting.save(axes[0] if isinstance(axes, list) else axes, path)
    return path


def _phase_portrait(branches: Sequence[Branch], system: System | None, options: Mapping[str, Any]) -> Any:
    """Orbits of special points and ends, or of the points that are named, integrated once more."""
    from contwalk import plotting
    from contwalk.workflow.stored_orbits import columns_of, orbit_at, orbits_of

    if system is None:
        raise ContwalkError("Orbits cannot be integrated without their system.", "Install it again.")
    x, y = (
        options.get(axis) or system.state_names[min(k, len(system.states) - 1)] for k, axis in enumerate("xy")
    )
    names = [x, y, *([options["z"]] if options.get("z") else [])]
    if options.get("points"):
        groups = [[orbit_at(system, branch, point) for branch, point in options["points"]]]
    else:
        groups = orbits_of(system, branches)
    origins = {branch.name: branch.info.origin for branch in branches}
    portraits = [
        plotting.Portrait(
            group[0].branch + (f", from {origins[group[0].branch]}" if origins.get(group[0].branch) else ""),
            [columns_of(system, orbit, names) for orbit in group],
            [orbit.label for orbit in group],
            [orbit.stable for orbit in group],
        )
        for group in groups
    ]
    return plotting.plot_phase_panels(portraits, names, units=plotting.units_of(system))[0]


def _machine(branches: Sequence[Branch], system: System | None) -> Any:
    """The machine at the start of the first branch that has points."""
    from contwalk import plotting

    for branch in branches:
        if len(branch):
            if system is None:
                break
            row = branch.points[int(abs(branch.points["s"]).argmin())]
            parameters = {**branch.info.parameters, branch.info.free[0]: float(row["free"][0])}
            return plotting.plot_machine(system, row["state"], parameters)
    raise ContwalkError("There is no point to draw the machine at.", "Run the diagram first.")
