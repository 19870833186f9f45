"""Texts above points that stand side by side: slanted, so that many find room, and never over one another."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import ConnectionPatch
from matplotlib.patheffects import withStroke
from matplotlib.transforms import offset_copy

from contwalk.plotting.style import INK

SLANT = 40.0  # degrees
FONT_SIZE = 8.0
# Points: from a point up to its text, and between the beginnings of two texts.
ABOVE, APART = 9.0, 1.5 * FONT_SIZE / math.sin(math.radians(SLANT))


def tell(ax: Axes, labels: Sequence[tuple[np.ndarray, str]]) -> float:
    """Write texts above points, from left to right, each with a thin line from its point.

    Parameters
    ----------
    ax : Axes
        Complete but for its title: its limits and its place on the figure are taken as they are.
    labels : sequence of (array of shape (2,), str)
        Points in data coordinates and texts.

    Returns
    -------
    float
        How far the texts reach above the axes, in points.
    """
    if not labels:
        return 0.0
    root = ax.figure.canvas.figure
    root.draw_without_rendering()
    scale = root.dpi / 72.0
    points = np.array([point for point, _ in labels])
    pixels = ax.transData.transform(points) / scale
    order = sorted(range(len(labels)), key=lambda i: (pixels[i, 0], i))
    starts = spread(pixels[order, 0])
    reach = 0.0
    for i, start in zip(order, starts, strict=True):
        shift = start - pixels[i, 0]
        moved = offset_copy(ax.transData, root, shift, ABOVE, units="points")
        x, y = points[i].tolist()
        text = ax.text(x, y, labels[i][1], transform=moved, fontsize=FONT_SIZE, color=INK, zorder=30)
        text.set(gid="event", ha="left", va="bottom", rotation=SLANT, rotation_mode="anchor")
        text.set_path_effects([withStroke(linewidth=2.0, foreground="white")])
        line = ConnectionPatch((x, y), (x, y), coordsA=moved, coordsB=ax.transData, arrowstyle="-")
        line.set(linewidth=0.6, color=INK, alpha=0.7, zorder=9)
        line.set_in_layout(False)
        ax.add_artist(line)
        reach = max(reach, (text.get_window_extent().y1 - ax.get_window_extent().y1) / scale)
    return reach


def spread(wanted: np.ndarray) -> np.ndarray:
    """Places in growing order that are `APART` or more from one another, near those that are wanted.

    Both of shape (k,), k at least 1, in the same unit as `APART`; `wanted` grows.
    """
    gaps = APART * np.arange(len(wanted))
    # Blocks of neighbours that push one another stand where they do so least: the mean of what they want.
    blocks: list[list[float]] = []
    for place in wanted - gaps:
        blocks.append([float(place)])
        while len(blocks) > 1 and np.mean(blocks[-2]) > np.mean(blocks[-1]):
            last = blocks.pop()
            blocks[-1] += last
    return np.concatenate([np.full(len(block), np.mean(block)) for block in blocks]) + gaps
