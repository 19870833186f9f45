"""Curves in two parameters, with their special points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from contwalk import quantities
from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.labels import MEANINGS
from contwalk.plotting.contours import is_contour, level_of, middle, quantity_of
from contwalk.plotting.labels import Label, place_labels
from contwalk.plotting.quantities import axis_label, called
from contwalk.plotting.smooth_curves import Curve, curve_of
from contwalk.plotting.special_points import legend_entries, marker
from contwalk.plotting.stable_sides import draw_ticks
from contwalk.plotting.style import GREY, INK, PALETTE, dark, dress, legend_above, new_axes

LINE: dict[str, Any] = {"linewidth": 1.6, "solid_capstyle": "round"}
# A curve of Hopf points beyond a Bogdanov-Takens point, where no eigenvalue is imaginary.
SADDLE: dict[str, Any] = {"linewidth": 1.0, "linestyle": (0, (1.0, 2.0))}
# The colour of a curve is by what it is of.
OF = ("LP", "HB", "BP", "PD", "NS", "GR", "OC", "AZ")
COLORS = (*PALETTE, "#8C564B", "#44337A")  # the last one is of kinds that somebody else adds
TICKS: dict[str, Any] = {"linestyle": "none", "markersize": 6.0, "markeredgewidth": 0.7}
# A curve of a marked value is a contour: nothing happens on it.
CONTOUR: dict[str, Any] = {"linewidth": 0.9, "solid_capstyle": "round"}


def plot_locus(
    branches: Sequence[Branch],
    x: str | None = None,
    y: str | None = None,
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> Axes:
    """Draw curves in two parameters: neutral saddles dotted, special points named, contours with values.

    Ticks point to where something is stable.

    Parameters
    ----------
    branches : sequence of Branch
        Those that are no curves in two parameters, or lack `x` or `y`, are left out. What curves were begun
        from tells on which side of them something is stable.
    x, y : str, optional
        Two parameters, states or observables; by default the first and the second free parameter.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name for the axis labels, as from `units_of(system)`.
    report : callable
        Given a sentence that lists the special points for whose names there is no room.

    Raises
    ------
    ContwalkError
        If there is no such curve.
    """
    curves = [branch for branch in branches if branch.info.problem == "locus" and len(branch)]
    if not curves:
        raise ContwalkError(
            "There is no curve in two parameters to draw.",
            "Compute one, as with loci: {with: PARAMETER, range: [lowest, highest]}.",
        )
    x, y = x or curves[0].info.free[0], y or curves[0].info.free[1]
    drawn = [branch for branch in curves if branch.knows(x) and branch.knows(y)]
    if not drawn:
        raise ContwalkError(f"No curve has both '{x}' and '{y}'.", f"Known: {', '.join(curves[0].names())}.")
    ax = ax or new_axes("locus")
    dress(ax, axis_label(x, units), axis_label(y, units))
    labels, inks, lines = [], [], []
    known: dict[tuple[float, ...], set[str]] = {}
    for branch, name in zip(drawn, called(drawn), strict=True):
        curve = curve_of(branch, (x, y), np.stack([branch[x], branch[y]], axis=1))
        lines.append(curve)
        inks.append(curve.points)
        _draw(ax, branch, name, curve)
        labels += _draw_special(ax, branch, name, curve.rows, known)
    labels += _levels(drawn, inks)
    ticks = [
        draw_ticks(ax, branches, branch, curve, ~saddles(branch), _color(branch))
        for branch, curve in zip(drawn, lines, strict=True)
    ]
    ax.margins(x=0.05, y=0.1)
    ax.autoscale_view()
    legend_above(ax, _meanings(drawn, any(ticks)))
    left_out = place_labels(ax, labels, inks)
    if left_out:
        report(
            f"There is no room for the names of {len(left_out)} points in the figure: "
            f"{', '.join(left_out)}. Draw fewer curves, or look them up with `contwalk show`."
        )
    return ax


def _color(branch: Branch) -> str:
    of = str(branch.info.settings["of"])
    if is_contour(branch):
        return GREY
    return COLORS[OF.index(of) if of in OF else len(OF)]


def saddles(branch: Branch) -> np.ndarray:
    """Which points of a curve are neutral saddles, shape (k,)."""
    return quantities.saddles(branch.info.observables, branch.points["observables"])


def _look(branch: Branch) -> dict[str, Any]:
    return CONTOUR if is_contour(branch) else LINE


def _draw(ax: Axes, branch: Branch, name: str, curve: Curve) -> None:
    """The line of a curve, in pieces where its kind changes; each reaches the first point of the next."""
    start, gaps = 0, np.array(branch.gaps(), dtype=int)
    for number, (real, members) in enumerate(groupby(saddles(branch).tolist())):
        stop = start + len(list(members))
        last = min(stop, len(branch) - 1)
        ends = [start, *(gaps[(gaps >= start) & (gaps < stop)] + 1), last + 1]
        nothing = np.full((1, 2), np.nan)
        lines = [np.vstack([curve.between(a, b - 1), nothing]) for a, b in pairwise(ends)]
        part = np.concatenate(lines)[:-1]
        look: dict[str, Any] = SADDLE if real else _look(branch)
        ax.plot(part[:, 0], part[:, 1], color=_color(branch), gid=f"{name}-{number}", zorder=2, **look)
        start = stop


def _draw_special(
    ax: Axes,
    branch: Branch,
    name: str,
    points: np.ndarray,
    known: dict[tuple[float, ...], set[str]],
) -> list[Label]:
    """The markers of a curve's special points, and the labels of those that are not yet `known` there."""
    color, labels = _color(branch), []
    for point in branch.special_points:
        if point.label == "EP":
            continue
        at = points[point.index]
        look = marker(point.label, color, located=point.status == "located")
        ax.plot(at[:1], at[1:], gid=f"{name}-{point.name}", **look)
        if point.label in known.setdefault(tuple(at.tolist()), set()):
            continue  # it lies on two curves
        known[tuple(at.tolist())].add(point.label)
        labels.append(Label(point.label, float(at[0]), float(at[1]), dark(color), owner=name, plain=True))
    return labels


def _levels(drawn: Sequence[Branch], lines: Sequence[np.ndarray]) -> list[Label]:
    """The values of contours, each half way along its line."""
    span = np.ptp(np.concatenate(lines), axis=0)
    span[span == 0.0] = 1.0
    labels = []
    for branch, points in zip(drawn, lines, strict=True):
        if is_contour(branch):
            x, y = middle(points, span)
            labels.append(Label(f"{level_of(branch):.6g}", x, y, dark(GREY), owner=branch.name, plain=True))
    return labels


def _meaning(of: str, alike: Sequence[Branch]) -> str:
    """What a line of a label means; of contours, what has the value that stands beside it."""
    names = [quantity_of(branch) for branch in alike if is_contour(branch)]
    return " and ".join(dict.fromkeys(names)) + " at the value beside it" if names else MEANINGS.get(of, of)


def _meanings(drawn: Sequence[Branch], ticks: bool) -> list[Any]:
    """What lines and markers mean; only what occurs."""
    handles: list[Any] = []
    for of in dict.fromkeys(str(branch.info.settings["of"]) for branch in drawn):
        alike = [branch for branch in drawn if branch.info.settings["of"] == of]
        text = f"{of}  {_meaning(of, alike)}"
        handles.append(Line2D([], [], color=_color(alike[0]), label=text, **_look(alike[0])))
    if any(saddles(branch).any() for branch in drawn):
        handles.append(Line2D([], [], color=INK, label="neutral saddles", **SADDLE))
    if ticks:
        handles.append(Line2D([], [], color=INK, marker="|", label="ticks: stable on this side", **TICKS))
    points = [point for branch in drawn for point in branch.special_points if point.label != "EP"]
    return handles + legend_entries(points)
