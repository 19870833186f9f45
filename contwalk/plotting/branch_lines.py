"""How branches are drawn: stable solid, unstable dashed and thin, dotted where that is not known; not
admissible light on grey hatching.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from contwalk.branch import Branch
from contwalk.labels import UNDECIDED
from contwalk.plotting.overlaps import Cover
from contwalk.plotting.segments import runs
from contwalk.plotting.smooth_curves import Curve
from contwalk.plotting.style import light

# Unstable lines are thinner too, so that a part shorter than one dash is not taken for a stable one.
STABLE: dict[str, Any] = {"linestyle": "-", "linewidth": 1.9}
UNSTABLE: dict[str, Any] = {"linestyle": "--", "linewidth": 1.1, "dashes": (4.5, 2.5)}
NOT_KNOWN: dict[str, Any] = {"linestyle": ":", "linewidth": 1.5}
# What is drawn how, and called what, by whether it is stable; None: not known.
LOOKS = {True: ("stable", STABLE), False: ("unstable", UNSTABLE), None: (UNDECIDED, NOT_KNOWN)}
# Where the machine cannot move so, lines are light, on grey hatching across them.
HATCHING: dict[str, Any] = {
    "linestyle": "--",
    "linewidth": 4.5,
    "dashes": (0.11, 0.67),
    "dash_capstyle": "butt",
    "color": "#D9D9D9",
}
WHITE = 0.4  # share of white in their colour
LIGHTER = 0.75  # their width, in widths of the others
# Dashes along a stable line that an unstable one lies on.
INLAY: dict[str, Any] = {"linestyle": "--", "linewidth": 0.9, "dashes": (3.0, 3.0), "color": "white"}
LONG = 20.0  # points that they lie over one another at least: near a crossing any two do


class Pen:
    """What draws the lines of branches, and knows what is drawn."""

    def __init__(self, ax: Axes, low: np.ndarray, high: np.ndarray) -> None:
        self._ax = ax
        self._drawn: dict[str, Cover] = {}  # what is drawn in dashes, by their kind and colour
        self._stable = Cover(low, high)
        self._unstable: list[tuple[str, np.ndarray]] = []
        self._new = lambda: Cover(low, high)

    def draw(self, branch: Branch, name: str, curve: Curve, color: str, which: int) -> None:
        """Draw one line of a branch."""
        for k, run in enumerate(runs(branch)):
            part, number = curve.between(run.first, run.last), f"{k}" + (f"-{which}" if which else "")
            called, look = LOOKS[run.stable]
            kind, line = called.replace(" ", "-"), dict(look)
            if len(part) == 1:  # a line of one point is invisible
                line |= {"marker": "o", "markersize": 4.0, "fillstyle": "full" if run.stable else "none"}
            shade = color if run.admissible else light(color, WHITE)
            if not run.admissible:
                for line_part in self._bare("hatching", part):
                    self._ax.plot(*line_part.T, gid=f"{name}-inadmissible-{number}", zorder=1.5, **HATCHING)
                line["linewidth"] *= LIGHTER
            for line_part in [part] if run.stable else self._bare(shade, part):
                self._ax.plot(*line_part.T, color=shade, gid=f"{name}-{kind}-{number}", zorder=2, **line)
                if run.stable:
                    self._stable.bare(line_part)
                elif run.stable is False:
                    self._unstable.append((name, line_part))

    def inlay(self) -> bool:
        """Show where an unstable line lies on a stable one; whether there is such a place."""
        both = [(name, part) for name, line in self._unstable for part in self._stable.shared(line, LONG)]
        for name, part in both:
            self._ax.plot(*part.T, gid=f"{name}-on-stable", zorder=2.2, **INLAY)
        return bool(both)

    def _bare(self, kind: str, part: np.ndarray) -> list[np.ndarray]:
        if kind not in self._drawn:
            self._drawn[kind] = self._new()
        return self._drawn[kind].bare(part)
