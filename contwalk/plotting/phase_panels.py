"""Phase portraits of several branches, a panel for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes

from contwalk.errors import ContwalkError
from contwalk.plotting.phase_portrait import plot_phase_portrait
from contwalk.plotting.style import new_grid, title

COLUMNS = 2


@dataclass(frozen=True)
class Portrait:
    """What one panel shows: curves as for `plot_phase_portrait`, and the panel's title."""

    title: str
    orbits: Sequence[np.ndarray]
    labels: Sequence[str] = ()
    stable: Sequence[bool] = field(default=())
    admissible: Sequence[bool] = field(default=())
    jumps: Sequence[np.ndarray] = field(default=())


def plot_phase_panels(
    portraits: Sequence[Portrait],
    names: Sequence[str],
    *,
    units: Mapping[str, str] | None = None,
) -> list[Axes]:
    """Draw a phase portrait for each branch, in the plane or in space, in two columns on equal scales.

    Parameters
    ----------
    portraits : sequence of Portrait
    names : sequence of str
        What the columns of the curves are: two or three names.
    units : mapping, optional
        Units by name, as from `units_of(system)`.

    Raises
    ------
    ContwalkError
        If there is no portrait.
    """
    if not portraits:
        raise ContwalkError("There is no orbit to draw.", "Name a branch of periodic orbits.")
    several, space = len(portraits) > 1, "3d" if len(names) == 3 else None
    places = new_grid("phase_panels", len(portraits), COLUMNS, space) if several else [None]
    axes = []
    for place, each in zip(places, portraits, strict=True):
        ax = plot_phase_portrait(
            each.orbits,
            names,
            place,
            labels=each.labels,
            stable=each.stable,
            admissible=each.admissible,
            jumps=each.jumps,
            units=units,
        )
        title(ax, each.title)
        axes.append(ax)
    if several:
        _together(axes)
    return axes


def _together(axes: Sequence[Axes]) -> None:
    """Equal scales, and legends below the panels, where they take no width."""
    for name in ("x", "y", "z"):
        limits = [getattr(ax, f"get_{name}lim")() for ax in axes if hasattr(ax, f"get_{name}lim")]
        if limits:
            low, high = min(each[0] for each in limits), max(each[1] for each in limits)
            for ax in axes:
                getattr(ax, f"set_{name}lim")(low, high)
    for ax in axes:
        legend = ax.get_legend()
        if legend is not None:
            legend.set_loc("upper left")
            legend.set_bbox_to_anchor((0.0, -0.16))
