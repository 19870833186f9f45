"""What is drawn on axes as plain elements: lines, filled outlines and texts with a look each.

A plugin's `draw` is written for matplotlib axes. A page that plays its machine needs no picture of each
instant but the elements it consists of, which keep their look while they move.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import Collection, PathCollection
from matplotlib.colors import to_hex, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

LINE, FILL, TEXT = "line", "fill", "text"
DASHES = {"-": "", "solid": "", "--": "6 3", "dashed": "6 3", ":": "1.5 2.5", "dotted": "1.5 2.5"}
DASHES |= {"-.": "6 2.5 1.5 2.5", "dashdot": "6 2.5 1.5 2.5"}
NOTHING = ("", "none", "None", " ", None)


@dataclass(frozen=True)
class Element:
    """One line, filled outline or text.

    Parameters
    ----------
    kind : str
        `line`, `fill` or `text`.
    points : ndarray, shape (k, 2)
        In data coordinates, or in parts of the axes where `fixed`; NaN breaks a line. Of a text its place.
    look : mapping
        Plain JSON values: `stroke`, `width`, `dash`, `fill`, `opacity`, `marker`, `size`, `edge`, `font`,
        `across`, `up`; only what there is.
    order : float
        Larger ones are in front.
    text : str
    offset : tuple of float
        Of a text from its place, points to the right and up.
    fixed : bool
        Whether it stands still on the axes.
    """

    kind: str
    points: np.ndarray
    look: Mapping[str, Any]
    order: float
    text: str = ""
    offset: tuple[float, float] = (0.0, 0.0)
    fixed: bool = field(default=False)


def color_of(value: Any, alpha: float | None = None) -> tuple[str, float]:
    """A colour as `#rrggbb` and its opacity; an empty text for none."""
    return _color(value, alpha) if isinstance(value, Hashable) else _color.__wrapped__(value, alpha)


@cache
def _color(value: Any, alpha: float | None) -> tuple[str, float]:
    if isinstance(value, str) and value.lower() == "none":
        return "", 0.0
    rgba = to_rgba(value, alpha)
    return ("", 0.0) if rgba[3] == 0.0 else (to_hex(rgba), round(rgba[3], 3))


def line_element(points: np.ndarray, given: Mapping[str, Any], order: float) -> Element:
    """A line through points (k, 2) with its markers; `given` are matplotlib's long names of properties."""
    style = matplotlib.rcParams
    color, opacity = color_of(given["color"], given.get("alpha"))
    look: dict[str, Any] = {}
    dash = given.get("linestyle", "-")
    if dash not in NOTHING:
        width = given.get("linewidth")
        width = float(style["lines.linewidth"] if width is None else width)
        look |= {"stroke": color, "width": round(width, 3)}
        look |= {"dash": DASHES[dash]} if DASHES.get(str(dash)) else {}
    marker = given.get("marker")
    if marker not in NOTHING:
        face, edge = given.get("markerfacecolor"), given.get("markeredgecolor")
        size, thick = given.get("markersize"), given.get("markeredgewidth")
        look |= {
            "marker": str(marker),
            "size": round(float(style["lines.markersize"] if size is None else size), 3),
            "fill": color if face in (None, "auto") else color_of(face)[0],
            "edge": color if edge in (None, "auto") else color_of(edge)[0],
            "thick": round(float(style["lines.markeredgewidth"] if thick is None else thick), 3),
        }
    look |= {"cap": "round"} if given.get("solid_capstyle") == "round" else {}
    look |= {"opacity": opacity} if opacity != 1.0 else {}
    return Element(LINE, points, look, order)


def fill_element(points: np.ndarray, given: Mapping[str, Any], order: float) -> Element:
    """A filled outline (k, 2); `given` has `facecolor`, `edgecolor`, `linewidth` and `alpha`."""
    alpha = given.get("alpha")
    fill, opacity = color_of(given["facecolor"], alpha)
    edge = given.get("edgecolor")
    stroke, of_stroke = color_of("none" if edge is None else edge, alpha)
    width = given.get("linewidth")
    width = float(matplotlib.rcParams["patch.linewidth"] if width is None else width)
    look: dict[str, Any] = {"fill": fill} if fill else {}
    look |= {"stroke": stroke, "width": round(width, 3)} if stroke and width else {}
    opacity = opacity if fill else of_stroke
    look |= {"opacity": opacity} if opacity != 1.0 else {}
    return Element(FILL, points, look, order)


def text_element(
    place: np.ndarray,
    text: str,
    given: Mapping[str, Any],
    order: float,
    offset: tuple[float, float] = (0.0, 0.0),
    fixed: bool = False,
) -> Element:
    """A text at a place, shape (2,); `given` has `color`, `fontsize`, `ha`, `va`, `rotation` and so on."""
    color, opacity = color_of(given.get("color") or "black", given.get("alpha"))
    size = given.get("fontsize")
    look: dict[str, Any] = {
        "fill": color,
        "font": float(size) if isinstance(size, int | float) else float(matplotlib.rcParams["font.size"]),
        "across": {"left": "start", "right": "end"}.get(str(given.get("ha", "left")), "middle"),
        "up": str(given.get("va", "baseline")),
    }
    look |= {"opacity": opacity} if opacity != 1.0 else {}
    look |= {"style": "italic"} if given.get("style") == "italic" else {}
    look |= {"weight": "bold"} if given.get("weight") in ("bold", "heavy") else {}
    rotation = given.get("rotation")
    if isinstance(rotation, int | float) and rotation:
        look["turn"] = round(float(rotation), 1)
    return Element(TEXT, np.reshape(place, (1, 2)), look, order, text, offset, fixed)


def elements_of(artists: Sequence[Artist]) -> list[Element]:
    """What matplotlib's own artists look like, those that are visible; images are left out."""
    found: list[Element] = []
    for artist in artists:
        if not artist.get_visible():
            continue
        if isinstance(artist, Line2D):
            found.append(_of_line(artist))
        elif isinstance(artist, Text):
            found += _of_text(artist)
        elif isinstance(artist, Patch):
            found += _of_patch(artist)
        elif isinstance(artist, Collection):
            found += _of_collection(artist)
    return found


def _of_line(line: Line2D) -> Element:
    names = "color linestyle linewidth marker markersize markerfacecolor markeredgecolor markeredgewidth"
    given = {name: getattr(line, f"get_{name}")() for name in (*names.split(), "alpha")}
    given["solid_capstyle"] = line.get_solid_capstyle()
    return line_element(np.asarray(line.get_xydata(), dtype=float), given, line.get_zorder())


def _of_text(text: Text) -> list[Element]:
    if not text.get_text():
        return []
    names = ("color", "fontsize", "ha", "va", "rotation", "style", "weight", "alpha")
    given = {name: getattr(text, f"get_{name}")() for name in names}
    axes = text.axes
    fixed = axes is not None and text.get_transform() == axes.transAxes
    place = np.array(text.get_position(), dtype=float)
    return [text_element(place, text.get_text(), given, text.get_zorder(), fixed=fixed)]


def _of_patch(patch: Patch) -> list[Element]:
    path = patch.get_path().transformed(patch.get_patch_transform())
    given = {name: getattr(patch, f"get_{name}")() for name in ("facecolor", "edgecolor", "linewidth")}
    polygons = path.to_polygons(closed_only=False)
    return [fill_element(np.asarray(each, dtype=float), given, patch.get_zorder()) for each in polygons]


def _of_collection(collection: Collection) -> list[Element]:
    faces, edges = _colors(collection.get_facecolor()), _colors(collection.get_edgecolor())
    order = collection.get_zorder()
    if isinstance(collection, PathCollection):  # markers of a scatter
        places = np.asarray(np.ma.filled(collection.get_offsets(), np.nan), dtype=float).reshape(-1, 2)
        given: dict[str, Any] = {"linestyle": "none", "marker": "o"}
        return [
            line_element(place[None], {"color": faces[number % len(faces)], **given}, order)
            for number, place in enumerate(places)
        ]
    widths = np.atleast_1d(collection.get_linewidth())
    found = []
    for number, path in enumerate(collection.get_paths()):
        outline = {
            "facecolor": faces[number % len(faces)],
            "edgecolor": edges[number % len(edges)],
            "linewidth": float(widths[number % len(widths)]),
        }
        polygons = path.to_polygons(closed_only=False)
        found += [fill_element(np.asarray(each, dtype=float), outline, order) for each in polygons]
    return found


def _colors(given: Any) -> list[Any]:
    """Colours of a collection's members in their order; of none at all `none`."""
    return [tuple(each) for each in np.asarray(given).tolist()] or ["none"]
