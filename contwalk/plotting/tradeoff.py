"""What accuracy costs: time against true error, in double logarithmic axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from contwalk.errors import ContwalkError
from contwalk.plotting.style import GREY, INK, PALETTE, dress, new_axes

EXACT = 2.0**-53  # where an error of zero is drawn: half an ulp is what it may be
MARKERS = ("o", "s", "^", "D", "v", "P", "X")


def plot_tradeoff(
    series: Mapping[str, Sequence[tuple[float, float]]],
    ax: Axes | None = None,
    *,
    notes: Mapping[str, Sequence[str]] | None = None,
    xlabel: str = "time (s)",
    ylabel: str = "relative error",
) -> Axes:
    """Draw the cost of accuracy, a line for each method.

    Parameters
    ----------
    series : mapping
        Name of a method to pairs (time, true error), one for each accuracy that was asked for. An error
        of zero is drawn hollow at 2**-53; a pair that is not finite is left out.
    ax : Axes, optional
        Where to draw; new axes by default.
    notes : mapping, optional
        Name of a method to a short text for each of its pairs, such as the accuracy asked for.
    xlabel, ylabel : str

    Raises
    ------
    ContwalkError
        If there is nothing finite to draw, a time is not positive, or an error is negative.
    """
    points = {name: np.asarray(pairs, dtype=float).reshape(-1, 2) for name, pairs in series.items()}
    _check(points)
    ax = ax or new_axes("tradeoff")
    dress(ax, xlabel, ylabel)
    ax.set_xscale("log")
    ax.set_yscale("log")
    for number, (name, pairs) in enumerate(points.items()):
        color, marker = PALETTE[number % len(PALETTE)], MARKERS[number % len(MARKERS)]
        drawn = np.stack([pairs[:, 0], np.maximum(pairs[:, 1], EXACT)], axis=1)
        ax.plot(
            *drawn.T,
            color=color,
            marker=marker,
            markersize=5.5,
            linewidth=1.2,
            label=name,
            gid=f"method-{name}",
        )
        exact = drawn[pairs[:, 1] == 0.0]
        ax.plot(
            *exact.T,
            linestyle="none",
            marker=marker,
            markersize=5.5,
            markerfacecolor="white",
            markeredgecolor=color,
            gid=f"exact-{name}",
            zorder=3,
        )
        for place, text in zip(drawn, (notes or {}).get(name, ()), strict=False):
            if np.isfinite(place).all():
                ax.annotate(
                    text, tuple(place), xytext=(5, 4), textcoords="offset points", fontsize=7.5, color=color
                )
    if any((pairs[:, 1] <= EXACT).any() for pairs in points.values()):
        ax.axhline(EXACT, color=GREY, linewidth=0.7, linestyle=(0, (4.0, 3.0)), zorder=1, gid="rounding")
    ax.grid(True, which="major", color="#E4E4E4", linewidth=0.6, zorder=0)
    ax.margins(0.1)
    _legend(ax)
    return ax


def _check(points: Mapping[str, np.ndarray]) -> None:
    everything = np.concatenate([np.empty((0, 2)), *points.values()])
    finite = everything[np.isfinite(everything).all(axis=1)]
    if not len(finite):
        raise ContwalkError("There is nothing to draw.", "Give at least one pair (time, error).")
    if (finite[:, 0] <= 0.0).any() or (finite[:, 1] < 0.0).any():
        raise ContwalkError(
            "A time is not positive or an error is negative.", "Give times above 0 and magnitudes of errors."
        )


def _legend(ax: Axes) -> None:
    ax.legend(
        loc="upper left",
        bbox_to_anchor=(1.01, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize=8.5,
        labelcolor=INK,
    )
