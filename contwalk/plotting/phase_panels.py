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
    """Draw a phase portrait for each branch, in two columns on equal scales.

    Parameters
    ----------
    portraits : sequence of Portrait
    names : sequence of str
        What the columns of the curves are: two names; three where there is one portrait only.
    units : mapping, optional
        Units by name, as from `units_of(system)`.

    Raises
    ------
    ContwalkError
        If there is no portrait, or more than one in space.
    """
    if not portraits:
        raise ContwalkError("There is no orbit to draw.", "Name a branch of periodic orbits.")
    if len(names) == 3 and len(portraits) > 1:
        raise ContwalkError(
            "In space, one branch is drawn at a time.", "Name it, or leave out the third axis."
        )
    several = len(portraits) > 1
    places = new_grid("phase_panels", len(portraits), COLUMNS) if several else [None]
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
    xs, ys = zip(*[(ax.get_xlim(), ax.get_ylim()) for ax in axes], strict=True)
    for ax in axes:
        ax.set_xlim(min(x[0] for x in xs), max(x[1] for x in xs))
        ax.set_ylim(min(y[0] for y in ys), max(y[1] for y in ys))
        legend = ax.get_legend()
        if legend is not None:
            legend.set_loc("upper left")
            legend.set_bbox_to_anchor((0.0, -0.16))
