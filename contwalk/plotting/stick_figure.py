"""The machine at several instants of a motion: in one picture where it gets somewhere, else side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from contwalk.plotting.event_marks import MANY, mark_events
from contwalk.plotting.machine import hide_cut, scenery
from contwalk.plotting.playback import Playback
from contwalk.plotting.slanted import tell
from contwalk.plotting.style import INK, asked_width, new_axes, new_grid, whole_title
from contwalk.plotting.style import title as write_title
from contwalk.system import System

Events = Sequence[tuple[float, str]]

# Instants of each segment between events, on average; of a motion without events.
OF_AN_ARC, OF_A_MOTION = 4, 8
# How light an instant is that is not one of events, and how thin both kinds are.
SHADE, THIN, STRONG = 0.4, 0.5, 0.8
AIR = 0.12  # beside the outermost instants, in heights of the picture
# Inches: height of the picture, its least and greatest width, what text around it takes, and events above it.
HEIGHT, NARROWEST, WIDEST, AROUND, ABOVE = 2.7, 5.6, 15.0, 0.85, 0.75
# Side by side: the area of an instant and its least and greatest width and height, what its title and numbers
# take, and the greatest width of all; inches.
AREA, SIDES, TITLE, NUMBERS, WHOLE = 4.5, (1.1, 3.6), 0.35, 0.45, 10.0
BACK = 1e-3  # how near to its beginning a motion is there again, in parts of the range of each state
COLUMNS = 4  # of the legend
BELOW_NUMBERS = -0.13  # where the legend begins if the plugin leaves the axes on, in heights of the axes


def plot_stick_figure(
    system: System,
    times: Sequence[float] | np.ndarray,
    states: Sequence[Sequence[float]] | np.ndarray,
    parameters: Mapping[str, float],
    ax: Axes | None = None,
    title: str | None = None,
    *,
    events: Events = (),
) -> Axes:
    """Draw a machine at several instants of a motion into one picture, each where the machine then is.

    Instants are evenly spaced in time between events. Those of events, of the beginning and of the end are
    strong, the others light. Where there are many events they are marks in rows above the picture; strong are
    then the instants at which the first event comes again.

    Parameters
    ----------
    system : System
        Its `draw` takes `so_far`, the motion until then, if the machine gets somewhere; else all instants lie
        over one another, and `plot_stick_panels` is the better figure.
    times, states : array of shape (k,), (k, n)
        The motion; at an event, its instant twice, with the states on both sides.
    parameters : mapping
        Values by name; the system's defaults fill in what is not given.
    ax : Axes, optional
        Where to draw; new axes by default, whose figure is as long as the way is.
    title : str, optional
    events : sequence of (float, str)
        Times and names of events, which are told beside their instants.

    Raises
    ------
    ContwalkError
        If the system has no `draw`, or what is given does not fit it.
    PluginError
        If `draw` raises.
    """
    motion = Playback(system, times, states, parameters)
    own = ax is None
    ax = ax or new_axes("stick_figure")
    many = len(events) > MANY
    named = () if many else events
    again = [time for time, name in events if name == events[0][1]]
    names = dict.fromkeys(again, "") if many else dict(events)
    still: list[Artist] = []
    limits, outlines, tops = [], [], {}
    for time in instants(motion, [(time, "") for time in again] if many else events):
        added = motion.draw(ax, time)
        for artist in still:
            artist.remove()
        still = scenery(added)
        machine = [artist for artist in added if artist not in still]
        _shade(machine, time in names or time in (motion.begin, motion.end))
        limits.append([*ax.get_xlim(), *ax.get_ylim()])
        lines = [np.asarray(artist.get_xydata()) for artist in machine if isinstance(artist, Line2D)]
        outlines += lines
        if lines:
            own_points = np.concatenate(lines)
            tops[time] = own_points[np.argmax(own_points[:, 1])]
    _frame(ax, np.array(limits), outlines)
    if many:
        drawn = sorted(tops)
        at = [float(tops[time][0]) for time in drawn]
        mark_events(ax, events, lambda time: float(np.interp(time, drawn, at)))
    if own:
        _fit(ax, ABOVE if named else 0.0)
    _legend(ax)
    passed = {time: motion.system.lasting(time - motion.begin, ".3f") for time, _ in named}
    labels = [(tops[time], f"{name}  {passed[time]}") for time, name in named if time in tops]
    reach = tell(ax, labels)
    if title and own:
        whole_title(ax.figure, title)
    elif title:
        write_title(ax, title, above=reach)
    hide_cut(ax, still)
    return ax


def plot_stick_panels(
    system: System,
    times: Sequence[float] | np.ndarray,
    states: Sequence[Sequence[float]] | np.ndarray,
    parameters: Mapping[str, float],
    title: str | None = None,
    *,
    events: Events = (),
) -> list[Axes]:
    """Draw a machine at several instants of a motion side by side, in the order of time.

    Parameters
    ----------
    system, times, states, parameters, title, events
        As for `plot_stick_figure`.

    Raises
    ------
    ContwalkError
        If the system has no `draw`, or what is given does not fit it.
    PluginError
        If `draw` raises.
    """
    motion = Playback(system, times, states, parameters)
    chosen = instants(motion, events) if len(events) else _evenly(motion)
    limits, numbered = _common_limits(motion, chosen)
    axes = _panels(len(chosen), limits, numbered)
    names = dict(events)
    for ax, time in zip(axes, chosen, strict=True):
        motion.draw(ax, time)
        ax.set_aspect("equal", adjustable="box")
        if ax.get_autoscale_on():  # the plugin leaves the limits open: the same for all instants
            ax.set(xlim=limits[:2], ylim=limits[2:])
        name = f", {names[time]}" if time in names else ""
        write_title(ax, f"{motion.system.lasting(time - motion.begin, '.4g')}{name}")
    if title:
        whole_title(axes[0].figure, title)
    return axes


def _evenly(motion: Playback) -> list[float]:
    """Instants of a motion without events; its end not where the motion is at its beginning again."""
    apart = motion.states[-1] - motion.states[0]
    turns = np.array([state.period or np.inf for state in motion.system.states])
    finite = np.isfinite(turns)
    apart[finite] -= turns[finite] * np.round(apart[finite] / turns[finite])
    back = len(motion.times) > 1 and bool(np.all(np.abs(apart) <= BACK * np.ptp(motion.states, axis=0)))
    return np.unique(np.linspace(motion.begin, motion.end, OF_A_MOTION + back)[:OF_A_MOTION]).tolist()


def _common_limits(motion: Playback, times: Sequence[float]) -> tuple[np.ndarray, bool]:
    """Limits that hold the machine at all instants, and whether its axes have numbers."""
    found, ax = [], Figure().add_subplot()
    for time in times:
        ax.clear()
        motion.draw(ax, time)
        found.append([*ax.get_xlim(), *ax.get_ylim()])
    box = np.array(found)
    return np.array([box[:, 0].min(), box[:, 1].max(), box[:, 2].min(), box[:, 3].max()]), ax.axison


def _panels(number: int, limits: np.ndarray, numbered: bool) -> list[Axes]:
    """Axes in rows, each of the proportions of what is shown; rows of nearly the same number."""
    aspect = (limits[1] - limits[0]) / (limits[3] - limits[2])
    sides = np.clip([np.sqrt(AREA * aspect), np.sqrt(AREA / aspect)], *SIDES)
    width, height = min(sides[0], aspect * sides[1]), min(sides[1], sides[0] / aspect)
    width, height = max(width, SIDES[0]) + NUMBERS * numbered, height + TITLE + NUMBERS * numbered
    rows = -(-number // int(np.clip(WHOLE // width, 1, number)))
    columns = -(-number // rows)
    axes = new_grid("stick_panels", number, columns)
    figure = axes[0].figure
    assert isinstance(figure, Figure)
    figure.set_size_inches(width * columns, height * rows + TITLE)
    return axes


def instants(motion: Playback, events: Events) -> list[float]:
    """Times of the instants that are drawn: the ends, all events, and even steps between them."""
    marks = np.unique([motion.begin, *(time for time, _ in events), motion.end])
    lengths = np.diff(marks)
    if not len(lengths):
        return [motion.begin]
    number = OF_AN_ARC * len(lengths) if len(events) else OF_A_MOTION
    result = [motion.begin]
    for start, end in pairwise(marks.tolist()):
        steps = max(round(number * (end - start) / float(lengths.sum())), 1)
        result += [start + (end - start) * k / steps for k in range(1, steps)]
        result.append(end)
    return result


def _shade(artists: Sequence[Artist], strong: bool) -> None:
    """What an instant adds: strong ones in front, the others light and thin."""
    for artist in artists:
        alpha = artist.get_alpha()
        opaque = 1.0 if alpha is None else float(alpha)
        if isinstance(artist, Line2D):
            thin = STRONG if strong else THIN
            artist.set_linewidth(thin * artist.get_linewidth())
            artist.set_markersize(thin * artist.get_markersize())
            artist.set_alpha(opaque if strong else SHADE * opaque)
        else:  # areas, many of which lie over one another
            artist.set_alpha((0.5 if strong else 0.15) * opaque)
        if strong:
            artist.set_zorder(artist.get_zorder() + 10)


def _frame(ax: Axes, limits: np.ndarray, outlines: Sequence[np.ndarray]) -> None:
    """Limits that show all instants: of those the plugin has set, what is not empty."""
    left, low = limits[:, 0].min(), limits[:, 2].min()
    right, high = limits[:, 1].max(), limits[:, 3].max()
    if outlines:
        points = np.concatenate(outlines)
        points = points[np.isfinite(points).all(axis=1)]
        air = AIR * (high - low)
        left, right = max(left, points[:, 0].min() - air), min(right, points[:, 0].max() + air)
        high = min(high, points[:, 1].max() + 0.3 * air)
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)
    ax.set_aspect("equal", adjustable="box")


def _fit(ax: Axes, above: float) -> None:
    """Make the figure as long as its axes need, with room above them; a short way fills a square at most."""
    figure = ax.figure
    assert isinstance(figure, Figure)
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    aspect = (right - left) / (high - low)
    rows = [text.get_window_extent().width for text in ax.texts if text.get_gid() == "row"]
    beside = max(rows, default=0.0) / figure.dpi
    width = asked_width() or min(max(HEIGHT * aspect + beside, NARROWEST), WIDEST)
    figure.set_size_inches(width, min((width - beside) / aspect, NARROWEST) + AROUND + above)


def _legend(ax: Axes) -> None:
    """The names that the plugin has given to what it draws, below the picture."""
    handles, names = ax.get_legend_handles_labels()
    first = {name: handle for handle, name in reversed(list(zip(handles, names, strict=True)))}
    if first:
        entries = [_entry(first[name], name) for name in sorted(first)]
        ax.legend(
            handles=entries,
            loc="upper left",
            bbox_to_anchor=(0.0, BELOW_NUMBERS if ax.axison else -0.01),
            borderaxespad=0.0,
            ncols=min(len(entries), COLUMNS),
            frameon=False,
            fontsize=8.5,
            labelcolor=INK,
        )


def _entry(artist: Artist, name: str) -> Artist:
    """A line of the look of a drawn one, as strong as at an event; a marker where there is no line."""
    if not isinstance(artist, Line2D):
        return artist
    if str(artist.get_linestyle()).lower() in ("none", "", " "):
        look: dict[str, Any] = {"linestyle": "none", "marker": artist.get_marker(), "markersize": 6.0}
        look["markerfacecolor"] = artist.get_markerfacecolor()
        return Line2D([], [], color=artist.get_color(), label=name, **look)
    return Line2D([], [], color=artist.get_color(), linewidth=2.2, label=name)
