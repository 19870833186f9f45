"""Moduli of multipliers over the free parameter: where, and how, an orbit loses its stability."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

from contwalk.branch import ORBITS, Branch
from contwalk.plotting.labels import Label, place_labels
from contwalk.plotting.quantities import axis_label, called, default_x, values, with_names
from contwalk.plotting.segments import position, runs
from contwalk.plotting.smooth_spectra import Loci
from contwalk.plotting.special_points import marker
from contwalk.plotting.spectrum import SHADE, choose, loci_of
from contwalk.plotting.style import INK, PALETTE, dark, dress, legend_above, light, new_axes

OTHER = "for equilibria use the figure `eigenvalues`"
# What a multiplier can be, in the order of the palette.
KINDS = ("positive", "negative", "complex pair")
# Points at which a multiplier is on the unit circle.
CROSSING = ("LP", "BP", "PD", "NS")
LEAST = 1e-4  # modulus below which it does not matter how small
MARGIN = 0.5  # modulus down to which the axis goes at least, in parts of the largest
BAND = 0.1  # of the axis at its lower end, for what is told of multipliers that are not shown
PLAIN = 100.0  # ratio of the largest to the least up to which numbers are written out
PAPER: dict[str, Any] = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0}
WHITE = 0.55  # share of white in the colour of what is not admissible


def plot_multiplier_moduli(
    branches: Sequence[Branch],
    x: str | None = None,
    ax: Axes | None = None,
    *,
    units: Mapping[str, str] | None = None,
    report: Callable[[str], None] = lambda text: None,
) -> Axes:
    """Draw the moduli of multipliers over a parameter, on a logarithmic axis.

    The colour tells positive and negative real multipliers and complex pairs apart, so that it tells a fold
    or a branch point from a period doubling and a Neimark-Sacker point. The unstable side is shaded.

    Parameters
    ----------
    branches : sequence of Branch
        Branches of equilibria are left out: they have eigenvalues.
    x : str, optional
        What stands on the horizontal axis; the first free parameter by default.
    ax : Axes, optional
        Where to draw; new axes by default.
    units : mapping, optional
        Units by name, as from `units_of(system)`.
    report : callable
        Given a sentence that lists the special points for whose names there is no room.

    Raises
    ------
    ContwalkError
        If no branch is one of orbits with a spectrum, or none has `x`.
    """
    figure = draw_moduli(branches, ax, x, units)
    name_points(figure, report)
    return figure.ax


@dataclass(frozen=True, eq=False)
class Unnamed:
    """Axes that are complete but for the names of the points on them."""

    ax: Axes
    labels: list[Label]
    curves: list[np.ndarray]
    drawn: set[tuple[int, bool]]


def draw_moduli(
    branches: Sequence[Branch],
    ax: Axes | None = None,
    x: str | None = None,
    units: Mapping[str, str] | None = None,
) -> Unnamed:
    """Draw what `plot_multiplier_moduli` does, without the names of the special points."""
    chosen = choose(branches, ORBITS, "multipliers", OTHER)
    x = x or default_x(chosen)
    chosen = with_names(chosen, [x])
    ax = ax or new_axes("multipliers")
    dress(ax, axis_label(x, units), "modulus of multipliers")
    ax.set_yscale("log")
    ax.set_autoscaley_on(False)  # see `_scale`
    drawn: set[tuple[int, bool]] = set()
    curves, labels, largest, least = [], [], 1.0, 1.0
    below, endless = [], False
    for branch, name in zip(chosen, called(chosen), strict=True):
        across = np.asarray(values(branch, x))
        fine = loci_of(branch, x)
        loci = fine.values
        moduli = np.maximum(np.abs(loci), LEAST / 10.0)  # zero has no place on the axis
        drawn |= _draw(ax, branch, name, fine, moduli)
        finite = moduli[np.isfinite(moduli)]
        on_axis = finite[finite >= LEAST]
        largest, least = max(largest, finite.max(initial=0.0)), min(least, on_axis.min(initial=1.0))
        below.append(int(np.sum(np.isfinite(moduli) & (moduli < LEAST), axis=1).max(initial=0)))
        endless |= bool(np.isinf(loci).any())
        curves += [np.stack([fine.across, column], axis=1) for column in moduli.T]
        for point in branch.special_points:
            if point.label in CROSSING:
                at = position(branch, across, point.index, point.s)
                look = marker(point.label, PALETTE[-1], located=point.status == "located")
                ax.plot([at], [1.0], gid=f"{name}-{point.name}", **look)
                plain, color = len(chosen) == 1, dark(PALETTE[-1])
                labels.append(Label(point.name, at, 1.0, color, owner=name, plain=plain))
    ax.margins(x=0.04)
    ax.autoscale_view(scaley=False)
    _scale(ax, least, largest)
    _left_out(ax, max(below), endless)
    ax.axhspan(1.0, 1e300, color=SHADE, linewidth=0, zorder=0)
    ax.axhline(1.0, color=INK, linewidth=1.2, zorder=1, gid="unit-modulus")
    _legend(ax, drawn)
    return Unnamed(ax, labels, [*curves, np.array([[at, 1.0] for at in ax.get_xlim()])], drawn)


def name_points(figure: Unnamed, report: Callable[[str], None], settled: bool = False) -> None:
    """Write the names of the special points; `settled` as for `place_labels`."""
    without = place_labels(figure.ax, figure.labels, figure.curves, settled)
    if without:
        _legend(figure.ax, figure.drawn, f"names left out: {len(without)}")
        report(
            f"There is no room for the names of {len(without)} points in the figure of multipliers: "
            f"{', '.join(without)}. Draw fewer branches, or look them up with `contwalk show`."
        )


def _left_out(ax: Axes, below: int, endless: bool) -> None:
    """Tell of multipliers that have no place on the axis."""
    omitted = f"{below} of modulus below {LEAST:g}" if below else ""
    omitted = ", ".join(filter(None, [omitted, "some infinite" if endless else ""]))
    if omitted:
        low, high = ax.get_ylim()
        ax.set_ylim(low / (high / low) ** BAND, high)
        look: dict[str, Any] = {
            "ha": "right",
            "va": "bottom",
            "fontsize": 8.5,
            "color": INK,
            "zorder": 5,
            "bbox": PAPER,
        }
        ax.text(0.98, 0.02, f"not shown: {omitted}", transform=ax.transAxes, gid="left-out", **look)


def _scale(ax: Axes, least: float, largest: float) -> None:
    """Limits with air in proportion, and plain numbers where they span little."""
    least = min(least, MARGIN * largest)  # not the circle alone
    air = max((largest / least) ** 0.06, 1.05)
    ax.set_ylim(least / air, largest * air)
    if largest < PLAIN * least:
        round_steps = MaxNLocator(6, steps=[1, 2, 5, 10])
        ax.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)) if largest > 5.0 * least else round_steps)
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.yaxis.set_minor_locator(NullLocator())


def _draw(ax: Axes, branch: Branch, name: str, fine: Loci, moduli: np.ndarray) -> set[tuple[int, bool]]:
    """Draw the multipliers of one branch; which kinds there are, and whether admissible."""
    kinds = np.where(fine.values.imag != 0.0, 2, np.where(fine.values.real < 0.0, 1, 0)).T
    places = np.stack(np.broadcast_arrays(fine.across, moduli.T), axis=2)
    found = set()
    for run in runs(branch):
        first, last = np.searchsorted(fine.rows, [run.first, run.last])
        # One multiplier after the other: (multipliers, segments, both ends, place)
        ends = np.stack([places[:, first:last], places[:, first + 1 : last + 1]], axis=2)
        own = np.stack([kinds[:, first:last], kinds[:, first + 1 : last + 1]])
        kind_of = own.max(axis=0)
        # A real multiplier that changes its sign passes zero, which no line can show.
        shown = np.isfinite(ends).all(axis=(2, 3)) & ~((own.min(axis=0) == 0) & (kind_of == 1))
        for kind in dict.fromkeys(kind_of[shown].tolist()):
            color = PALETTE[kind] if run.admissible else light(PALETTE[kind], WHITE)
            own_lines = _connected(places[:, first : last + 1], shown & (kind_of == kind))
            look: dict[str, Any] = {"capstyle": "round", "joinstyle": "round"}
            lines = LineCollection(own_lines, colors=color, linewidths=1.6, zorder=3, **look)
            lines.set_gid(f"{name}-{KINDS[kind]}")
            ax.add_collection(lines)
            found.add((kind, run.admissible))
    return found


def _connected(places: np.ndarray, drawn: np.ndarray) -> list[np.ndarray]:
    """Lines through places, shape (m, k + 1, 2), as long as the segments between them, (m, k), are drawn.

    One line costs little more than one of its segments.
    """
    found = []
    for line, own in zip(places, drawn, strict=True):
        turns = np.flatnonzero(np.diff(np.concatenate([[False], own, [False]]).astype(int)))
        found += [line[begin : end + 1] for begin, end in turns.reshape(-1, 2)]
    return found


def _legend(ax: Axes, drawn: set[tuple[int, bool]], besides: str = "") -> None:
    handles = [
        Line2D([], [], color=PALETTE[kind], linewidth=1.6, label=name)
        for kind, name in enumerate(KINDS)
        if any(each == kind for each, _ in drawn)
    ]
    if any(not admissible for _, admissible in drawn):
        handles.append(Line2D([], [], color=light(INK, WHITE), linewidth=1.6, label="light: not admissible"))
    if besides:
        handles.append(Line2D([], [], linestyle="none", label=besides))
    legend_above(ax, handles, handlelength=1.6)
