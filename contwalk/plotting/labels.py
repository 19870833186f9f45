"""Short texts next to points, without overlap.

Where each text goes is decided by `contwalk.plotting.placement`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import ConnectionPatch
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.transforms import Transform, offset_copy

from contwalk.plotting.placement import Ink, Placement
from contwalk.plotting.style import INK

FONT_SIZE = 8.0
LEADER_FROM_POINTS = 12.0  # a label farther than this from its point gets a line to it
SAME_PLACE_POINTS = 3.0  # labels of points nearer than this share one text: half a marker
MOST_SHARED = 4  # names in one text; of more, one less is written, and how many there are besides


@dataclass(frozen=True)
class Label:
    """A text at the point (x, y) in data coordinates.

    `owner` is the branch that the point belongs to: `b1/PD1`, unless the text is plain.
    """

    text: str
    x: float
    y: float
    color: str
    bold: bool = False
    owner: str = ""
    plain: bool = True

    @property
    def whole(self) -> str:
        """The text with its owner."""
        return f"{self.owner}/{self.text}" if self.owner else self.text


def place_labels(
    ax: Axes, labels: Sequence[Label], curves: Sequence[np.ndarray] = (), settled: bool = False
) -> list[str]:
    """Write the labels next to their points, with a thin leader line to those that had to move away.

    Labels whose markers lie on each other, as where a branch passes through its own mirror image, become one
    text; it has none of their colours where these are several.
    Where there is no room for all, the last ones are left out.

    Parameters
    ----------
    ax : Axes
        Complete but for the labels: its limits and its place on the figure are taken as they are.
    labels : sequence of Label
        Labels of points that are not finite are left out.
    curves : sequence of arrays of shape (k, 2)
        Curves in data coordinates that labels should keep off.
    settled : bool
        The figure's layout is final: it has been laid out since the last change but for labels.

    Returns
    -------
    list of str
        What is not written, with its owner.
    """
    labels = [label for label in labels if np.isfinite(label.x) and np.isfinite(label.y)]
    if not labels:
        return []
    # Freeze the limits (autoscaling is lazy), then let the layout settle.
    ax.set_xlim(ax.get_xlim())
    ax.set_ylim(ax.get_ylim())
    root = ax.figure.canvas.figure
    if not settled:
        root.draw_without_rendering()
    groups = _merged(ax, labels, SAME_PLACE_POINTS * root.dpi / 72.0)
    labels = [group[0] for group in groups]
    texts = [_text(ax, group) for group in groups]
    boxes = [text.get_window_extent() for text in texts]
    sizes = np.array([[box.width, box.height] for box in boxes])
    anchors = ax.transData.transform([[label.x, label.y] for label in labels])
    frame = np.array([[ax.bbox.x0, ax.bbox.y0], [ax.bbox.x1, ax.bbox.y1]])
    scale = root.dpi / 72.0
    ink = Ink(frame, [ax.transData.transform(curve) for curve in curves])
    centres = Placement(anchors, sizes, frame, ink, scale).solve()
    left_out = [each.whole for group in groups for each in group[_written(group) :]]
    for group, text, size, anchor, centre in zip(groups, texts, sizes, anchors, centres, strict=True):
        if not np.isfinite(centre).all():
            text.remove()
            left_out += [each.whole for each in group[: _written(group)]]
            continue
        offset = (centre - anchor) / scale
        moved = offset_copy(ax.transData, root, offset[0], offset[1], units="points")
        text.set_transform(moved)
        if _gap(centre - anchor, size) > LEADER_FROM_POINTS * scale:
            edge = (_edge(centre, size, anchor) - anchor) / scale
            _leader(ax, group[0], offset_copy(ax.transData, root, edge[0], edge[1], units="points"))
    return left_out


def _merged(ax: Axes, labels: Sequence[Label], near: float) -> list[list[Label]]:
    """The labels in groups: those of one weight whose points are no farther than `near` pixels apart."""
    places = ax.transData.transform([[label.x, label.y] for label in labels])
    groups: list[list[int]] = []
    for i, label in enumerate(labels):
        for group in groups:
            first = labels[group[0]]
            if first.bold == label.bold and np.hypot(*(places[i] - places[group[0]])) <= near:
                group.append(i)
                break
        else:
            groups.append([i])
    return [list({labels[i].whole: labels[i] for i in group}.values()) for group in groups]


def _written(group: Sequence[Label]) -> int:
    """How many names of a group are written."""
    return len(group) if len(group) <= MOST_SHARED else MOST_SHARED - 1


def _shared(group: Sequence[Label]) -> str:
    """The text of a group: `b1/LP1, PD1; b2/LP1 + 3`."""
    written = group[: _written(group)]
    names: dict[str, list[str]] = {}
    for label in written:
        names.setdefault(label.owner, []).append(label.text)
    plain = len(names) == 1 and all(label.plain for label in written)
    parts = [("" if plain or not owner else f"{owner}/") + ", ".join(own) for owner, own in names.items()]
    return "; ".join(parts) + (f" + {len(group) - len(written)}" if len(group) > len(written) else "")


def _text(ax: Axes, group: Sequence[Label]) -> Text:
    label, words = group[0], _shared(group)
    color = label.color if len({each.color for each in group}) == 1 else INK
    text = ax.text(
        label.x,
        label.y,
        words,
        fontsize=FONT_SIZE,
        color=color,
        ha="center",
        va="center",
        fontweight="bold" if label.bold else "normal",
        zorder=6,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
    )
    text.set_in_layout(False)
    return text


def _leader(ax: Axes, label: Label, edge: Transform) -> None:
    """A line from the edge of a text to its point."""
    point = (label.x, label.y)
    leader = ConnectionPatch(
        point, point, coordsA=edge, coordsB=ax.transData, arrowstyle="-", shrinkA=0, shrinkB=3
    )
    leader.set(linewidth=0.5, color=label.color, alpha=0.7, zorder=2.5)
    leader.set_in_layout(False)
    ax.add_artist(leader)


def _edge(centre: np.ndarray, size: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    """Where the line from the centre of a box to a point outside leaves it."""
    way = np.asarray(anchor - centre, dtype=float)
    with np.errstate(divide="ignore"):
        shares = size / 2 / np.abs(way)
    return centre + min(float(shares.min()), 1.0) * way


def _gap(offset: np.ndarray, size: np.ndarray) -> float:
    """Distance from a point to the edge of a box of this size at this offset."""
    return float(np.hypot(*np.maximum(np.abs(offset) - size / 2, 0.0)))
