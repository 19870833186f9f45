"""How far a motion may be pushed at some of its instants: a bar for each state and sign."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contwalk.errors import ContwalkError
from contwalk.plotting.quantities import axis_label
from contwalk.plotting.style import GREY, INK, PALETTE, dress, light, new_grid

MOST_COLUMNS = 5
ROW = 0.19  # inches for a state
DIGITS = 3
# Beyond the largest border there is room for its number.
ROOM = 3.5
PICTURE = 1.7  # inches for a machine above its panel
# Of the largest border: a smaller one is none at all, and gets no bar.
NOTHING = 1e-9


def plot_margins(
    rows: Sequence[Mapping[str, Any]],
    fractions: Sequence[float],
    axes: Sequence[Axes] | None = None,
    *,
    units: Mapping[str, str] | None = None,
    draw: Callable[[int, Axes], None] | None = None,
) -> Figure:
    """Draw margins, a panel for each instant: to the left how far a state may be pushed down, right up.

    Bars are logarithmic, each with its number; units stand beside the names of the states. A pale bar is one
    beyond whose border survival begins again further out; an arrow says that no border was met.

    Parameters
    ----------
    rows : sequence of mapping
        `instant`, `state`, `sign`, `border` (None where none was met) and `several`.
    fractions : sequence of float
        Of the closure, for each instant.
    axes : sequence of Axes, optional
        Where to draw, one for each instant, and with `draw` one more for each; new ones by default.
    units : mapping, optional
        Units by name.
    draw : callable, optional
        Draws the machine at an instant, by its number, into axes above the panel.

    Returns
    -------
    Figure

    Raises
    ------
    ContwalkError
        If there is no row.
    """
    if not rows:
        raise ContwalkError("There are no margins to draw.", "Give a row for each state and sign.")
    states = list(dict.fromkeys(str(row["state"]) for row in rows))
    known = [float(row["border"]) for row in rows if row["border"]]
    high = max(known, default=1.0)
    low = min([border for border in known if border > NOTHING * high], default=0.1)
    floor = 10.0 ** math.floor(math.log10(low) - 0.2)
    reach = math.log10(ROOM * high / floor)
    if axes is None:
        axes = _new_axes(len(fractions), max(ROW * len(states) + 1.1, 2.2), pictured=draw is not None)
    for number, ax in enumerate(axes[: len(fractions)]):
        _panel(ax, [row for row in rows if row["instant"] == number], states, floor, reach)
        above = ax if draw is None else axes[len(fractions) + number]
        after = f": after {fractions[number]:.4g} of the closure" if fractions[number] else ""
        above.set_title(f"instant {number}{after}", fontsize=8.5, color=INK)
        if draw is not None:
            draw(number, above)
            above.set_axis_off()
            for text in above.texts:  # as many would not fit as fit
                text.set_visible(False)
        named = number % MOST_COLUMNS == 0
        ax.set_yticks(range(len(states)), [axis_label(s, units) for s in states] if named else [])
    return _figure_of(axes[0])


def _new_axes(number: int, height: float, pictured: bool) -> list[Axes]:
    """Panels of so many inches, a few of them in a line, then axes for the machines above them."""
    columns = min(number, MOST_COLUMNS)
    lines = -(-number // columns)
    if not pictured:
        panels = new_grid("margins", number, columns)
        _figure_of(panels[0]).set_figheight(lines * height)
        return panels
    grid = new_grid("margins", 2 * lines * columns, columns, heights=(PICTURE, height) * lines)
    _figure_of(grid[0]).set_figheight(lines * (PICTURE + height))
    rows = [grid[first : first + columns] for first in range(0, len(grid), columns)]
    pictures, panels = ([ax for row in rows[which::2] for ax in row] for which in (0, 1))
    for ax in (*pictures[number:], *panels[number:]):
        ax.remove()
    return [*panels[:number], *pictures[:number]]


def _figure_of(ax: Axes) -> Figure:
    figure = ax.figure
    assert isinstance(figure, Figure)
    return figure


def _panel(
    ax: Axes, rows: Sequence[Mapping[str, Any]], states: Sequence[str], floor: float, reach: float
) -> None:
    for row in rows:
        place, sign = states.index(row["state"]), float(row["sign"])
        if row["border"] is None:
            ax.annotate(
                "",
                (sign * reach, place),
                (0.0, place),
                arrowprops={"arrowstyle": "->", "color": GREY, "lw": 0.9},
            )
            continue
        length = math.log10(max(row["border"] / floor, 1.0))
        color = PALETTE[0] if sign > 0.0 else PALETTE[1]
        shade = light(color, 0.55) if row["several"] else color
        ax.barh(place, sign * length, height=0.7, color=shade, zorder=2)
        ax.text(
            sign * (length + 0.02 * reach),
            place,
            f"{row['border']:.{DIGITS}g}",
            ha="left" if sign > 0.0 else "right",
            va="center",
            fontsize=6.5,
            color=INK,
        )
    there = {row["state"] for row in rows}
    for place, state in enumerate(states):
        if state not in there:
            ax.text(
                0.0,
                place,
                "not pushed",
                ha="center",
                va="center",
                fontsize=6.5,
                color=GREY,
                backgroundcolor="white",
                zorder=4,
            )
    dress(ax, "push down          push up", "")
    ax.axvline(0.0, color=INK, linewidth=0.7, zorder=3)
    ax.set_xlim(-1.35 * reach, 1.35 * reach)
    ax.spines["left"].set_visible(False)
    ax.set_ylim(len(states) - 0.4, -0.6)
    ax.set_xticks([])
    ax.tick_params(axis="y", labelsize=7.5, length=0)
