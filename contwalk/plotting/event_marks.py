"""Many events above a picture: a row for each place of the machine, a marker for what happens there."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.transforms import blended_transform_factory

from contwalk.plotting.style import GREY, INK

# More events than these are marks: their names would not stand beside each other.
MANY = 12
ROW = 0.05  # height of a row, in heights of the picture
MARKERS = ("v", "^", "|", "o", "s", "x", "D", "+")
OPEN = ("o", "s", "D")  # those that are drawn without a filling


def parts_of(name: str) -> tuple[str, str]:
    """Where an event happens and what it is: `toe11_on` is `on` at `toe11`; `landing` is a place itself."""
    place, _, what = name.rpartition("_")
    return (place, what) if place else (name, "")


def mark_events(ax: Axes, events: Sequence[tuple[float, str]], across: Callable[[float], float]) -> None:
    """Mark events in rows above what is drawn, each where the machine is then; the limits grow by the rows.

    Parameters
    ----------
    ax : Axes
        With limits around what is drawn.
    events : sequence of (float, str)
        Times and names.
    across : callable
        Where on the horizontal axis the machine is at a time.
    """
    rows = sorted({parts_of(name)[0] for _, name in events}, reverse=True)
    kinds = sorted({parts_of(name)[1] for _, name in events})
    low, top = ax.get_ylim()
    height = ROW * (top - low)
    ax.set_ylim(low, top + (len(rows) + 1) * height)
    beside = blended_transform_factory(ax.transAxes, ax.transData)
    for number, row in enumerate(rows, start=1):
        level = top + number * height
        ax.axhline(level, color=GREY, linewidth=0.3, zorder=0, gid="scenery-of-marks")
        ax.text(
            -0.01, level, row, transform=beside, ha="right", va="center", fontsize=7, color=INK, gid="row"
        )
    for number, kind in enumerate(kinds):
        marker = MARKERS[number % len(MARKERS)]
        at = [
            (across(time), rows.index(parts_of(name)[0]))
            for time, name in events
            if parts_of(name)[1] == kind
        ]
        ax.plot(
            [x for x, _ in at],
            [top + (row + 1) * height for _, row in at],
            linestyle="none",
            marker=marker,
            markersize=4.0,
            color=INK,
            markerfacecolor="white" if marker in OPEN else INK,
            markeredgewidth=0.8,
            label=kind or "event",
            gid=f"mark-{kind or 'event'}",
            zorder=20,
        )
