"""Orbits in the plane, or the space, of two or three quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from contwalk.errors import ContwalkError
from contwalk.plotting.overlaps import Cover
from contwalk.plotting.quantities import LONG, axis_label
from contwalk.plotting.style import INK, PALETTE, dress, is_narrow, legend_beside, light, new_axes

STABLE: dict[str, Any] = {"linestyle": "-", "linewidth": 1.4}
UNSTABLE: dict[str, Any] = {"linestyle": "--", "linewidth": 1.0, "dashes": (4.5, 2.5)}
# Where an event throws the state to; nothing moves along it.
JUMP: dict[str, Any] = {"linestyle": ":", "linewidth": 0.8, "dashes": (1.0, 2.0)}
WHITE = 0.5  # share of white in the colour of what is not admissible
LINE_OF_LEGEND = 0.19  # inches


def plot_phase_portrait(
    orbits: Sequence[np.ndarray],
    names: Sequence[str],
    ax: Axes | None = None,
    *,
    labels: Sequence[str] = (),
    stable: Sequence[bool] = (),
    admissible: Sequence[bool] = (),
    jumps: Sequence[np.ndarray] = (),
    periods: Sequence[int] = (),
    units: Mapping[str, str] | None = None,
) -> Axes:
    """Draw orbits in the plane of two quantities, or in the space of three.

    Parameters
    ----------
    orbits : sequence of array, shape (k, 2) or (k, 3)
        Each a curve in the order of time; a closed one repeats its first row at its end. A curve of one
        row, an equilibrium, is a dot (unstable: a ring). Rows that are not finite interrupt a curve.
    names : sequence of str
        What the columns are, two or three names.
    ax : Axes, optional
        Where to draw, of `projection="3d"` for three quantities; new axes by default.
    labels : sequence of str
        A name for each orbit, shown beside the axes. None by default.
    stable : sequence of bool
        Stable orbits are solid, unstable ones dashed and thin. All stable by default.
    admissible : sequence of bool
        Orbits that the machine cannot move on are light. All admissible by default.
    jumps : sequence of array, shape (j, 2, 2) or (j, 2, 3)
        For each orbit, the points before and after each event, joined by thin dotted lines. None by default.
    periods : sequence of int
        How many periods of the basic orbit each takes to close, 1, 2, 4 ...; 0 where it does not close.
        Told with the label.
    units : mapping, optional
        Units by name, as from `units_of(system)`.

    Raises
    ------
    ContwalkError
        If there is no orbit, or lengths or shapes do not fit each other.
    """
    curves = _checked(
        orbits, names, labels=labels, stable=stable, admissible=admissible, jumps=jumps, periods=periods
    )
    own = ax is None
    ax = ax or new_axes("phase_portrait", projection="3d" if len(names) == 3 else None)
    dress(ax, axis_label(names[0], units), axis_label(names[1], units))
    if len(names) == 3:
        _dress_depth(ax, axis_label(names[2], units))
    handles = []
    for number, curve in enumerate(curves):
        steady = stable[number] if stable else True
        color = PALETTE[number % len(PALETTE)]
        if admissible and not admissible[number]:
            color = light(color, WHITE)
        look = {"color": color, **(STABLE if steady else UNSTABLE)}
        if len(curve) == 1:
            look = {"color": look["color"], "linestyle": "none", "marker": "o", "markersize": 5.0}
            look["fillstyle"] = "full" if steady else "none"
        for part in [curve] if steady or len(names) == 3 else _once(curve):
            ax.plot(*part.T, gid=f"orbit-{number}", zorder=2, **look)
        for ends in jumps[number] if len(jumps) else ():
            ax.plot(*np.asarray(ends).T, gid=f"jump-{number}", zorder=1.9, color=color, **JUMP)
        text = _text(number, labels, periods)
        if text:
            handles.append(Line2D([], [], label=text, **look))
    if not all(admissible):
        which = "light" if any(admissible) else "all"
        handles.append(Line2D([], [], label=f"{which}: not admissible", color=light(INK, WHITE), **STABLE))
    if any(len(each) for each in jumps):
        handles.append(Line2D([], [], label="jump at an event", color=INK, **JUMP))
    ax.margins(0.06)
    if handles:
        _legend(ax, handles, own)
    return ax


def _once(curve: np.ndarray) -> list[np.ndarray]:
    """A curve, shape (k, 2), in parts that do not lie on each other: dashes would fill each other's gaps."""
    finite = curve[np.isfinite(curve).all(axis=1)]
    return Cover(finite.min(axis=0), finite.max(axis=0)).bare(curve) if len(finite) > 1 else [curve]


def _checked(orbits: Sequence[np.ndarray], names: Sequence[str], **given: Sequence[Any]) -> list[np.ndarray]:
    """The orbits as arrays of floats, everything about them of one length."""
    if len(names) not in (2, 3):
        raise ContwalkError(
            f"A phase portrait has two or three axes, not {len(names)}.", "Name two or three states."
        )
    if not len(orbits):
        raise ContwalkError("There is no orbit to draw.", "Give at least one array of states.")
    curves = [np.asarray(orbit, dtype=float) for orbit in orbits]
    for curve in curves:
        if curve.ndim != 2 or curve.shape[1] != len(names) or not len(curve):
            raise ContwalkError(
                f"An orbit to draw has the shape {curve.shape}.",
                f"It must have one row or more, with {len(names)} entries each: {', '.join(names)}.",
            )
    for what, values in given.items():
        if len(values) not in (0, len(curves)):
            raise ContwalkError(
                f"There are {len(curves)} orbits but {len(values)} {what}.",
                "Give one for each orbit, or none.",
            )
    return curves


def _text(number: int, labels: Sequence[str], periods: Sequence[int]) -> str:
    words = [labels[number]] if labels else []
    if periods:
        words.append(f"period {periods[number]}" if periods[number] else "does not close")
    return ", ".join(words)


def _dress_depth(ax: Axes, label: str) -> None:
    """The third axis in the style of the other two, all with few numbers: they stand at an angle."""
    ax.set_zlabel(label, fontsize=10, color=INK, labelpad=14)  # type: ignore[attr-defined]
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):  # type: ignore[attr-defined]
        axis.set_major_locator(MaxNLocator(4))
        axis.labelpad = 14
    ax.zaxis.set_tick_params(labelsize=8.5, labelcolor=INK, pad=7)  # type: ignore[attr-defined]
    ax.zaxis.get_offset_text().set_fontsize(8.5)  # type: ignore[attr-defined]
    ax.set_box_aspect(None, zoom=0.8)  # type: ignore[call-arg]  # room for the labels of the depth


def _legend(ax: Axes, handles: list[Line2D], own: bool) -> None:
    """Names beside the axes; long ones below them, where they take no width."""
    if is_narrow(ax.figure.canvas.figure):
        legend_beside(ax, handles, ncols=1)
        return
    below = max(len(str(handle.get_label())) for handle in handles) > LONG
    ax.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.0, -0.16) if below else (1.02, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize=8.5,
        labelcolor=INK,
        handlelength=2.6,
    )
    figure = ax.figure
    if below and own and isinstance(figure, Figure):
        width, height = figure.get_size_inches()
        figure.set_size_inches(width, height + LINE_OF_LEGEND * len(handles))
