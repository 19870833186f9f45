"""An axis of the plane of eigenvalues: linear, or linear near zero and logarithmic beyond.

A stiff machine has eigenvalues of -1e6 beside those that decide on its stability. On a linear axis these
would all lie on one spot.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from contwalk.plotting.spectrum import with_margin

WIDE = 300.0  # ratio of the largest to the smallest eigenvalue from which on the axis is logarithmic
MOST_DECADES = 8
MOST_TICKS = 4  # on either side of zero
SHARE = 1.0  # of a decade, that the linear part is wide on either side
BEYOND = 1.6  # how far the axis goes beyond the largest value


def linear_until(parts: np.ndarray) -> float | None:
    """Where an axis of such values, shape (k, m) with a column for each eigenvalue, stops being linear.

    None of an axis that is linear throughout. The smallest eigenvalue that leaves zero has the linear part.
    """
    sizes = np.nanmax(np.where(np.isfinite(parts), np.abs(parts), 0.0), axis=0, initial=0.0)
    sizes = sizes[sizes > 0.0]
    if not len(sizes) or sizes.max() <= WIDE * sizes.min():
        return None
    return 10.0 ** np.floor(np.log10(max(sizes.min(), sizes.max() / 10.0**MOST_DECADES)))


def scale(ax: Axes, which: str, parts: np.ndarray) -> tuple[float, float]:
    """Scale the axis `x` or `y` for real or imaginary parts, of shape (k, m); its limits."""
    finite = parts[np.isfinite(parts)]
    until = linear_until(parts)
    axis: Any = ax.xaxis if which == "x" else ax.yaxis
    set_limits: Callable[..., Any] = ax.set_xlim if which == "x" else ax.set_ylim
    if until is None:
        limits = with_margin(finite, [0.0])
    else:
        low, high = min(float(finite.min()), 0.0), max(float(finite.max()), 0.0)
        limits = min(BEYOND * low, -until), max(BEYOND * high, until)
        set_scale: Callable[..., Any] = ax.set_xscale if which == "x" else ax.set_yscale
        set_scale("symlog", linthresh=until, linscale=SHARE)
        axis.set_major_locator(
            FixedLocator([*_ticks(until, -limits[0])[::-1] * -1.0, 0.0, *_ticks(until, limits[1])])
        )
        axis.set_major_formatter(FuncFormatter(lambda value, _: _power(value)))
        axis.set_minor_locator(NullLocator())
        axis.set_label_text(f"{axis.get_label_text()}, logarithmic beyond ±{until:g}")
    set_limits(*limits)
    return limits


def _ticks(until: float, largest: float) -> np.ndarray:
    """Powers of ten from the end of the linear part on, a few of them."""
    first, last = round(np.log10(until)), int(np.floor(np.log10(max(largest, until))))
    step = max(-(-(last - first) // MOST_TICKS), 1)
    return np.asarray(10.0 ** np.arange(first + step - 1, last + 1, step))


def _power(value: float) -> str:
    """A tick's label: a power of ten with its sign."""
    return f"${'-' if value < 0.0 else ''}10^{{{round(np.log10(abs(value)))}}}$" if value else "0"
