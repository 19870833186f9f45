"""On which side of a curve in two parameters something is stable: short ticks that point there.

It is told by the branch that the curve was begun from: on one side of the special point it has fewer unstable
directions, or, at a fold, goes on at all. That side stays the same along the curve, through cusps as well.
There are ticks where nothing else is unstable.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withTickedStroke

from contwalk.branch import Branch, SpecialPoint
from contwalk.plotting.smooth_curves import Curve

# Points between ticks, and their length in parts of that.
TICKS: dict[str, Any] = {"spacing": 9.0, "length": 0.6, "linewidth": 0.7}
FOLD = "LP"


def draw_ticks(
    ax: Axes, branches: Sequence[Branch], branch: Branch, curve: Curve, shown: np.ndarray, color: str
) -> bool:
    """Draw ticks on the stable side of a curve; whether there are any.

    Parameters
    ----------
    ax : Axes
        Of two free parameters of the curve.
    branches : sequence of Branch
        Among which is the one that the curve was begun from.
    branch, curve : Branch, Curve
    shown : array of bool, shape (k,)
        Rows of the branch that may have ticks.
    color : str
    """
    left = _left(branches, branch, curve)
    rows = shown & (branch.points["unstable"] == 0)
    if not left or not rows.any():
        return False
    stroke = withTickedStroke(angle=90.0 * left, **TICKS)
    ends = np.isin(np.arange(len(rows)), np.array(branch.gaps(), dtype=int) + 1).cumsum()
    start = 0
    for (own, _), members in groupby(zip(rows.tolist(), ends.tolist(), strict=True)):
        stop = start + len(list(members))
        if own:
            line = curve.between(start, stop - 1)
            ax.plot(*line.T, color=color, linewidth=0.0, gid=f"{branch.name}-ticks", path_effects=[stroke])
        start = stop
    return True


def _left(branches: Sequence[Branch], branch: Branch, curve: Curve) -> float:
    """1.0 where the stable side is on the left, in the order of the curve's points; -1.0; 0.0: not known."""
    origin = _origin(branches, branch)
    at = int(np.abs(branch["s"]).argmin())
    if origin is None or branch["s"][at] != 0.0:
        return 0.0
    parent, point = origin
    free, rows = parent.info.free[0], curve.rows
    way = _stable_way(point, parent[free])
    stable = np.array([way if np.array_equal(branch[free], axis) else 0.0 for axis in rows.T])
    before, after = rows[max(at - 1, 0)], rows[min(at + 1, len(rows) - 1)]
    dx, dy = after - before
    return float(np.sign(dx * stable[1] - dy * stable[0]))


def _origin(branches: Sequence[Branch], branch: Branch) -> tuple[Branch, SpecialPoint] | None:
    """The branch and the special point that a curve was begun from."""
    name, s = branch.info.parent or ("", 0.0)
    for parent in branches:
        if parent.name == name and len(parent.info.free) == 1:
            for point in parent.special_points:
                if point.s == s and point.label == branch.info.settings.get("of"):
                    return parent, point
    return None


def _stable_way(point: SpecialPoint, values: np.ndarray) -> float:
    """The sign of the parameter's way to the stable side of a point; `values`, shape (k,): of the branch."""
    before, after, k = point.unstable_before, point.unstable_after, point.index
    if before is None or after is None or before == after or not 0 < k < len(values) - 1:
        return 0.0
    side = -1 if before < after else 1
    other = 0.0 if point.label == FOLD else float(np.sign(values[k] - values[k - side]))
    way = float(np.sign(values[k + side] - values[k]))
    return way if other in (0.0, way) else 0.0
