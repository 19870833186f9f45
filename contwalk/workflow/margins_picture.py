"""The figure of margins from what is stored of them, with the machine as it is where it is pushed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from contwalk.errors import PluginError
from contwalk.storage.trajectory import Margins
from contwalk.system import System


def drawn_margins(margins: Margins, system: System | None, path: Path) -> str:
    """Draw them into a file: states in the system's order, above each panel the machine if it can be drawn.

    Parameters
    ----------
    margins : Margins
    system : System, optional
        Without it there are no machines.
    path : Path

    Returns
    -------
    str
        Why there are no machines, where their drawing has failed; else empty.

    Raises
    ------
    ContwalkError
        If there are no rows, or the file cannot be written.
    """
    from contwalk import plotting

    order = {name: place for place, name in enumerate(margins.states)}
    rows = sorted(margins.rows, key=lambda row: order.get(row["state"], len(order)))
    fractions = [instant["fraction"] for instant in margins.instants]
    units = margins.header.get("units") or ({} if system is None else plotting.units_of(system))
    figure, left_out = None, ""
    if system is not None and system.draw is not None:
        try:
            figure = plotting.plot_margins(rows, fractions, units=units, draw=_draw(system, margins))
        except PluginError as error:
            left_out = f"The machine is not drawn above its margins. {error}"
    if figure is None:
        figure = plotting.plot_margins(rows, fractions, units=units)
    plotting.save(figure.axes[0], path)
    return left_out


def _draw(system: System, margins: Margins) -> Callable[[int, Any], None]:
    """Draws the machine at an instant, by its number, into axes."""
    from contwalk import plotting

    parameters: Mapping[str, float] = margins.header["parameters"]

    def draw(number: int, ax: Any) -> None:
        instant = margins.instants[number]
        state = dict(zip(margins.states, instant["state"], strict=True))
        plotting.plot_machine(system, state, parameters, ax, t=instant["time"])

    return draw
