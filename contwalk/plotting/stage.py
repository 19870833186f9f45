"""Axes that note what is drawn on them and nothing more: hundreds of instants in the time of one picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from contwalk.plotting.drawn_elements import (
    Element,
    elements_of,
    fill_element,
    line_element,
    text_element,
)
from contwalk.plotting.playback import Playback
from contwalk.plotting.style import PALETTE

LONG_NAMES = {
    "c": "color",
    "lw": "linewidth",
    "ls": "linestyle",
    "ms": "markersize",
    "mec": "markeredgecolor",
    "mfc": "markerfacecolor",
    "mew": "markeredgewidth",
    "fc": "facecolor",
    "ec": "edgecolor",
    "horizontalalignment": "ha",
    "verticalalignment": "va",
    "size": "fontsize",
    "fontstyle": "style",
    "fontweight": "weight",
}
MARKERS, LINES = frozenset("o.,x+sdD^v<>*ph|_"), frozenset(("-", "--", ":", "-."))
# What matplotlib puts where nothing is said: patches below lines below texts.
LAYERS = {"fill": 1.0, "line": 2.0, "text": 3.0}
IN_AXES = object()  # stands for the transform `transAxes`


class BeyondStage(Exception):
    """A `draw` asks for something that only real axes have."""


class _Noted:
    """Something that has been drawn, whose properties may still be set."""

    def __init__(self, kind: str, points: np.ndarray, given: dict[str, Any], text: str = "") -> None:
        self.kind, self.points, self.text = kind, points, text
        self.given: dict[str, Any] = {}
        self.set(**given)

    def set(self, **given: Any) -> None:
        """As of any artist of matplotlib."""
        self.given |= {LONG_NAMES.get(name, name): value for name, value in given.items()}

    def __getattr__(self, name: str) -> Callable[..., None]:
        if not name.startswith("set_"):
            raise BeyondStage(name)
        return lambda value=None, **more: self.set(**{name.removeprefix("set_"): value})

    def element(self) -> Element | None:
        """As it is drawn in the end; None where it is not seen."""
        given = self.given
        if not given.get("visible", True):
            return None
        order = float(given.get("zorder", LAYERS[self.kind]))
        if self.kind == "line":
            return line_element(self.points, given, order)
        if self.kind == "fill":
            return fill_element(self.points, given, order)
        transform = given.get("transform")
        if transform not in (None, IN_AXES):
            raise BeyondStage("transform")
        offset = given.get("offset", (0.0, 0.0))
        return text_element(self.points, self.text, given, order, offset, transform is IN_AXES)


class Stage:
    """The part of matplotlib's axes that drawings of machines use; `BeyondStage` for everything else.

    Attributes
    ----------
    xlim, ylim : tuple of float, optional
        As the drawing has set them.
    """

    transAxes = IN_AXES

    def __init__(self) -> None:
        self.noted: list[_Noted | Element] = []
        self.xlim: tuple[float, float] | None = None
        self.ylim: tuple[float, float] | None = None
        self._cycle = 0

    def elements(self) -> list[Element]:
        """What has been drawn, those behind first."""
        found = [each if isinstance(each, Element) else each.element() for each in self.noted]
        return sorted((each for each in found if each is not None), key=lambda each: each.order)

    def plot(self, *places: Any, **given: Any) -> list[_Noted]:
        """A line, with a format of a marker or of dashes alone."""
        given = {LONG_NAMES.get(name, name): value for name, value in given.items()}
        form = places[2] if len(places) == 3 else ""
        if len(places) not in (2, 3) or not isinstance(form, str):
            raise BeyondStage("plot")
        if form in MARKERS and form:
            given = {"marker": form, "linestyle": "none", **given}
        elif form in LINES:
            given = {"linestyle": form, **given}
        elif form:
            raise BeyondStage(f"plot {form}")
        if given.get("color") is None:
            given["color"] = self._next_color()
        noted = _Noted("line", _points(*places[:2]), given)
        self.noted.append(noted)
        return [noted]

    def fill(self, *places: Any, **given: Any) -> list[_Noted]:
        """A filled outline."""
        if len(places) != 2:
            raise BeyondStage("fill")
        return [self._filled(_points(*places), given)]

    def fill_between(self, x: Any, y1: Any, y2: Any = 0.0, **given: Any) -> _Noted:
        """What lies between two lines."""
        x, y1, y2 = np.broadcast_arrays(*(np.asarray(each, dtype=float) for each in (x, y1, y2)))
        return self._filled(np.concatenate([_points(x, y1), _points(x, y2)[::-1]]), given)

    def _filled(self, points: np.ndarray, given: dict[str, Any]) -> _Noted:
        given = {LONG_NAMES.get(name, name): value for name, value in given.items()}
        color = given.pop("color", None)
        if color is not None:
            given |= {"facecolor": color, "edgecolor": color}
        if given.get("facecolor") is None:
            given["facecolor"] = self._next_color()
        noted = _Noted("fill", points, given)
        self.noted.append(noted)
        return noted

    def text(self, x: float, y: float, s: Any, **given: Any) -> _Noted:
        """A text at a place."""
        noted = _Noted("text", np.array([float(x), float(y)]), given, str(s))
        self.noted.append(noted)
        return noted

    def annotate(
        self,
        text: Any,
        xy: Any,
        xytext: Any = None,
        xycoords: Any = "data",
        textcoords: Any = None,
        arrowprops: Any = None,
        **given: Any,
    ) -> _Noted:
        """A text beside a place, or an arrow to it."""
        if xycoords != "data" or textcoords not in (None, "data", "offset points"):
            raise BeyondStage("annotate")
        place = xy if xytext is None or textcoords == "offset points" else xytext
        if arrowprops is not None:
            self._arrow(np.asarray(place, dtype=float), np.asarray(xy, dtype=float), arrowprops)
        if textcoords == "offset points" and xytext is not None:
            given["offset"] = tuple(float(each) for each in xytext)
        noted = _Noted("text", np.asarray(place, dtype=float), given, str(text))
        if str(text):
            self.noted.append(noted)
        return noted

    def _arrow(self, tail: np.ndarray, head: np.ndarray, given: dict[str, Any]) -> None:
        given = {LONG_NAMES.get(name, name): value for name, value in given.items()}
        look = {"color": given.get("color", "black"), "linewidth": given.get("linewidth", 1.0)}
        noted = line_element(np.array([tail, head]), look, LAYERS["text"])
        shape = str(given.get("arrowstyle", "->"))
        at = "both" if shape.startswith("<") and shape.endswith(">") else "end" if ">" in shape else ""
        self.noted.append(Element(noted.kind, noted.points, {**noted.look, "arrow": at}, noted.order))

    def add_patch(self, patch: Any) -> Any:
        """A patch of matplotlib; what is set of it later is not seen."""
        self.noted += elements_of([patch])
        return patch

    def set_xlim(self, left: Any = None, right: Any = None, **given: Any) -> None:
        """Limits across."""
        self.xlim = _limits(left, right, given)

    def set_ylim(self, bottom: Any = None, top: Any = None, **given: Any) -> None:
        """Limits upwards."""
        self.ylim = _limits(bottom, top, given)

    def set(self, **given: Any) -> None:
        """Several of them at once."""
        for name, value in given.items():
            getattr(self, f"set_{name}")(value)

    def _unseen(self, *_: Any, **__: Any) -> None:
        """What a page has no use for: the scale is equal, and there are no ticks."""

    set_aspect = set_axis_off = set_prop_cycle = set_title = set_xlabel = set_ylabel = _unseen
    set_xticks = set_yticks = axis = grid = legend = set_axis_on = margins = _unseen

    def _next_color(self) -> str:
        self._cycle += 1
        return PALETTE[(self._cycle - 1) % len(PALETTE)]

    def __getattr__(self, name: str) -> Any:
        raise BeyondStage(name)


def _points(x: Any, y: Any) -> np.ndarray:
    x, y = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
    if x.ndim != 1 or y.shape != x.shape:
        raise BeyondStage("columns of a matrix")
    return np.stack([x, y], axis=1)


def _limits(low: Any, high: Any, given: dict[str, Any]) -> tuple[float, float]:
    if high is None and low is not None and np.ndim(low) == 1:
        low, high = low
    if given or low is None or high is None:
        raise BeyondStage("one limit alone")
    return float(low), float(high)


class Performer:
    """Plays a machine instant by instant, on a stage where that will do, else on axes of matplotlib.

    Parameters
    ----------
    motion : Playback
    """

    def __init__(self, motion: Playback, on_axes: bool = False) -> None:
        self.motion, self.on_axes = motion, on_axes
        self._axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0)) if on_axes else None

    def at(self, time: float) -> tuple[list[Element], np.ndarray | None]:
        """Elements, those behind first, and limits (left, right, low, high), shape (4,), where it sets them.

        Raises
        ------
        PluginError
            If the plugin's `draw` raises.
        """
        if not self.on_axes:
            try:
                return self._on_stage(time)
            except BeyondStage:
                self.on_axes, self._axes = True, Figure().add_axes((0.0, 0.0, 1.0, 1.0))
        return self._on_axes(time)

    def _on_stage(self, time: float) -> tuple[list[Element], np.ndarray | None]:
        stage = Stage()
        try:
            self.motion.draw_on(stage, time)
        except Exception as error:
            if isinstance(error.__cause__, BeyondStage):
                raise error.__cause__ from error
            raise
        if stage.xlim is None or stage.ylim is None:
            return stage.elements(), None
        return stage.elements(), np.array([*stage.xlim, *stage.ylim])

    def _on_axes(self, time: float) -> tuple[list[Element], np.ndarray | None]:
        axes = self._axes
        assert axes is not None
        axes.clear()
        drawn: list[Artist] = self.motion.draw(axes, time)
        found = sorted(elements_of(drawn), key=lambda each: each.order)
        if axes.get_autoscale_on():
            return found, None
        return found, np.array([*axes.get_xlim(), *axes.get_ylim()])
