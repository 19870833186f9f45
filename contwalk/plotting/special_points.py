"""How special points look: one marker per label, filled where located and hollow where not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.lines import Line2D

from contwalk.branch import SpecialPoint
from contwalk.labels import EVERY_MEANING
from contwalk.plotting.labels import MOST_SHARED
from contwalk.plotting.style import GREY, INK
from contwalk.special_point import told_kind

# Every marker has an inside, so that one drawn hollow can say "not located".
# A tuple is (number of tips, 1 for a star, angle).
MARKERS: dict[str, Any] = {
    "EP": ".",
    "UZ": "v",
    "LP": "s",
    "BP": "^",
    "HB": "o",
    "PD": "D",
    "NS": "h",
    "GR": "*",
    "OC": "P",
    "AZ": "X",
    "BE": "H",
    "CP": "<",
    "BT": ">",
    "GH": "p",
    "ZH": "d",
    "HH": "H",
    "CPC": (4, 1, 0),
    "GPD": "8",
    "CH": (6, 1, 0),
    "R1": "$1$",
    "R2": "$2$",
    "R3": "$3$",
    "R4": "$4$",
    "LPPD": (3, 1, 0),
    "LPNS": (3, 1, 180),
    "PDNS": (3, 1, 90),
    "NSNS": (7, 1, 0),
    "GRLP": (5, 1, 180),
    "GRPD": (8, 1, 0),
    "GRNS": (9, 1, 0),
    "GRGR": (10, 1, 0),
    "GRD": (5, 2, 0),
}
# Of a kind that has none here, as one of a later version.
OTHER = (5, 0, 180)
# Points wide; equal numbers do not look equally large for all shapes.
SIZES = {"EP": 5.0, "GR": 8.5, "PD": 5.0, "LP": 5.2}
SIZE = 6.0


def marker(label: str, color: str, *, located: bool = True, size: float | None = None) -> dict[str, Any]:
    """Properties of the line artist that marks a special point."""
    return {
        "linestyle": "none",
        "marker": MARKERS.get(label, OTHER),
        "markersize": size or SIZES.get(label, SIZE),
        "markerfacecolor": color if located else "white",
        "markeredgecolor": INK if located else color,
        "markeredgewidth": 0.6 if located else 1.1,
        "zorder": 3 if label == "EP" else 4,
    }


def legend_entries(points: Sequence[SpecialPoint]) -> list[Line2D]:
    """One entry for each label that occurs, with its meaning, and one for hollow markers if there are any."""
    entries = []
    for label in dict.fromkeys([*EVERY_MEANING, *(point.label for point in points)]):
        alike = [point for point in points if point.label == label]
        if alike:
            located = any(point.status == "located" for point in alike)
            meaning = f"{label}  {EVERY_MEANING.get(label, '')}".rstrip() + _marked(alike)
            entries.append(Line2D([], [], label=meaning, **marker(label, GREY, located=located)))
    if any(point.status != "located" for point in points):
        entries.append(Line2D([], [], label="hollow: not located", **marker("HB", GREY, located=False)))
    return entries


def _marked(points: Sequence[SpecialPoint]) -> str:
    """What the marked values among the points are of; of many, nothing."""
    what = dict.fromkeys(f"\n{told_kind(point)}" for point in points if point.mark)
    return "".join(what) if len(what) <= MOST_SHARED else ""
