"""The stability map: the leading real part over the plane of two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.labels import MEANINGS
from contwalk.plotting.net import triangulate
from contwalk.plotting.quantities import axis_label, values, with_names
from contwalk.plotting.segments import position
from contwalk.plotting.special_points import marker
from contwalk.plotting.style import INK, PALETTE, dress, new_axes
from contwalk.plotting.sweep import gather

QUANTITY = "max_re"
BORDER_LABELS = ("HB", "LP", "BP")
# Sizes of markers: where stability changes, and where an unstable solution becomes more so.
ON_BORDER, OFF_BORDER = 4.5, 2.5


def plot_stability_map(
    branches: Sequence[Branch],
    x: str,
    y: str,
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
) -> Axes:
    """Draw the leading real part `max_re` of a sweep: blue where stable, grey where unstable, white: no data.

    The border max_re = 0 is drawn strong; it passes through the special points where stability changes, which
    are rows of the data. Where several solutions exist, the most stable one is shown.

    Parameters
    ----------
    branches : sequence of Branch
        One for each value of `y`, or more.
    x, y : str
        The parameter that is free on the branches, and the one that was swept.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name, as from `units_of(system)`.

    Raises
    ------
    ContwalkError
        If a name is unknown, or the branches are no sweep over `y`.
    """
    chosen = with_names(branches, [x, y, QUANTITY])
    if not any(x in branch.info.free for branch in chosen):
        raise ContwalkError(
            f"'{x}' is free on no branch.",
            f"Free: {', '.join(sorted({name for branch in chosen for name in branch.info.free}))}.",
        )
    net, value = triangulate(gather(chosen, x, y, QUANTITY))
    ax = ax or new_axes("stability_map")
    dress(ax, axis_label(x, units), axis_label(y, units))
    _fill(ax, net, value, units)
    found = _special(ax, chosen, x, y)
    _legend(ax, found, unstable=bool((value > 0).any()))
    ax.set_xlim(net.x.min(), net.x.max())
    ax.set_ylim(net.y.min(), net.y.max())
    return ax


def _levels(value: np.ndarray) -> np.ndarray:
    """Contour levels, zero among them if it is passed, with enough on either side of it."""
    low, high = float(value.min()), float(value.max())
    if high - low < 1e-12 * max(abs(low), abs(high), 1e-12):
        reach = 0.1 * abs(low) or 1.0
        return np.array([low - reach, high + reach])
    if low < 0 < high:
        below = np.asarray(MaxNLocator(7).tick_values(low, 0.0))
        above = np.asarray(MaxNLocator(4).tick_values(0.0, high))
        return np.unique(np.concatenate([below[below < 0], [0.0], above[above > 0]]))
    return np.asarray(MaxNLocator(8).tick_values(low, high))


def _colors(levels: np.ndarray) -> list[tuple[float, ...]]:
    """Blues that fade towards zero where stable, greys that darken away from it where unstable."""
    middle = (levels[:-1] + levels[1:]) / 2
    stable, unstable = int((middle < 0).sum()), int((middle >= 0).sum())
    blues = matplotlib.colormaps["Blues"](np.linspace(0.85, 0.2, stable))
    greys = matplotlib.colormaps["Greys"](np.linspace(0.35, 0.7, unstable))
    return [tuple(color) for color in (*blues, *greys)]


def _fill(ax: Axes, net: Triangulation, value: np.ndarray, units: Mapping[str, str] | None) -> None:
    levels = _levels(value)
    filled = ax.tricontourf(net, value, levels=levels, colors=_colors(levels))
    if value.min() < 0 < value.max():
        border = ax.tricontour(net, value, levels=[0.0], colors=INK, linewidths=1.6)
        border.set_gid("border")
    bar = ax.figure.colorbar(filled, ax=ax, spacing="uniform", pad=0.02, aspect=28)
    bar.set_label(axis_label(QUANTITY, units), fontsize=10, color=INK)
    bar.ax.tick_params(labelsize=8.5, width=0.7, length=3)
    bar.outline.set_linewidth(0.7)


def _special(ax: Axes, branches: Sequence[Branch], x: str, y: str) -> list[str]:
    """Mark the located special points; the labels that occur. Those off the border of stability are small."""
    found: set[str] = set()
    for branch in branches:
        columns = [np.asarray(values(branch, name)) for name in (x, y)]
        for point in branch.special_points:
            if point.label not in BORDER_LABELS or point.status != "located":
                continue
            at = [position(branch, column, point.index, point.s) for column in columns]
            on_border = (point.unstable_before == 0) != (point.unstable_after == 0)
            ax.plot(
                at[:1],
                at[1:],
                clip_on=False,
                gid=f"{branch.name}-{point.name}",
                **marker(point.label, PALETTE[1], size=ON_BORDER if on_border else OFF_BORDER),
            )
            found.add(point.label)
    return [label for label in BORDER_LABELS if label in found]


def _legend(ax: Axes, found: Sequence[str], unstable: bool) -> None:
    handles: list[Line2D | Patch] = []
    if unstable:
        handles.append(Patch(facecolor=matplotlib.colormaps["Greys"](0.45), label="unstable"))
    handles += [
        Line2D([], [], label=f"{label}  {MEANINGS[label]}", **marker(label, PALETTE[1], size=ON_BORDER))
        for label in found
    ]
    if handles:
        ax.legend(
            handles=handles,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.01),
            borderaxespad=0.0,
            ncols=len(handles),
            frameon=False,
            fontsize=8.5,
            labelcolor=INK,
            handlelength=1.4,
        )
