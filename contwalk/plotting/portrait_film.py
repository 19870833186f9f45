"""A motion without a picture of its machine: a point on its phase portrait, and the time series below."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from contwalk.number_words import in_brackets
from contwalk.plotting.playback import Playback
from contwalk.plotting.style import GREY, INK, PALETTE, dress
from contwalk.system import System

# Within the figure, left, low, width, height.
PORTRAIT, SERIES = (0.13, 0.43, 0.83, 0.47), (0.13, 0.09, 0.83, 0.22)
COLORS = dict(zip(("orbit", "point"), PALETTE, strict=False))


class PortraitFilm:
    """A figure of which a point and a line move; all else is drawn once.

    Parameters
    ----------
    motion : Playback
        Of a system without `draw`.
    events : sequence of (float, str)
        Times and names.
    title, below : str
    size, dpi
        Of the figure, as `Figure` takes them.
    beside : Playback, optional
        A second motion, whose point is pale.
    """

    def __init__(
        self,
        motion: Playback,
        events: Sequence[tuple[float, str]],
        title: str,
        below: str,
        *,
        size: tuple[float, float],
        dpi: float,
        beside: Playback | None = None,
    ) -> None:
        self.motion, self.beside = motion, beside
        self.figure = Figure(figsize=size, dpi=dpi)
        FigureCanvasAgg(self.figure)
        names = motion.system.state_names
        self.shown = (0, min(1, len(names) - 1))
        portrait, series = self.figure.add_axes(PORTRAIT), self.figure.add_axes(SERIES)
        dress(portrait, *(_named(motion.system, names[k]) for k in self.shown))
        dress(series, f"time{in_brackets(motion.system.time_unit)}", _named(motion.system, names[0]))
        self.figure.text(0.02, 0.975, title, fontsize=10, color=INK, va="top")
        self.figure.text(0.02, 0.935, below, fontsize=9, color=GREY, va="top", linespacing=1.4)
        for each, alpha in ((motion, 1.0), (beside, 0.35)):
            if each is not None:
                self._lines(portrait, series, each, alpha)
        for at, _ in events:
            series.axvline(at - motion.begin, color=GREY, linewidth=0.6)
        look: dict[str, Any] = {
            "marker": "o",
            "markersize": 8,
            "color": COLORS["point"],
            "zorder": 5,
            "clip_on": False,
        }
        (self.point,) = portrait.plot([], [], **look)
        (self.pale,) = portrait.plot([], [], **{**look, "color": GREY, "zorder": 4})
        (self.hand,) = series.plot([], [], **look)
        self.line = series.axvline(0.0, color=COLORS["point"], linewidth=1.0)

    def _lines(self, portrait: Axes, series: Axes, motion: Playback, alpha: float) -> None:
        """The way of a motion, broken at its events."""
        breaks = np.flatnonzero(np.diff(motion.times) == 0.0) + 1
        states = np.insert(motion.states, breaks, np.nan, axis=0)
        times = np.insert(motion.times, breaks, motion.times[breaks]) - motion.begin
        look: dict[str, Any] = {"color": COLORS["orbit"], "linewidth": 1.4, "alpha": alpha}
        portrait.plot(states[:, self.shown[0]], states[:, self.shown[1]], **look)
        series.plot(times, states[:, 0], **look)
        for row in breaks:
            jump = motion.states[[row - 1, row]]
            portrait.plot(*jump[:, list(self.shown)].T, color=GREY, linewidth=0.8, linestyle=":", alpha=alpha)

    def show(self, time: float) -> None:
        """Move to an instant."""
        x, y = self.shown
        state = self.motion.until(time)[1][-1]
        self.point.set_data([state[x]], [state[y]])
        if self.beside is not None:
            other = self.beside.until(time)[1][-1]
            self.pale.set_data([other[x]], [other[y]])
        since = time - self.motion.begin
        self.hand.set_data([since], [state[0]])
        self.line.set_xdata([since, since])


def _named(system: System, name: str) -> str:
    """A state with its unit."""
    return name + in_brackets(next(state.unit for state in system.states if state.name == name))
