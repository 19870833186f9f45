"""How far a motion may be pushed at some instants: a bar for each state and sign, an axis for each unit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contwalk.errors import ContwalkError
from contwalk.plotting.quantities import axis_label, unit_of
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
    """Draw margins, a column for each instant: to the left how far a state may be pushed down, right up.

    States of one unit share a panel. Bars are logarithmic, each with its number. A pale bar is one
    beyond whose border survival begins again further out; an arrow says that no border was met.

    Parameters
    ----------
    rows : sequence of mapping
        `instant`, `state`, `sign`, `border` (None where none was met) and `several`.
    fractions : sequence of float
        Of the closure, for each instant.
    axes : sequence of Axes, optional
        Where to draw: for each unit one for each instant, and with `draw` one more for each; by default
        new ones.
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
    of_unit: dict[str, list[str]] = {}
    for state in dict.fromkeys(str(row["state"]) for row in rows):
        of_unit.setdefault(unit_of(state, units or {}), []).append(state)
    groups, instants = list(of_unit.values()), len(fractions)
    if axes is None:
        axes = _new_axes(instants, [len(states) for states in groups], pictured=draw is not None)
    for place, states in enumerate(groups):
        own = [row for row in rows if row["state"] in states]
        for number, ax in enumerate(axes[place * instants : (place + 1) * instants]):
            _panel(ax, [row for row in own if row["instant"] == number], states, *_scale(own))
            dress(ax, "push down          push up" if place == len(groups) - 1 else "", "")
            named = [axis_label(s, units) for s in states] if number % MOST_COLUMNS == 0 else []
            ax.set_yticks(range(len(named)), named)
            ax.tick_params(axis="y", labelsize=7.5, length=0)
    for number in range(instants):
        above = axes[number if draw is None else len(groups) * instants + number]
        after = f": after {fractions[number]:.4g} of the closure" if fractions[number] else ""
        above.set_title(f"instant {number}{after}", fontsize=8.5, color=INK)
        if draw is not None:
            draw(number, above)
            above.set_axis_off()
            for text in above.texts:  # as many would not fit as fit
                text.set_visible(False)
    return _figure_of(axes[0])


def _scale(rows: Sequence[Mapping[str, Any]]) -> tuple[float, float]:
    """Where bars of some rows begin, and how many powers of ten they reach."""
    known = [float(row["border"]) for row in rows if row["border"]]
    high = max(known, default=1.0)
    low = min([border for border in known if border > NOTHING * high], default=0.1)
    floor = 10.0 ** math.floor(math.log10(low) - 0.2)
    return floor, math.log10(ROOM * high / floor)


def _new_axes(number: int, sizes: Sequence[int], pictured: bool) -> list[Axes]:
    """Panels for so many states each, a few instants in a line, then axes for the machines above them."""
    columns = min(number, MOST_COLUMNS)
    lines = -(-number // columns)
    heights = [PICTURE] * pictured + [ROW * size + 0.6 for size in sizes]
    heights[-1] = max(heights[-1] + 0.5, 2.2 if len(sizes) == 1 else 0.0)
    grid = new_grid("margins", lines * len(heights) * columns, columns, heights=heights * lines)
    _figure_of(grid[0]).set_figheight(lines * sum(heights))
    kinds = []
    for which in range(len(heights)):
        rows = range(which, lines * len(heights), len(heights))
        places = [ax for row in rows for ax in grid[row * columns : (row + 1) * columns]]
        kinds.append(places[:number])
        for ax in places[number:]:
            ax.remove()
    return [ax for kind in (*kinds[pictured:], *kinds[:pictured]) for ax in kind]


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
    ax.axvline(0.0, color=INK, linewidth=0.7, zorder=3)
    ax.set_xlim(-1.35 * reach, 1.35 * reach)
    ax.spines["left"].set_visible(False)
    ax.set_ylim(len(states) - 0.4, -0.6)
    ax.set_xticks([])
