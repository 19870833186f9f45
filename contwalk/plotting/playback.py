"""A motion as it is played: its state at any instant, and the way until then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from contwalk.errors import ContwalkError
from contwalk.plotting.machine import draw_instant, parameters_of, require_draw, walks
from contwalk.system import System
from contwalk.system.declarations import ParameterValues


class Playback:
    """A machine with a motion of it.

    Parameters
    ----------
    system : System
    times : array of shape (k,)
        Seconds, not falling; at an event, its instant twice.
    states : array of shape (k, n)
        At an event, the states on both sides.
    parameters : mapping
        Values by name; the system's defaults fill in what is not given.

    Raises
    ------
    ContwalkError
        If times, states or parameters do not fit the system.
    """

    def __init__(
        self,
        system: System,
        times: Sequence[float] | np.ndarray,
        states: Sequence[Sequence[float]] | np.ndarray,
        parameters: Mapping[str, float],
    ) -> None:
        self.system = system
        self.times = np.asarray(times, dtype=float)
        self.states = np.asarray(states, dtype=float)
        self.parameters = ParameterValues(**parameters_of(system, parameters))
        self._walks = walks(system)
        names = system.state_names
        if self.times.ndim != 1 or self.states.shape != (len(self.times), len(names)) or not len(self.times):
            raise ContwalkError(
                f"The motion to draw has times of shape {self.times.shape} and states of shape "
                f"{self.states.shape}.",
                f"States have a row for each time, and {len(names)} columns: {', '.join(names)}.",
            )
        if np.any(np.diff(self.times) < 0.0):
            raise ContwalkError("The times of the motion to draw fall.", "Give them in their order.")

    @property
    def begin(self) -> float:
        """Time of the first instant."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time of the last instant."""
        return float(self.times[-1])

    def until(self, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Times, shape (j,), and states, shape (j, n), from the beginning to an instant, in seconds.

        The instant is the last row; at an event, after it.
        """
        last = int(np.searchsorted(self.times, time, side="right")) - 1
        last = min(max(last, 0), len(self.times) - 1)
        times, states = self.times[: last + 1], self.states[: last + 1]
        if last + 1 == len(self.times) or time <= times[-1]:
            return times, states
        share = (time - times[-1]) / (self.times[last + 1] - times[-1])
        between = (1.0 - share) * states[-1] + share * self.states[last + 1]
        return np.append(times, time), np.vstack([states, between])

    def draw(self, ax: Axes, time: float) -> list[Artist]:
        """Draw the machine at an instant; what it added to the axes.

        Raises
        ------
        ContwalkError
            If the system has no `draw`; a `PluginError` if it raises.
        """
        require_draw(self.system)
        there = set(ax.get_children())
        ax.set_prop_cycle(None)  # the same colours at each instant
        self.draw_on(ax, time)
        return [artist for artist in ax.get_children() if artist not in there]

    def draw_on(self, ax: Any, time: float) -> None:
        """Draw the machine at an instant on what takes the calls of axes.

        Raises
        ------
        PluginError
            If the plugin's `draw` raises.
        """
        times, states = self.until(time)
        so_far = (times, states) if self._walks else None
        draw_instant(self.system, ax, float(times[-1]), states[-1], self.parameters, so_far)
