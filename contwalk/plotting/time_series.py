"""Quantities over time, with marks where events happen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contwalk.errors import ContwalkError
from contwalk.plotting import quantities
from contwalk.plotting.quantities import written
from contwalk.plotting.style import GREY, PALETTE, dress, legend_beside, new_axes, new_panels

MOST_LINES = 40  # events of one kind beyond it are ticks at the lower edge: lines would cover the curves
MOST_KINDS = 8  # kinds of events beyond it share one look: a legend of all would be taller than the axes
MOST_NAMED = 3  # quantities whose names fit beside an axis
EVENT_COLORS = PALETTE[::-1]  # from the other end, so that few curves and few events share no colour


def plot_time_series(
    times: np.ndarray,
    values: np.ndarray,
    names: Sequence[str],
    ax: Axes | None = None,
    *,
    events: Mapping[str, Sequence[float]] | None = None,
    units: Mapping[str, str] | None = None,
    time_label: str | None = None,
) -> Axes:
    """Draw quantities over time.

    Parameters
    ----------
    times : array of shape (k,)
        At a jump, the same time twice.
    values : array of shape (k, m)
        One column for each quantity; what is not finite interrupts its curve.
    names : sequence of m str
    ax : Axes, optional
        Where to draw; new axes by default.
    events : mapping, optional
        Times of events by name: thin upright lines, or ticks at the lower edge where there are many.
    units : mapping, optional
        Units by name. Quantities of one unit share it on the axis.
    time_label : str, optional
        What stands below the axis of time; `time` with its unit, where that is known, by default.

    Raises
    ------
    ContwalkError
        If lengths do not fit each other.
    """
    times, values = _checked(times, values, names)
    ax = ax or new_axes("time_series")
    dress(
        ax,
        time_label if time_label is not None else quantities.time_label(units),
        _common_label(names, units),
    )
    for column, name in enumerate(names):
        color = PALETTE[column % len(PALETTE)]
        ax.plot(
            times, values[:, column], color=color, linewidth=1.2, label=name, gid=f"series-{name}", zorder=2
        )
    ax.margins(x=0.0, y=0.08)
    _mark(ax, events or {})
    if len(names) > 1 or events:
        _legend(ax)
    return ax


def plot_time_series_panels(
    times: np.ndarray,
    values: np.ndarray,
    names: Sequence[str],
    *,
    events: Mapping[str, Sequence[float]] | None = None,
    units: Mapping[str, str] | None = None,
    time_label: str | None = None,
) -> list[Axes]:
    """As `plot_time_series`, with a panel for each unit: metres and radians do not share an axis."""
    times, values = _checked(times, values, names)
    groups: dict[str, list[int]] = {}
    for column, name in enumerate(names):
        groups.setdefault((units or {}).get(name, "1"), []).append(column)
    panels = new_panels("time_series", len(groups))
    for ax, columns in zip(panels, groups.values(), strict=True):
        label = time_label if ax is panels[-1] else ""
        shown = [names[column] for column in columns]
        plot_time_series(times, values[:, columns], shown, ax, units=units, time_label=label)
        _mark(ax, events or {})
        if ax is panels[0] and events:
            _legend(ax)  # again, with the events: one panel names them for all
    _share_time(panels)
    return panels


def _legend(ax: Axes) -> None:
    legend_beside(ax, ax.get_legend_handles_labels()[0], handlelength=1.8)


def _share_time(panels: Sequence[Axes]) -> None:
    for ax in panels[:-1]:
        ax.sharex(panels[-1])
        ax.tick_params(labelbottom=False)
    figure = panels[-1].figure
    assert isinstance(figure, Figure)
    figure.align_ylabels(panels)


def _checked(times: np.ndarray, values: np.ndarray, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    times, values = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if times.ndim != 1 or values.shape != (len(times), len(names)) or not len(names):
        raise ContwalkError(
            f"The series to draw has times of shape {times.shape}, values of shape {values.shape} "
            f"and {len(names)} names.",
            "Values have a row for each time and a column for each name.",
        )
    return times, values


def _common_label(names: Sequence[str], units: Mapping[str, str] | None) -> str:
    """The names with the unit that they share; the legend names them where they are many or share none."""
    shared = {(units or {}).get(name, "1") for name in names}
    if len(shared) > 1:
        return ""
    unit = shared.pop()
    names = names if len(names) <= MOST_NAMED else ()
    return ", ".join(names) + ("" if unit in ("", "1") else f" ({written(unit)})")


def _mark(ax: Axes, events: Mapping[str, Sequence[float]]) -> None:
    if len(events) > MOST_KINDS:
        every = sorted(t for at in events.values() for t in at)
        for position, t in enumerate(every):
            label = None if position else f"events ({len(every)})"
            ax.axvline(
                t, color=GREY, linewidth=0.5, linestyle=(0, (1.0, 1.5)), label=label, gid="events", zorder=1.5
            )
        return
    for number, (name, at) in enumerate(events.items()):
        color = EVENT_COLORS[number % len(EVENT_COLORS)]
        label = f"{name} ({len(at)})"
        if len(at) > MOST_LINES:
            y = np.full(len(at), 0.012 + 0.03 * number)
            ax.plot(
                np.asarray(at),
                y,
                linestyle="none",
                marker="|",
                markersize=5.0,
                color=color,
                transform=ax.get_xaxis_transform(),
                label=label,
                gid=f"event-{name}",
                zorder=3,
            )
            continue
        for position, t in enumerate(at):
            ax.axvline(
                t,
                color=color,
                linewidth=0.7,
                linestyle=(0, (1.0, 1.5)),
                label=None if position else label,
                gid=f"event-{name}",
                zorder=1.5,
            )
