"""How a measured number is distributed over many trajectories."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from contwalk.errors import ContwalkError
from contwalk.plotting.style import INK, PALETTE, dress, new_axes

TAIL = 0.995  # the part of the samples that is shown one by one; the rest is one bar at the end
MOST_BINS = 80


def plot_histogram(
    samples: np.ndarray,
    ax: Axes | None = None,
    *,
    label: str = "",
    never_settled: int = 0,
    bins: int | None = None,
) -> Axes:
    """Draw the distribution of samples with their mean, its standard error, and how many never settled.

    Parameters
    ----------
    samples : array of shape (k,)
        All finite.
    ax : Axes, optional
        Where to draw; new axes by default.
    label : str
        What was measured, with its unit: below the axis.
    never_settled : int
        How many of the motions never settled; told above the histogram, also if zero.
    bins : int, optional
        Number of bars; by default twice the Rice rule 2 k^(1/3), 80 at most. A long tail, beyond the
        quantile 0.995, is one grey bar at the right end, so that it does not squeeze the rest.

    Raises
    ------
    ContwalkError
        If there is no sample, or one is not finite.
    """
    samples = np.asarray(samples, dtype=float).ravel()
    if not len(samples) or not np.isfinite(samples).all():
        what = "not finite" if len(samples) else "missing"
        raise ContwalkError(
            f"Samples for the histogram are {what}.",
            "Give at least one; leave out those that could not be measured.",
        )
    ax = ax or new_axes("histogram")
    dress(ax, label, "number of samples")
    bins = bins or min(MOST_BINS, max(5, 2 * math.ceil(2.0 * len(samples) ** (1.0 / 3.0))))
    _bars(ax, samples, bins)
    mean, error = float(samples.mean()), standard_error(samples)
    ax.axvline(mean, color=PALETTE[1], linewidth=1.4, zorder=3, gid="mean")
    if error > 0.0:
        ax.axvspan(
            mean - error, mean + error, color=PALETTE[1], alpha=0.3, linewidth=0, zorder=2.5, gid="error"
        )
    counts = [
        f"{len(samples)} samples",
        f"mean {_pair(mean, error)}",
        f"standard deviation {_deviation(samples):.4g}",
        f"never settled: {never_settled}",
    ]
    ax.set_title("   ".join(counts), loc="left", fontsize=9.0, color=INK, pad=8)
    ax.margins(x=0.02)
    ax.set_ylim(bottom=0.0)
    return ax


def standard_error(samples: np.ndarray) -> float:
    """Standard error of the mean of samples, shape (k,), in their unit; zero where one gives no estimate."""
    return _deviation(samples) / math.sqrt(len(samples))


def _deviation(samples: np.ndarray) -> float:
    return float(samples.std(ddof=1)) if len(samples) > 1 else 0.0


def _pair(mean: float, error: float) -> str:
    """`12.03 ± 0.06`: as many digits as the error lets stand."""
    if error <= 0.0:
        return f"{mean:.6g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{mean:.{digits}f} ± {error:.{digits}f}"


def _bars(ax: Axes, samples: np.ndarray, bins: int) -> None:
    low, high = float(samples.min()), float(samples.max())
    shown = float(np.quantile(samples, TAIL)) if len(samples) > 200 else high
    tailed = high - low > 1.3 * (shown - low)
    end = shown if tailed else high
    if end == low:
        low, end = low - 0.5, end + 0.5
    counts, edges = np.histogram(samples[samples <= end], bins=bins, range=(low, end))
    ax.stairs(counts, edges, fill=True, color=PALETTE[0], alpha=0.75, zorder=2, gid="bars")
    beyond = int((samples > end).sum())
    if beyond:
        width = edges[1] - edges[0]
        ax.bar(end + width, beyond, width=width, color="#BBBBBB", zorder=2, gid="tail")
        ax.annotate(
            f"{beyond} beyond,\nup to {samples.max():.4g}",
            (end + width, beyond),
            xytext=(0, 6),
            textcoords="offset points",
            ha="right",
            fontsize=8.0,
            color=INK,
        )
