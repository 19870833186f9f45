"""A basin: a plane of two states, coloured by what motions from there come to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Patch, Rectangle

from contwalk.errors import ContwalkError
from contwalk.plotting.quantities import axis_label
from contwalk.plotting.style import GREY, INK, PALETTE, dress, legend_above, light, new_axes

SHADE = 0.35  # of white in the colour of an attractor
LOST = {"fallen": 0.55, "ended": 0.75, "events_accumulate": 0.85, "beyond_guard": 0.95}  # of white in grey


def plot_basin(
    states: Sequence[str],
    cells: np.ndarray,
    labels: Sequence[str],
    ranges: np.ndarray,
    own: Sequence[float],
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
) -> Axes:
    """Draw a basin.

    Parameters
    ----------
    states : sequence of str
        The two states.
    cells : ndarray, shape (c, 3)
        Lower left values of each square, and its part of the ranges.
    labels : sequence of str
        What it comes to; empty on a border, which is drawn dark.
    ranges : ndarray, shape (2,)
        Of the whole plane.
    own : sequence of float
        The state that is pushed.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name.

    Raises
    ------
    ContwalkError
        If there is no square.
    """
    if not len(cells):
        raise ContwalkError("There is no basin to draw.", "Give at least one square.")
    ax = ax or new_axes("basin")
    known = sorted({label for label in labels if label})
    colors = _colors(known)
    for label in (*known, ""):
        mine = [cell for cell, own_label in zip(cells, labels, strict=True) if own_label == label]
        patches = [Rectangle((x, y), part * ranges[0], part * ranges[1]) for x, y, part in mine]
        color = colors.get(label, INK)
        ax.add_collection(
            PatchCollection(
                patches, facecolor=color, edgecolor=color, linewidth=0.2, gid=f"basin:{label or 'border'}"
            )
        )
    ax.plot(*own, "o", color="white", markeredgecolor=INK, markersize=6, zorder=4, gid="solution")
    low = cells[:, :2].min(axis=0)
    ax.set_xlim(low[0], low[0] + ranges[0])
    ax.set_ylim(low[1], low[1] + ranges[1])
    dress(ax, *(axis_label(name, units) for name in states))
    handles = [Patch(facecolor=colors[label], edgecolor=INK, linewidth=0.4, label=label) for label in known]
    legend_above(ax, handles)
    return ax


def _colors(known: Sequence[str]) -> dict[str, str]:
    attractors = [label for label in known if label not in LOST]
    found = {label: light(PALETTE[k % len(PALETTE)], SHADE) for k, label in enumerate(attractors)}
    return found | {label: light(GREY, LOST[label]) for label in known if label in LOST}
