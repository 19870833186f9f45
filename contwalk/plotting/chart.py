"""The chart: regions of two parameters filled by what is stable there, with the curves between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from contwalk.branch import Branch
from contwalk.chart import Chart, Region
from contwalk.labels import UNDECIDED
from contwalk.plotting.locus import plot_locus
from contwalk.plotting.style import GREY, INK, legend_above, new_axes

# Of no, one, two, .. unstable directions; more of them look like the last.
FILLS = ("#cfe3f3", "#fbe3c8", "#e9d3e3", "#d9d9d9", "#c4c4c4")
NOTHING, NOT_KNOWN = "#ffffff", "#f4f0b8"
# Hatched where no solution is admissible.
HATCH = "///"
# Cells across, below which there is no room for the numbers in a region.
ROOM = 24


def plot_chart(
    branches: Sequence[Branch],
    chart: Chart,
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> Axes:
    """Fill the regions of a chart by the number of unstable directions of the most stable solution.

    The numbers in a region are those of all solutions found at its place, as `0 1 0`; a dash where none is.
    Where no solution is admissible it is hatched, and white where none was found or the region is too small.

    Parameters
    ----------
    branches : sequence of Branch
        The curves, and others, which are left out.
    chart : Chart
        As of `contwalk.studies.charts.chart`.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name for the axis labels, as from `units_of(system)`.
    report : callable
        Given sentences on what is not certain, or has no room.
    """
    ax = ax or new_axes("chart")
    x, y = chart.names
    occurring = [region.shown for region in chart.regions]
    _fill(ax, chart)
    curves = [b for b in branches if b.info.problem == "locus" and {x, y} == set(b.info.free)]
    plot_locus(curves, x, y, ax, units=units, report=report)
    ax.set_xlim(chart.low[0], chart.high[0])
    ax.set_ylim(chart.low[1], chart.high[1])
    for number, region in enumerate(chart.regions):
        _name(ax, chart, number, region)
    legend = ax.get_legend()
    handles = [*(legend.legend_handles if legend else ())]
    counts = {solution.unstable for solution in occurring if solution is not None}
    for count in sorted(count for count in counts if count is not None):
        many = "stable" if count == 0 else f"{count} unstable direction{'s' if count > 1 else ''}"
        handles.append(Patch(facecolor=_fill_of(count), edgecolor=GREY, linewidth=0.5, label=many))
    if None in counts:
        handles.append(Patch(facecolor=NOT_KNOWN, edgecolor=GREY, linewidth=0.5, label=UNDECIDED))
    if any(solution is not None and not solution.admissible for solution in occurring):
        handles.append(Patch(facecolor=NOTHING, edgecolor=GREY, hatch=HATCH, label="not admissible"))
    if any(solution is None for solution in occurring):
        handles.append(Patch(facecolor=NOTHING, edgecolor=GREY, linewidth=0.5, label="none found"))
    legend_above(ax, [handle for handle in handles if handle is not None])
    for note in chart.notes:
        report(note)
    return ax


def _fill_of(count: int | None) -> str:
    return NOT_KNOWN if count is None else FILLS[min(count, len(FILLS) - 1)]


def _fill(ax: Axes, chart: Chart) -> None:
    """The cells of regions in the colours of what is there."""
    shown = [region.shown for region in chart.regions]
    colors = [NOTHING, *(NOTHING if s is None else _fill_of(s.unstable) for s in shown)]
    extent = (chart.low[0], chart.high[0], chart.low[1], chart.high[1])
    look: dict[str, Any] = {"origin": "lower", "aspect": "auto", "interpolation": "nearest", "zorder": 0}
    ax.imshow(
        chart.labels + 1,
        extent=extent,
        cmap=ListedColormap(colors),
        vmin=-0.5,
        vmax=len(colors) - 0.5,
        gid="regions",
        **look,
    )
    beyond = [k for k, s in enumerate(shown) if s is not None and not s.admissible]
    if beyond:
        rows, columns = chart.labels.shape
        xs = np.linspace(extent[0], extent[1], columns)
        ys = np.linspace(extent[2], extent[3], rows)
        inside = np.isin(chart.labels, beyond).astype(float)
        ax.contourf(xs, ys, inside, levels=[0.5, 1.5], colors="none", hatches=[HATCH], zorder=1)


def _name(ax: Axes, chart: Chart, number: int, region: Region) -> None:
    """The numbers of unstable directions of all solutions, where the region has room for them."""
    own = chart.labels == number
    if min(int(own.any(axis=0).sum()), int(own.any(axis=1).sum())) < ROOM:
        return
    text = " ".join("?" if count is None else str(count) for count in region.counts) or "\N{EN DASH}"
    ax.text(
        *region.at, text, ha="center", va="center", fontsize=9, color=INK, zorder=5, gid=f"region-{number}"
    )
