"""The machine itself at one instant, as its plugin draws it."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from contwalk.errors import ContwalkError, PluginError
from contwalk.plotting.style import new_axes
from contwalk.plotting.style import title as write_title
from contwalk.system import System
from contwalk.system.declarations import ParameterValues, nearest


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
    if system.draw is None:
        raise ContwalkError(
            f"System '{system.name}' cannot be drawn: it declares no draw.",
            "Give the plugin a function draw(axes, t, x, p) and declare System(..., draw=draw).",
        )
    x = _state(system, state)
    p = ParameterValues(**_parameters(system, parameters))
    ax = ax or new_axes("machine")
    ax.set_aspect("equal", adjustable="datalim")
    try:
        system.draw(ax, t, x, p)
    except ContwalkError:
        raise
    except Exception as error:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        raise PluginError(
            f"The draw of system '{system.name}' failed at {frame.filename}, line {frame.lineno}: "
            f"{type(error).__name__}: {error}.",
            "Correct the plugin's draw(axes, t, x, p).",
        ) from error
    if title:
        write_title(ax, title)
    return ax


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


def _parameters(system: System, parameters: Mapping[str, float]) -> dict[str, float]:
    _require_known(system, "parameter", list(parameters), system.parameter_names)
    return {**system.defaults(), **{name: float(value) for name, value in parameters.items()}}


def _require_known(system: System, what: str, names: Sequence[str], known: Sequence[str]) -> None:
    for name in names:
        if name not in known:
            raise ContwalkError(
                f"'{name}' is not a {what} of system '{system.name}'.",
                f"{nearest(name, known)} Known: {', '.join(known)}.".strip(),
            )
