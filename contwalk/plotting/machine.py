"""The machine itself at one instant, as its plugin draws it."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from inspect import signature

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.text import Text

from contwalk.errors import ContwalkError, PluginError
from contwalk.plotting.style import new_axes
from contwalk.plotting.style import title as write_title
from contwalk.system import System
from contwalk.system.declarations import ParameterValues, nearest

SCENERY = "scenery"  # gid of what a plugin draws that stands still


def plot_machine(
    system: System,
    state: Sequence[float] | np.ndarray | Mapping[str, float],
    parameters: Mapping[str, float],
    ax: Axes | None = None,
    title: str | None = None,
    *,
    t: float = 0.0,
) -> Axes:
    """Draw a machine with the system's own `draw(ax, t, x, p)`, at equal scale in both directions.

    Parameters
    ----------
    system : System
    state : array of shape (n,), or mapping
        In the order and units of the system's states, or by their names.
    parameters : mapping
        Values by name; the system's defaults fill in what is not given.
    ax : Axes, optional
        Where to draw; new axes by default.
    title : str, optional
    t : float
        Time in seconds, which matters to a forced machine only.

    Raises
    ------
    ContwalkError
        If the system has no `draw`, or the state or a parameter does not fit it.
    PluginError
        If `draw` raises; the sentence names its line.
    """
    x = _state(system, state)
    p = ParameterValues(**parameters_of(system, parameters))
    require_draw(system)
    ax = ax or new_axes("machine")
    ax.set_aspect("equal", adjustable="datalim")
    draw_instant(system, ax, t, x, p)
    if not ax.get_autoscale_on():  # limits that the plugin has set are kept
        ax.set_adjustable("box")
    hide_cut(ax, scenery(ax.get_children()))
    if title:
        write_title(ax, title)
    return ax


def require_draw(system: System) -> None:
    """Refuse a system that cannot be drawn.

    Raises
    ------
    ContwalkError
        If it has no `draw`.
    """
    if system.draw is None:
        raise ContwalkError(
            f"System '{system.name}' cannot be drawn: it declares no draw.",
            "Give the plugin a function draw(axes, t, x, p) and declare System(..., draw=draw).",
        )


def walks(system: System) -> bool:
    """Whether the machine gets somewhere: its `draw` asks for the motion until then, `so_far`."""
    if system.draw is None:
        return False
    try:
        return "so_far" in signature(system.draw).parameters
    except (TypeError, ValueError):  # a callable that does not tell
        return False


def draw_instant(
    system: System,
    ax: Axes,
    t: float,
    x: np.ndarray,
    p: ParameterValues,
    so_far: tuple[np.ndarray, np.ndarray] | None = None,
) -> None:
    """Draw the machine at one instant onto axes.

    Parameters
    ----------
    system : System
        It has a `draw`.
    ax : Axes
    t, x, p
        Time in seconds, state of shape (n,), parameters by name.
    so_far : tuple of ndarray, optional
        Times and states until then, for a `draw` that asks for them: one of a machine that `walks`.

    Raises
    ------
    PluginError
        If `draw` raises; the sentence names its line.
    """
    assert system.draw is not None
    given = {} if so_far is None else {"so_far": so_far}
    try:
        system.draw(ax, t, x, p, **given)
    except ContwalkError:
        raise
    except (Exception, SystemExit) as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        raise PluginError(
            f"The draw of system '{system.name}' failed at {frame.filename}, line {frame.lineno}: "
            f"{type(error).__name__}: {error}.",
            "Correct the plugin's draw(axes, t, x, p).",
        ) from error


def scenery(artists: Sequence[Artist]) -> list[Artist]:
    """Those of the artists that stand still, such as the ground: a plugin marks them by their gid."""
    return [artist for artist in artists if artist.get_gid() == SCENERY]


def hide_cut(ax: Axes, artists: Sequence[Artist]) -> None:
    """Hide those texts among artists that the side of the picture would cut."""
    texts = [artist for artist in artists if isinstance(artist, Text)]
    if not texts:
        return
    root = ax.figure.canvas.figure
    root.draw_without_rendering()
    frame = ax.get_window_extent()
    for text in texts:
        box = text.get_window_extent()
        text.set_visible(frame.x0 <= box.x0 and box.x1 <= frame.x1)


def _state(system: System, state: Sequence[float] | np.ndarray | Mapping[str, float]) -> np.ndarray:
    names = system.state_names
    if isinstance(state, Mapping):
        _require_known(system, "state", list(state), names)
        missing = [name for name in names if name not in state]
        if missing:
            raise ContwalkError(
                f"The state to draw lacks {', '.join(missing)}.", "Give a value for each state of the system."
            )
        state = [state[name] for name in names]
    x = np.asarray(state, dtype=float)
    if x.shape != (len(names),):
        raise ContwalkError(
            f"The state to draw has the shape {x.shape}.",
            f"It must have {len(names)} entries: {', '.join(names)}.",
        )
    return x


def parameters_of(system: System, parameters: Mapping[str, float]) -> dict[str, float]:
    """All parameters: the given ones, and defaults.

    Raises
    ------
    ContwalkError
        For a name that the system does not have.
    """
    _require_known(system, "parameter", list(parameters), system.parameter_names)
    return {**system.defaults(), **{name: float(value) for name, value in parameters.items()}}


def _require_known(system: System, what: str, names: Sequence[str], known: Sequence[str]) -> None:
    for name in names:
        if name not in known:
            raise ContwalkError(
                f"'{name}' is not a {what} of system '{system.name}'.",
                f"{nearest(name, known)} Known: {', '.join(known)}.".strip(),
            )
