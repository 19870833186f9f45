"""The bifurcation diagram: branches in the plane of a parameter and a quantity, with their special points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D

from contwalk.branch import Branch, SpecialPoint
from contwalk.plotting.branch_kinds import kinds_of
from contwalk.plotting.branch_lines import HATCHING, INLAY, LIGHTER, LOOKS, STABLE, WHITE, Pen
from contwalk.plotting.labels import Label, place_labels
from contwalk.plotting.orbit_values import default_y, drawn_by
from contwalk.plotting.quantities import (
    axis_label,
    called,
    default_x,
    values,
    with_names,
    written,
)
from contwalk.plotting.segments import Run, position, runs
from contwalk.plotting.smooth_curves import Curve, curve_of
from contwalk.plotting.special_points import legend_entries, marker
from contwalk.plotting.style import (
    GREY,
    INK,
    PALETTE,
    dark,
    dress,
    legend_beside,
    light,
    new_axes,
    size_of,
    title,
)

MOST_NAMED_BRANCHES = 12
MANY_LABELS = 16  # more than these need a larger figure


def plot_bifurcation_diagram(
    branches: Sequence[Branch],
    x: str | None = None,
    y: str | None = None,
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
    parameters: Mapping[str, float] | None = None,
    xlim: tuple[float, float] | None = None,
    ylim: tuple[float, float] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> Axes:
    """Draw branches: stable solid, unstable dashed and thin, not admissible light on grey hatching.

    The style changes exactly at the special points. Located ones are filled, unlocated ones hollow.
    Where lines lie over one another, as those of mirror images do, they are drawn once; an unstable one on a
    stable one is dashes in it. Branches of one name are called b1, b2, ... in the order that they have here.

    Parameters
    ----------
    branches : sequence of Branch
        Those that lack `x` or `y` are left out.
    x, y : str, optional
        Any name or scalar column a branch understands, also a fixed parameter. Default: the first free
        parameter; the system's first own observable that has a value, else its first such state. A state of
        orbits is drawn by its largest and least value, at events where there are some: see `orbit_values`.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name for the axis labels, as from `units_of(system)`.
    parameters : mapping, optional
        Values to state above the diagram, such as those held fixed.
    xlim, ylim : tuple of float, optional
        The part that is shown; all by default.
    report : callable
        Given a sentence where nothing is drawn, or one that lists the special points for whose names there
        is no room.

    Raises
    ------
    ContwalkError
        If there is no branch, or none has `x` and `y`.
    """
    x = x or default_x(branches)
    y = y or default_y(branches)
    drawn = with_names(branches, [x, y])
    own = ax is None
    ax = ax or new_axes("bifurcation_diagram")
    by = drawn_by(drawn, y, units)
    dress(ax, axis_label(x, units), by.label)
    names = called(drawn)
    pairs = [
        [np.stack([_values(b, x), _values(b, n)], axis=1) for n in by.names[k]] for k, b in enumerate(drawn)
    ]
    low, high = _corners(np.concatenate([each for pair in pairs for each in pair]), xlim, ylim)
    curves = {
        number: [
            curve_of(branch, (x, name), each, high - low)
            for name, each in zip(by.names[number], pairs[number], strict=True)
        ]
        for number, branch in enumerate(drawn)
    }
    inks = [curve.points for each in curves.values() for curve in each]
    pen = Pen(ax, *_corners(np.concatenate(inks), xlim, ylim))
    for number, branch in enumerate(drawn):
        for which, curve in enumerate(curves[number]):
            pen.draw(branch, names[number], curve, _color(number), which)
    lie_over = pen.inlay()
    twice = _twice(drawn)
    labels = [
        label
        for number, branch in enumerate(drawn)
        for which, curve in enumerate(curves[number])
        for label in _draw_special(ax, branch, names[number], curve.rows, _color(number), twice, which)
    ]
    if not _frame(ax, np.concatenate(inks)):
        report(_nothing(x, y))
    if xlim is not None:
        ax.set_xlim(*xlim)
    if ylim is not None:
        ax.set_ylim(*ylim)
    seen = [_seen(ax, branch, curves[number]) for number, branch in enumerate(drawn)]
    handles = _meanings(seen, lie_over) + _distinguished(drawn, names, units)
    _legend(ax, handles)
    _tell_unnamed(drawn, report)
    if parameters:
        title(ax, ",  ".join(_setting(name, value, units) for name, value in parameters.items()))
    if 1 < len(drawn) <= MOST_NAMED_BRANCHES:
        shown = {n: _shown(ax, each[0].points) for n, each in curves.items()}
        labels = _names(ax, names, shown, labels) + labels
    labels = [label for label in labels if len(_shown(ax, np.array([[label.x, label.y]])))]
    if own and len(labels) > MANY_LABELS:
        ax.figure.canvas.figure.set_size_inches(*size_of("crowded_diagram"))
    if left_out := place_labels(ax, labels, inks):
        _tell_left_out(ax, handles, left_out, report)
    return ax


def _tell_left_out(
    ax: Axes, handles: Sequence[Any], left_out: Sequence[str], report: Callable[[str], None]
) -> None:
    """Say in the legend how many names have no room, and in a sentence which."""
    _legend(ax, [*handles, Line2D([], [], linestyle="none", label=f"names left out: {len(left_out)}")])
    report(
        f"There is no room for the names of {len(left_out)} points in the bifurcation diagram: "
        f"{', '.join(left_out)}. Draw fewer branches, or a part of it (`xlim` and `ylim` of the figure), "
        "or look them up with `contwalk show`."
    )


def _corners(
    points: np.ndarray, xlim: tuple[float, float] | None, ylim: tuple[float, float] | None
) -> tuple[np.ndarray, np.ndarray]:
    """Lower left and upper right corner of what is shown."""
    finite = points[np.isfinite(points).all(axis=1)]
    low, high = (finite.min(axis=0), finite.max(axis=0)) if len(finite) else (np.zeros(2), np.ones(2))
    for axis, given in enumerate((xlim, ylim)):
        if given is not None:
            low[axis], high[axis] = min(given), max(given)
    return low, high


def _twice(branches: Sequence[Branch]) -> set[str]:
    """Names of special points that several of the branches have: they need the branch's own before them."""
    names = [point.name for branch in branches for point in branch.special_points if point.label != "EP"]
    return {name for name, count in Counter(names).items() if count > 1}


def _shown(ax: Axes, points: np.ndarray) -> np.ndarray:
    """Those of the points, shape (k, 2), that lie within the axes."""
    (left, right), (low, high) = sorted(ax.get_xlim()), sorted(ax.get_ylim())
    x, y = points.T
    return points[(x >= left) & (x <= right) & (y >= low) & (y <= high)]


def _values(branch: Branch, name: str) -> np.ndarray:
    found = values(branch, name)
    assert found is not None  # `with_names` left out the branches without it
    return found


def _color(number: int) -> str:
    return PALETTE[number % len(PALETTE)]


def _setting(name: str, value: float, units: Mapping[str, str] | None) -> str:
    unit = (units or {}).get(name, "1")
    return f"{name} = {value:g}" + ("" if unit in ("", "1") else f" {written(unit)}")


def _place(branch: Branch, points: np.ndarray, point: SpecialPoint) -> list[float]:
    """Where a special point is, among the points of a branch's curve, shape (k, 2)."""
    return [position(branch, points[:, axis], point.index, point.s) for axis in (0, 1)]


def _draw_special(
    ax: Axes, branch: Branch, name: str, points: np.ndarray, color: str, twice: set[str], which: int
) -> list[Label]:
    """Draw the markers on a curve of a branch; the labels of its first one, in the order along the branch."""
    labels = []
    for point in branch.special_points:
        at = _place(branch, points, point)
        look = marker(point.label, color, located=point.status == "located")
        again = f"-{which}" if which else ""
        ax.plot(at[:1], at[1:], gid=f"{name}-{point.name}{again}", **look)
        if point.label != "EP" and not which:
            text, plain = point.name or point.label, point.name not in twice
            labels.append(Label(text, at[0], at[1], dark(color), owner=name, plain=plain))
    return labels


def _names(
    ax: Axes, called: Sequence[str], curves: Mapping[int, np.ndarray], labels: Sequence[Label]
) -> list[Label]:
    """The branches' names, each at that of its two ends that is farther from all other labels and ends."""
    ends = {}
    for number, points in curves.items():
        finite = points[np.isfinite(points).all(axis=1)]
        if len(finite):
            ends[number] = finite[[-1, 0]]
    taken = [(label.x, label.y) for label in labels]
    names = []
    for number, mine in ends.items():
        others = [*taken, *(end for other, theirs in ends.items() if other != number for end in theirs)]
        apart = ax.transData.transform(mine)[:, None] - ax.transData.transform(np.reshape(others, (-1, 2)))
        room = np.hypot(apart[..., 0], apart[..., 1]).min(axis=1, initial=np.inf)
        x, y = mine[int(np.argmax(room))]
        names.append(Label(called[number], float(x), float(y), dark(_color(number)), bold=True))
    return names


def _nothing(x: str, y: str) -> str:
    """The sentence where no branch has a point."""
    return (
        f"Nothing is drawn: no point has finite values of both {x} and {y}. An angle that goes round has "
        "neither a largest nor a least value, an observable none where its event never happens. Draw another "
        "quantity, such as period."
    )


def _frame(ax: Axes, points: np.ndarray) -> bool:
    """Margins for markers and labels; a quantity that is constant but for rounding gets a plain axis.

    Whether there are points.
    """
    ax.margins(x=0.05, y=0.1)
    finite = points[np.isfinite(points).all(axis=1)]
    if len(finite) == 0:
        ax.text(0.5, 0.5, "no points", transform=ax.transAxes, ha="center", va="center", color=GREY)
        return False
    for axis, set_limits in ((0, ax.set_xlim), (1, ax.set_ylim)):
        low, high = finite[:, axis].min(), finite[:, axis].max()
        size = max(abs(low), abs(high))
        # Newton leaves 1e-15 or so of the magnitude; below 1e-12 a value is zero in any sensible unit.
        if size < 1e-12:
            set_limits(-1.0, 1.0)
        elif high - low < 1e-10 * size:
            set_limits(low - 0.1 * size, high + 0.1 * size)
    ax.autoscale_view()  # now, not lazily: the labels need the final scale
    return True


def _differing(drawn: Sequence[Branch]) -> tuple[list[dict[str, float]], list[str]]:
    """The fixed parameters of branches, and the names of those that are not the same on all of them."""
    free = {name for branch in drawn for name in branch.info.free}
    fixed = [{k: v for k, v in branch.info.parameters.items() if k not in free} for branch in drawn]
    if len(drawn) < 2 or "path" in free:
        return fixed, []
    return fixed, [name for name in fixed[0] if len({each.get(name) for each in fixed}) > 1]


def _tell_unnamed(drawn: Sequence[Branch], report: Callable[[str], None]) -> None:
    """Say where more branches are drawn than a legend names which of them is at which value."""
    differing = _differing(drawn)[1]
    if differing and len(drawn) > MOST_NAMED_BRANCHES:
        report(
            f"{len(drawn)} branches are drawn, and the legend names up to {MOST_NAMED_BRANCHES}: it does "
            f"not tell which of them are at which {' and '.join(differing)}. `contwalk show` does."
        )


def _distinguished(
    drawn: Sequence[Branch], names: Sequence[str], units: Mapping[str, str] | None
) -> list[Line2D]:
    """For branches at different values of fixed parameters, or of different periods, an entry each that
    states them.
    """
    fixed, differing = _differing(drawn)
    kinds = kinds_of(drawn)
    if not (differing or kinds) or len(drawn) > MOST_NAMED_BRANCHES:
        return []
    firsts = [f"{name}: {what}" for name, what in zip(names, kinds, strict=True)] if kinds else names
    texts = [
        "\n".join([first, *(_setting(name, each[name], units) for name in differing if name in each)])
        for first, each in zip(firsts, fixed, strict=True)
    ]
    return [Line2D([], [], color=_color(i), label=text, **STABLE) for i, text in enumerate(texts)]


def _seen(ax: Axes, branch: Branch, curves: Sequence[Curve]) -> tuple[list[Run], list[SpecialPoint]]:
    """The runs and the special points of a branch of which something lies within the axes."""
    if not len(branch):
        return [], []
    parts = [run for run in runs(branch) if any(_passes(ax, c.between(run.first, run.last)) for c in curves)]
    points = [
        point
        for point in branch.special_points
        if any(len(_shown(ax, np.array([_place(branch, curve.rows, point)]))) for curve in curves)
    ]
    return parts, points


def _passes(ax: Axes, line: np.ndarray) -> bool:
    """Whether a line, shape (k, 2), passes the axes, by the boxes about its segments."""
    limits = np.sort([ax.get_xlim(), ax.get_ylim()], axis=1)
    low, high = np.minimum(line[:-1], line[1:]), np.maximum(line[:-1], line[1:])
    if len(line) == 1:
        low = high = line
    return bool(np.all((low <= limits[:, 1]) & (high >= limits[:, 0]), axis=1).any())


def _meanings(seen: Sequence[tuple[list[Run], list[SpecialPoint]]], lie_over: bool) -> list[Any]:
    """What the lines and markers mean; only what is seen."""
    parts = [run for runs_, _ in seen for run in runs_]
    points = [point for _, points_ in seen for point in points_]
    handles: list[Any] = []
    for stable, (meaning, look) in LOOKS.items():
        if any(run.stable is stable for run in parts):
            handles.append(Line2D([], [], color=INK, label=meaning, **look))
    if lie_over:
        under = Line2D([], [], color=INK, label="both, over one another", **STABLE)
        handles.append((under, Line2D([], [], **INLAY)))
    if any(not run.admissible for run in parts):
        ties = Line2D([], [], label="not admissible", **HATCHING)
        rail = {**STABLE, "linewidth": LIGHTER * STABLE["linewidth"]}
        handles.append((ties, Line2D([], [], color=light(INK, WHITE), **rail)))
    return [*handles, *legend_entries(points)]


def _legend(ax: Axes, handles: Sequence[Any]) -> None:
    """The legend, outside the axes."""
    if handles:
        texts = [handle[0] if isinstance(handle, tuple) else handle for handle in handles]
        legend_beside(
            ax,
            handles,
            labels=[str(text.get_label()) for text in texts],
            handler_map={tuple: HandlerTuple(ndivide=1)},
            handlelength=2.6,
        )
