"""Spectra along branches in the complex plane: the common part of the eigenvalue and multiplier figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.plotting.quantities import axis_label, default_x, values, with_names
from contwalk.plotting.segments import admissible_segments
from contwalk.plotting.smooth_curves import slope_of
from contwalk.plotting.smooth_spectra import Loci, smooth_loci
from contwalk.plotting.style import INK, legend_above

_MARK: dict[str, Any] = {"linestyle": "none", "color": INK, "markerfacecolor": "none", "zorder": 4}
_START = {**_MARK, "marker": "x", "markersize": 6.5, "markeredgewidth": 1.3, "label": "start"}
_END = {**_MARK, "marker": "o", "markersize": 7.0, "markeredgewidth": 1.2, "label": "end"}
COLORS = "viridis"
WIDTH, THIN = 1.6, 0.9  # of lines where the machine can move so, and where it cannot
SHADE = "#F1F1F1"  # of the unstable part of the plane


def track(spectrum: np.ndarray) -> np.ndarray:
    """Reorder the rows so that each column follows one eigenvalue.

    Neighbouring rows are matched by nearest pairs first, which does not depend on the direction.

    Parameters
    ----------
    spectrum : array of shape (k, m), complex
        Padded with NaN.

    Returns
    -------
    array of shape (k, m), complex
        The same numbers row by row; NaN where a column's eigenvalue is absent.
    """
    tracked = np.array(spectrum, dtype=complex)
    for row in range(1, len(tracked)):
        tracked[row] = _matched(tracked[row - 1], tracked[row])
    return tracked


def _matched(previous: np.ndarray, current: np.ndarray) -> np.ndarray:
    result = np.full_like(current, np.nan)
    with np.errstate(invalid="ignore"):  # what is infinite has no neighbour
        distance = np.abs(previous[:, None] - current[None, :])
    free_columns, free_values = set(range(len(previous))), set(np.flatnonzero(~np.isnan(current)).tolist())
    for pair in np.argsort(distance, axis=None, kind="stable"):
        column, value = divmod(int(pair), len(current))
        if np.isnan(distance[column, value]):
            break  # NaN sorts last
        if column in free_columns and value in free_values:
            result[column] = current[value]
            free_columns.remove(column)
            free_values.remove(value)
    # What has no partner begins anew, in a column that held nothing if there is one.
    columns = sorted(free_columns, key=lambda column: (not np.isnan(previous[column]), column))
    for column, value in zip(columns, sorted(free_values), strict=False):
        result[column] = current[value]
    return result


def every_spectrum(branches: Sequence[Branch]) -> np.ndarray:
    """The tracked spectra of branches one below the other, shape (k, m), padded with NaN."""
    width = max(branch.info.spectrum for branch in branches)
    tracked = [track(branch["spectrum"]) for branch in branches]
    return np.concatenate(
        [np.pad(t, ((0, 0), (0, width - t.shape[1])), constant_values=np.nan) for t in tracked]
    )


def choose(branches: Sequence[Branch], problems: Sequence[str], what: str, other: str) -> list[Branch]:
    """The branches of these problems that have a spectrum; `ContwalkError` if there is none."""
    chosen = [branch for branch in branches if branch.info.problem in problems and branch.info.spectrum]
    if not chosen:
        raise ContwalkError(
            f"No branch has {what}.", f"Give a branch of a problem {' or '.join(problems)}; {other}."
        )
    return chosen


def draw_spectra(ax: Axes, branches: Sequence[Branch], units: Mapping[str, str] | None) -> np.ndarray:
    """Draw the loci with colour bar and end marks; returns all finite values drawn, complex, shape (k,)."""
    parameter = default_x(branches)
    chosen = with_names(branches, [parameter])
    colors = [np.asarray(values(branch, parameter)) for branch in chosen]
    norm = _norm(np.concatenate(colors))
    joints = _joints(chosen)
    marked: dict[str, list[float]] = {}
    for branch, color in zip(chosen, colors, strict=True):
        for mark, row in _draw(ax, branch, parameter, color, norm, joints).items():
            marked.setdefault(mark, []).append(float(color[row]))
    dots = LineCollection([], cmap=COLORS, norm=norm)
    dots.set_array(np.empty(0))
    bar = ax.figure.colorbar(dots, ax=ax, pad=0.02, aspect=28)
    bar.set_label(axis_label(parameter, units), fontsize=10, color=INK)
    bar.ax.tick_params(labelsize=8.5, width=0.7, length=3)
    bar.outline.set_linewidth(0.7)
    _legend(ax, parameter, chosen, marked)
    everything = np.concatenate([branch.points["spectrum"].ravel() for branch in chosen])
    return everything[np.isfinite(everything)]


def _norm(color: np.ndarray) -> Normalize:
    finite = color[np.isfinite(color)]
    low, high = (finite.min(), finite.max()) if len(finite) else (0.0, 1.0)
    if low == high:
        low, high = low - 0.05 * (abs(low) or 1.0), high + 0.05 * (abs(high) or 1.0)
    return Normalize(low, high)


def loci_of(branch: Branch, x: str) -> Loci:
    """The spectra of a branch over a quantity, drawn as curves."""
    across, s = np.asarray(values(branch, x)), branch["s"]
    slope = slope_of(branch, x, s, across) if len(s) > 1 else across
    return smooth_loci(s, track(branch.points["spectrum"]), across, slope)


def _joints(branches: Sequence[Branch]) -> set[tuple[str, float]]:
    """Ends of branches at which others of them go on, and the starts of these: name and arclength of each."""
    ends = {
        (branch.name, s) for branch in branches if len(branch) for s in branch.points["s"][[0, -1]].tolist()
    }
    found = [(branch.name, branch.info.parent) for branch in branches if branch.info.parent in ends]
    return {joint for name, parent in found if parent is not None for joint in (parent, (name, 0.0))}


def _draw(
    ax: Axes,
    branch: Branch,
    parameter: str,
    color: np.ndarray,
    norm: Normalize,
    joints: set[tuple[str, float]],
) -> dict[str, int]:
    """Draw one branch; at which rows its start and its end are marked."""
    if len(branch) == 0:
        return {}
    fine = loci_of(branch, parameter)
    admissible = admissible_segments(branch)
    coloured = [
        (_joined(a, b), (fine.across[i] + fine.across[i + 1]) / 2, WIDTH if admissible[row] else THIN)
        for i, row in enumerate(fine.rows[:-1].tolist())
        for a, b in zip(fine.values[i], fine.values[i + 1], strict=True)
        if np.isfinite(a) and np.isfinite(b)
    ]
    lines = LineCollection([line for line, _, _ in coloured], cmap=COLORS, norm=norm, zorder=3)
    lines.set_capstyle("round")
    lines.set_linewidth([width for _, _, width in coloured])
    lines.set_array([shade for _, shade, _ in coloured])
    lines.set_gid(f"{branch.name}-loci")
    ax.add_collection(lines)
    loci = track(branch.points["spectrum"])
    ax.scatter(
        loci.real.ravel(),
        loci.imag.ravel(),
        c=np.repeat(color, loci.shape[1]),
        cmap=COLORS,
        norm=norm,
        s=np.repeat(np.where(branch.points["admissible"], 5.0, 2.5), loci.shape[1]),
        linewidths=0,
        zorder=3.2,
        gid=f"{branch.name}-dots",
    )
    marked = {}
    for row, mark in zip(_ends(branch), (_START, _END), strict=True):
        if (branch.name, float(branch.points["s"][row])) in joints:
            continue
        marked[mark["label"]] = row
        ax.plot(loci[row].real, loci[row].imag, **{**mark, "gid": f"{branch.name}-{mark['label']}"})
    return marked


def _joined(a: complex, b: complex) -> np.ndarray:
    """The way between two neighbouring values; a real one that meets another does so on the axis."""
    way = [a, b]
    if (a.imag == 0.0) != (b.imag == 0.0):
        way.insert(1, complex(b.real if a.imag == 0.0 else a.real, 0.0))
    return np.array([[value.real, value.imag] for value in way])


def _ends(branch: Branch) -> tuple[int, int]:
    """Rows of the start and the end: a branch walked backward only has its start, s = 0, in the last row."""
    backward = branch.points["s"][-1] == 0.0 and len(branch) > 1
    return (-1, 0) if backward else (0, -1)


def _legend(
    ax: Axes, parameter: str, branches: Sequence[Branch], marked: Mapping[str, Sequence[float]]
) -> None:
    handles = []
    for mark in (_START, _END):
        if shown := set(marked.get(mark["label"], ())):
            at = f": {parameter} = {shown.pop():g}" if len(shown) == 1 else ""
            handles.append(Line2D([], [], **{**mark, "label": f"{mark['label']}{at}"}))
    if any(not admissible_segments(branch).all() for branch in branches):
        handles.append(Line2D([], [], color=INK, linewidth=THIN, label="thin: not admissible"))
    legend_above(ax, handles, handletextpad=0.3)


def with_margin(numbers: np.ndarray, include: Sequence[float], share: float = 0.07) -> tuple[float, float]:
    """Limits of an axis that shows all numbers, shape (k,), and these values, with air on both sides.

    `share` is the air's part of the whole range.
    """
    shown = np.concatenate([numbers, np.asarray(include, dtype=float)])
    low, high = float(shown.min()), float(shown.max())
    air = share * (high - low) or 1.0
    return low - air, high + air
