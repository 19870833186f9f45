"""A small diagram as SVG for notebooks: lines by how stable they are, special points by their names.

It is a picture without scripts, since a notebook that is not trusted runs none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

# Width and height of the picture, what is beside the axes, and the size of letters, in pixels.
LAYOUT = {"width": 520, "height": 250, "left": 64, "right": 14, "top": 24, "bottom": 34, "letters": 11}
COLORS = ("#0067a0", "#b94f00", "#00795a", "#a34f82", "#2b7fb0", "#976600")


@dataclass(frozen=True, eq=False)
class Line:
    """A branch as it is drawn.

    Parameters
    ----------
    name : str
    x, y : ndarray, shape (k,)
    stable : ndarray of int, shape (k - 1,)
        Of each segment: 1, 0, or -1 where it is not known.
    points : sequence of (str, str, float, float)
        Name, what it is, and the place of each special point.
    """

    name: str
    x: np.ndarray
    y: np.ndarray
    stable: np.ndarray
    points: Sequence[tuple[str, str, float, float]] = field(default_factory=list)


def svg(lines: Sequence[Line], across: str, upwards: str) -> str:
    """The picture; empty where there is nothing that has a place."""
    xs = np.concatenate([line.x for line in lines] or [np.zeros(0)])
    ys = np.concatenate([line.y for line in lines] or [np.zeros(0)])
    known = np.isfinite(xs) & np.isfinite(ys)
    if not known.any():
        return ""
    (left, right), (low, high) = _span(xs[known]), _span(ys[known])
    at = LAYOUT
    wide = (at["width"] - at["left"] - at["right"]) / (right - left)
    tall = (at["height"] - at["top"] - at["bottom"]) / (high - low)

    def place(x: float, y: float) -> tuple[float, float]:
        return round(at["left"] + wide * (x - left), 1), round(at["top"] + tall * (high - y), 1)

    base, end = at["height"] - at["bottom"], at["width"] - at["right"]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{at["width"]}" height="{at["height"]}" '
        f'viewBox="0 0 {at["width"]} {at["height"]}" font-size="{at["letters"]}" font-family="sans-serif" '
        f'role="img" aria-label="{escape(upwards)} over {escape(across)}">',
        f'<path d="M{at["left"]} {at["top"]}V{base}H{end}" fill="none" stroke="#777"/>',
        _text(end, base + 28, across, "end"),
        _text(4, at["top"] - 10, upwards),
        _text(at["left"], base + 14, f"{left:.4g}"),
        _text(end, base + 14, f"{right:.4g}", "end"),
        _text(at["left"] - 6, base, f"{low:.4g}", "end"),
        _text(at["left"] - 6, at["top"] + 8, f"{high:.4g}", "end"),
    ]
    for number, line in enumerate(lines):
        color = COLORS[number % len(COLORS)]
        for stable, dash in ((1, ""), (0, ' stroke-dasharray="5 3"'), (-1, ' stroke-dasharray="1 3"')):
            path = _path(line, stable, place)
            look = f'fill="none" stroke="{color}" stroke-width="{1.8 if stable == 1 else 1.2}"{dash}'
            parts += [f'<path d="{path}" {look} data-branch="{escape(line.name)}"/>'] if path else []
    taken: list[tuple[float, float]] = []
    for number, line in enumerate(lines):
        color = COLORS[number % len(COLORS)]
        for name, what, x, y in line.points:
            if np.isfinite(x) and np.isfinite(y):
                cx, cy = place(x, y)
                whole = escape(f"{line.name}/{name}")
                parts.append(
                    f'<circle cx="{cx}" cy="{cy}" r="4" fill="{color}" data-point="{whole}">'
                    f"<title>{whole}: {escape(what)}</title></circle>"
                )
                # A name that has no room is the title that a pointer shows.
                room = at["letters"] * len(name) + at["letters"]
                if not name.startswith("EP") and not any(
                    abs(cx - x) < room and abs(cy - y) < at["letters"] for x, y in taken
                ):
                    taken.append((cx, cy))
                    parts.append(_text(cx + 6, cy - 6, name))
    return "".join([*parts, "</svg>"])


def _span(values: np.ndarray) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    size = max(abs(low), abs(high)) or 1.0
    if high - low < np.sqrt(np.finfo(float).eps) * size:  # it stands still but for rounding
        return low - size, high + size
    return low, high


def _path(line: Line, stable: int, place: Callable[[float, float], tuple[float, float]]) -> str:
    """The segments of a line that are as stable, as a path."""
    found, pen = [], False
    for k, own in enumerate(line.stable):
        ends = [line.x[k], line.y[k], line.x[k + 1], line.y[k + 1]]
        if own != stable or not np.isfinite(ends).all():
            pen = False
            continue
        if not pen:
            found.append("M{} {}".format(*place(line.x[k], line.y[k])))
        found.append("L{} {}".format(*place(line.x[k + 1], line.y[k + 1])))
        pen = True
    return "".join(found)


def _text(x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="currentColor">{escape(text)}</text>'
