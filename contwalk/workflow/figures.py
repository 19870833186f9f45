"""The figures a run file asks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.system import System


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
        `x` and `y` where the figure takes them.
    """
    from contwalk import plotting

    units = plotting.units_of(system) if system is not None else None
    x, y = options.get("x"), options.get("y")
    if name == "bifurcation_diagram":
        axes = plotting.plot_bifurcation_diagram(branches, x, y, units=units)
    elif name == "eigenvalues":
        axes = plotting.plot_eigenvalues(branches, units=units)
    elif name == "multipliers":
        axes = plotting.plot_multipliers(branches, units=units)
    elif name == "stability_map":
        axes = plotting.plot_stability_map(branches, x or branches[0].info.free[0], str(y), units=units)
    elif name == "machine":
        axes = _machine(branches, system)
    else:
        raise ContwalkError(f"There is no figure named '{name}'.", "See docs/reference/figures.md.")
    plotting.save(axes, path)
    return path


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
