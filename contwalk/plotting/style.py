"""How figures look, and how they become files: colours, proportions, formats."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from os import PathLike
from pathlib import Path
from shutil import which
from typing import Any
from weakref import WeakKeyDictionary
from zlib import Z_RLE

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from contwalk.errors import ContwalkError
from contwalk.figure_formats import allowed_formats, unknown_format
from contwalk.files.drafts import written
from contwalk.plotting.manuals import in_space
from contwalk.system.declarations import nearest

# Okabe and Ito's colour-blind-safe palette, without its yellow, which is too faint for a line on white.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
INK = "#222222"
GREY = "#8C8C8C"
DPI = 150

# Width and height in inches. A journal's double column is 7.2 inches wide.
PROPORTIONS = {
    "bifurcation_diagram": (7.2, 4.0),
    "crowded_diagram": (9.0, 5.4),
    "eigenvalues": (6.4, 4.2),
    "multipliers": (5.8, 4.9),
    "multiplier_panels": (5.2, 4.1),
    "stability_map": (6.4, 4.2),
    "locus": (6.4, 4.4),
    "chart": (6.4, 4.6),
    "machine": (4.2, 4.2),
    "stick_figure": (7.2, 3.9),
    "stick_panels": (2.4, 2.5),
    "phase_portrait": (6.4, 4.6),
    "phase_panels": (4.6, 4.6),
    "time_series": (7.2, 3.0),
    "histogram": (6.4, 4.0),
    "basin": (5.4, 4.8),
    "margins": (3.1, 4.6),
    "tradeoff": (6.4, 4.2),
}

# What a journal gives to a figure, inches.
WIDTHS = {"column": 3.4, "page": 7.2}
# Legends below figures: the entries of each of their axes.
_BELOW: WeakKeyDictionary[Figure, dict[Axes, dict[str, Any]]] = WeakKeyDictionary()
_ASKED: ContextVar[float | None] = ContextVar("asked", default=None)

# Type 42 keeps text in a PDF as text (journals demand it); a fixed salt makes equal figures equal files.
_WRITING: dict[Any, Any] = {"pdf.fonttype": 42, "svg.hashsalt": "contwalk"}
_UNDATED: dict[str, dict[str, Any]] = {
    ".png": {"metadata": {}},
    ".svg": {"metadata": {"Date": None}},
    ".pdf": {"metadata": {"CreationDate": None}},
    ".pgf": {},
}
# What measures texts for PGF, the first that is there: those of Unicode before the one that is not.
_TEX = ("lualatex", "xelatex", "pdflatex")


@contextmanager
def of_width(name: str | None) -> Iterator[None]:
    """Within it new figures have a width of `WIDTHS`, and what text needs to stay as large as it is.

    Narrower ones are less flat: their heights shrink with the root of their widths.
    """
    token = _ASKED.set(WIDTHS[name] if name else None)
    try:
        yield
    finally:
        _ASKED.reset(token)


def asked_width() -> float | None:
    """What `of_width` asks for, inches."""
    return _ASKED.get()


def size_of(kind: str, columns: int = 1) -> tuple[float, float]:
    """Width and height of a panel of so many beside each other, inches."""
    width, height = PROPORTIONS[kind]
    asked = asked_width()
    return (width, height) if asked is None else (asked / columns, height * (asked / columns / width) ** 0.5)


def is_narrow(figure: Figure) -> bool:
    """Whether a figure is of a column's width: nothing has room beside its axes."""
    return bool(figure.get_size_inches()[0] <= WIDTHS["column"])


def new_axes(kind: str, projection: str | None = None) -> Axes:
    """Axes on a new figure of good proportions for a figure of this kind.

    Parameters
    ----------
    kind : str
        A key of `PROPORTIONS`: `bifurcation_diagram`, `eigenvalues`, `time_series` and so on.
    projection : str, optional
        `3d` for axes in space.

    Returns
    -------
    Axes
        Its figure is `ax.figure`, with constrained layout and an Agg canvas.

    Raises
    ------
    ContwalkError
        For any other kind.
    """
    return _new_figure(kind, 1, projection).add_subplot(projection=projection)


def new_panels(kind: str, number: int) -> list[Axes]:
    """As `new_axes`, with panels one below the other; each but the first adds two thirds to the height."""
    return list(_new_figure(kind, number).subplots(number, squeeze=False)[:, 0])


def new_grid(
    kind: str,
    number: int,
    columns: int,
    projection: str | None = None,
    heights: Sequence[float] | None = None,
) -> list[Axes]:
    """As `new_axes`, with panels in so many columns, row by row; all of the size of one figure.

    `heights` are those of the rows, in parts of each other; all are the same by default.
    """
    asked = asked_width()
    if asked is not None:  # as many as have room
        columns = min(columns, max(1, int(asked // PROPORTIONS[kind][0])))
    rows = -(-number // columns)
    figure = _new_figure(kind, 1, projection)
    width, height = size_of(kind, columns)
    figure.set_size_inches(width * columns, height * rows)
    grid = figure.subplots(
        rows, columns, squeeze=False, subplot_kw={"projection": projection}, height_ratios=heights
    )
    axes = list(grid.ravel())
    for ax in axes[number:]:
        ax.remove()
    return axes[:number]


def _new_figure(kind: str, panels: int, projection: str | None = None) -> Figure:
    if projection == "3d":
        in_space()
    if kind not in PROPORTIONS:
        raise ContwalkError(
            f"There is no figure named '{kind}'.",
            f"{nearest(kind, list(PROPORTIONS))} Known: {', '.join(PROPORTIONS)}.".strip(),
        )
    width, height = size_of(kind)
    figure = Figure(figsize=(width, height * (1 + (panels - 1) * 2 / 3)), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    # Vertical padding in inches; matplotlib's own lets a legend touch the edge.
    figure.get_layout_engine().set(w_pad=0.06, h_pad=0.06)  # type: ignore[union-attr, call-arg]
    return figure


def light(color: str, white: float = 0.6) -> str:
    """The colour mixed with a share of white."""
    red, green, blue = (part * (1.0 - white) + white for part in to_rgb(color))
    return to_hex((red, green, blue))


def dark(color: str) -> str:
    """The colour darkened by a third: text needs more contrast than a line."""
    red, green, blue = to_rgb(color)
    return to_hex((red * 2 / 3, green * 2 / 3, blue * 2 / 3))


def dress(ax: Axes, xlabel: str, ylabel: str) -> None:
    """Axis labels, ticks and spines in the one style of all figures."""
    ax.set_xlabel(xlabel, fontsize=10, color=INK)
    ax.set_ylabel(ylabel, fontsize=10, color=INK)
    ax.tick_params(labelsize=8.5, color=INK, labelcolor=INK, width=0.7, length=3)
    ax.xaxis.get_offset_text().set_fontsize(8.5)
    # Left of the axes, above the numbers it belongs to: a title or a legend may stand above the axes.
    ax.yaxis.get_offset_text().set(fontsize=8.5, ha="right", x=-0.01)
    ax.spines[["top", "right"]].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set(linewidth=0.7, color=INK)


def legend_beside(ax: Axes, handles: Sequence[Any], **options: Any) -> None:
    """A legend right of the axes, at their top, in place of one that is there; below them, in two columns,
    where the figure is narrow. `options` are those of `Axes.legend`.
    """
    figure = ax.figure.canvas.figure
    common = {"frameon": False, "fontsize": 8.5, "labelcolor": INK, **options}
    if is_narrow(figure):
        _legend_below(figure, ax, handles, {"ncols": 2, **common, "fontsize": 7.5})
    else:
        ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, **common)


def _legend_below(figure: Figure, ax: Axes, handles: Sequence[Any], look: dict[str, Any]) -> None:
    """One legend below all axes, with the entries of each, for which the figure becomes higher."""
    entries = _BELOW.setdefault(figure, {})
    labels = look.pop("labels", None) or [str(handle.get_label()) for handle in handles]
    entries[ax] = dict(zip(labels, handles, strict=True))
    for old in list(figure.legends):
        figure.set_figheight(figure.get_figheight() - _height(old))
        old.remove()
    every = {label: handle for each in entries.values() for label, handle in each.items()}
    legend = figure.legend([*every.values()], [*every], loc="outside lower left", **look)
    figure.set_figheight(figure.get_figheight() + _height(legend))


def _height(legend: Any) -> float:
    """Inches that a legend takes, one line of text being its size and a quarter."""
    lines = sum(str(text.get_text()).count("\n") + 1 for text in legend.get_texts())
    return float(-(-lines // legend._ncols) * legend._fontsize * 1.25 / 72.0)


def legend_above(ax: Axes, handles: list[Any], **options: Any) -> None:
    """A legend in two columns above the axes, on the left; `options` are those of `Axes.legend`."""
    ax.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.01),
        borderaxespad=0.0,
        ncols=1 if is_narrow(ax.figure.canvas.figure) else 2,
        frameon=False,
        fontsize=8.5,
        labelcolor=INK,
        **options,
    )


def title(ax: Axes, text: str, above: float = 0.0) -> None:
    """A title at the left, in the size of an axis label; so many points above what stands on the axes."""
    ax.set_title(text, loc="left", fontsize=9.5, color=INK, pad=8 + above)


def whole_title(figure: Any, text: str) -> None:
    """A title at the left of a whole figure, above everything else on it."""
    figure.suptitle(text, fontsize=9.5, color=INK, x=0.01, ha="left")


def check_format(path: Path) -> str:
    """The suffix of a figure's file, if it is a format.

    Raises
    ------
    ContwalkError
    """
    if wrong := unknown_format(path):
        raise ContwalkError(f"A figure cannot be written to {path}: {wrong}.", allowed_formats())
    return path.suffix.lower()


def save(figure: Figure | Axes, path: str | PathLike[str]) -> Path:
    """Write a figure to a file: PNG (150 dpi), SVG, PDF or PGF, by the suffix of `path`.

    Text of PDF is in embedded fonts, of SVG in outlines; PGF is for LaTeX to typeset, which must be there.

    Parameters
    ----------
    figure : Figure or Axes
        A figure, or any axes on it.
    path : path-like
        The folder must exist; an existing file is replaced.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    ContwalkError
        For another suffix, or a path that cannot be written; for PGF without LaTeX.
    """
    target = Path(path)
    suffix = check_format(target)
    whole = (figure.figure if isinstance(figure, Axes) else figure).canvas.figure
    if whole.get_layout_engine() is None:
        whole.set_layout_engine("constrained")
    try:
        with matplotlib.rc_context(_WRITING | _for_tex(suffix, target)), written(target) as stream:
            if type(whole.canvas) is FigureCanvasAgg and (suffix, whole.dpi) == (".png", DPI):
                # as it stands; `savefig` would draw it once more before, for formats of other canvases
                whole.canvas.print_png(stream, metadata={}, pil_kwargs={"compress_type": Z_RLE})
            else:
                whole.savefig(stream, format=suffix[1:], dpi=DPI, **_UNDATED[suffix])
    except OSError as error:
        raise ContwalkError(
            f"The figure cannot be written to {target}: {error.strerror or error}.",
            "Name a file in an existing folder that you may write to.",
        ) from error
    return target


def _for_tex(suffix: str, target: Path) -> dict[Any, Any]:
    """What matplotlib has to know to write for LaTeX.

    Raises
    ------
    ContwalkError
        If there is none.
    """
    if suffix != ".pgf":
        return {}
    found = next(filter(which, _TEX), None)
    if found is None:
        raise ContwalkError(
            f"{target} cannot be written: LaTeX measures the texts of a PGF figure, and there is none.",
            f"Install one of {', '.join(_TEX)}, or write SVG or PDF.",
        )
    return {"pgf.texsystem": found, "pgf.rcfonts": False, "axes.unicode_minus": found != _TEX[-1]}
