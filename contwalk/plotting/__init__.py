"""Figures of branches and machines, one figure per file.

Rules of the contract
---------------------
1. Ax in, ax out: `plot_<figure>(..., ax=None) -> Axes` draws on the axes it is given, or on those of
   `new_axes("<figure>")`, and returns them. It neither shows nor saves; `save` does.
2. One figure per file, the file named as the run file names the figure.
3. A figure shows what is stored. It computes no continuation and changes no branch.
4. What is unstable is never drawn like what is stable, nor inadmissible like admissible: where it is not
   known which, the worse of the two is drawn.
5. No pyplot and no global state: a figure is a `matplotlib.figure.Figure` with an Agg canvas.
6. matplotlib is imported when a figure is first asked for, not with `contwalk.plotting`.
7. Bad input is a `ContwalkError` with the nearest known name, never a traceback.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from contwalk.plotting import manuals

if TYPE_CHECKING:
    from contwalk.plotting.animation import save_animation
    from contwalk.plotting.basin import plot_basin
    from contwalk.plotting.bifurcation_diagram import plot_bifurcation_diagram
    from contwalk.plotting.chart import plot_chart
    from contwalk.plotting.eigenvalues import plot_eigenvalues
    from contwalk.plotting.histogram import plot_histogram
    from contwalk.plotting.locus import plot_locus
    from contwalk.plotting.machine import plot_machine
    from contwalk.plotting.margins import plot_margins
    from contwalk.plotting.multiplier_moduli import plot_multiplier_moduli
    from contwalk.plotting.multipliers import plot_multiplier_panels, plot_multipliers
    from contwalk.plotting.phase_panels import Portrait, plot_phase_panels
    from contwalk.plotting.phase_plane import plot_phase_plane
    from contwalk.plotting.phase_portrait import plot_phase_portrait
    from contwalk.plotting.quantities import units_of
    from contwalk.plotting.stability_map import plot_stability_map
    from contwalk.plotting.stick_figure import plot_stick_figure, plot_stick_panels
    from contwalk.plotting.style import new_axes, save
    from contwalk.plotting.time_series import plot_time_series, plot_time_series_panels
    from contwalk.plotting.tradeoff import plot_tradeoff
    from contwalk.plotting.tradeoff_panels import plot_tradeoff_panels

__all__ = [
    "Portrait",
    "new_axes",
    "plot_basin",
    "plot_bifurcation_diagram",
    "plot_chart",
    "plot_eigenvalues",
    "plot_histogram",
    "plot_locus",
    "plot_machine",
    "plot_margins",
    "plot_multiplier_moduli",
    "plot_multiplier_panels",
    "plot_multipliers",
    "plot_phase_panels",
    "plot_phase_plane",
    "plot_phase_portrait",
    "plot_stability_map",
    "plot_stick_figure",
    "plot_stick_panels",
    "plot_time_series",
    "plot_time_series_panels",
    "plot_tradeoff",
    "plot_tradeoff_panels",
    "save",
    "save_animation",
    "units_of",
]

_MODULES = {
    "Portrait": "phase_panels",
    "new_axes": "style",
    "plot_bifurcation_diagram": "bifurcation_diagram",
    "plot_chart": "chart",
    "plot_eigenvalues": "eigenvalues",
    "plot_histogram": "histogram",
    "plot_locus": "locus",
    "plot_machine": "machine",
    "plot_basin": "basin",
    "plot_margins": "margins",
    "plot_multiplier_moduli": "multiplier_moduli",
    "plot_multiplier_panels": "multipliers",
    "plot_multipliers": "multipliers",
    "plot_phase_panels": "phase_panels",
    "plot_phase_plane": "phase_plane",
    "plot_phase_portrait": "phase_portrait",
    "plot_stability_map": "stability_map",
    "plot_stick_figure": "stick_figure",
    "plot_stick_panels": "stick_figure",
    "plot_time_series": "time_series",
    "plot_time_series_panels": "time_series",
    "plot_tradeoff": "tradeoff",
    "plot_tradeoff_panels": "tradeoff_panels",
    "save": "style",
    "save_animation": "animation",
    "units_of": "quantities",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    manuals.left_out()
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
