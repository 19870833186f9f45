"""Curves through the points of a branch: Hermite's cubics with the stored tangents, not corners.

The free parameter changes along a branch as the stored tangent says, and so do the states of an equilibrium.
Any other quantity is a function of the point that nobody differentiated; its slope over the arclength is
Akima's, which makes no waves beside a kink. Where the cubic would run off, a segment stays straight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.branch import Branch

PARTS = 12  # of a segment that is not straight
FLAT = 5e-4  # how far off its chord a cubic is still straight, in parts of the figure
FARTHEST = 0.5  # how far off it may be, in lengths of the chord


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve of shape (m, 2) through the points of a branch, and where these are in it, (k,)."""

    points: np.ndarray
    at: np.ndarray

    @property
    def rows(self) -> np.ndarray:
        """The branch's own points, shape (k, 2)."""
        return self.points[self.at]

    def between(self, first: int, last: int) -> np.ndarray:
        """The part from one row to another, both included, shape (j, 2)."""
        return self.points[self.at[first] : self.at[last] + 1]


def curve_of(
    branch: Branch, names: tuple[str, str], points: np.ndarray, size: np.ndarray | None = None
) -> Curve:
    """The curve through the points, shape (k, 2), that two quantities have on a branch.

    `size`, shape (2,), is that of the part of the plane that is shown: by default that of the points.
    """
    corners = Curve(points, np.arange(len(points)))
    if len(points) < 2 or not _has_tangents(branch):
        return corners
    s = branch["s"]
    slopes = np.stack([slope_of(branch, name, s, points[:, i]) for i, name in enumerate(names)], axis=1)
    finite = points[np.isfinite(points).all(axis=1)]
    if size is None:
        size = np.ptp(finite, axis=0) if len(finite) else np.ones(2)
    size = np.where(size > 0.0, size, 1.0)
    parts, at = [points[:1]], [0]
    for row in range(len(points) - 1):
        inner = _inner(points[row : row + 2] / size, slopes[row : row + 2] / size, s[row + 1] - s[row]) * size
        parts += [inner, points[row + 1 : row + 2]]
        at.append(at[-1] + len(inner) + 1)
    return Curve(np.concatenate(parts), np.array(at))


def _has_tangents(branch: Branch) -> bool:
    return bool(np.any(np.nan_to_num(branch["tangent"])))


def slope_of(branch: Branch, name: str, s: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Derivative of a quantity by the arclength s at the points; s, values and it have the shape (k,)."""
    if not _has_tangents(branch):
        return akima(s, values)
    tangent = branch["tangent"]
    if name in branch.info.free:  # those of a curve in two parameters stand in the other order
        last = np.isfinite(branch["unknowns"]).sum(axis=1) - branch.info.free.index(name)
        return np.asarray(tangent[np.arange(len(branch)), last])
    if branch.info.problem == "equilibrium" and name in branch.info.states:
        return np.asarray(tangent[:, branch.info.states.index(name)])
    return akima(s, values)


def akima(s: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Akima's slopes (1970) of values over growing s; NaN beside values that are not finite.

    All three have the shape (k,), k at least 2.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        d = np.diff(values) / np.diff(s)
        if len(d) == 1:
            return np.array([d[0], d[0]])
        before = [2.0 * d[0] - d[1], 3.0 * d[0] - 2.0 * d[1]]
        after = [2.0 * d[-1] - d[-2], 3.0 * d[-1] - 2.0 * d[-2]]
        d = np.concatenate([before[::-1], d, after])
        left, right = np.abs(d[1:-2] - d[:-3]), np.abs(d[3:] - d[2:-1])
        level = left + right
        slopes = (right * d[1:-2] + left * d[2:-1]) / level
        return np.asarray(np.where(level > 0.0, slopes, 0.5 * (d[1:-2] + d[2:-1])))


def _inner(ends: np.ndarray, slopes: np.ndarray, h: float) -> np.ndarray:
    """Points of the cubic between two others, in parts of the figure; none where it is straight."""
    none = np.zeros((0, 2))
    if not (h > 0.0 and np.isfinite(ends).all() and np.isfinite(slopes).all()):
        return none
    u = np.linspace(0.0, 1.0, PARTS + 1)[1:-1, None]
    (a, b), (ma, mb) = ends, h * slopes
    d = b - a
    curve = a + u * (ma + u * (3.0 * d - 2.0 * ma - mb + u * (ma + mb - 2.0 * d)))
    chord = float(np.hypot(*d))
    away = np.hypot(*(curve - a - u * d).T).max()
    # Along its own chord a cubic may run unevenly: that shows nowhere.
    if chord > 0.0:
        across = np.abs((curve - a) @ np.array([-d[1], d[0]]) / chord).max()
        along = (curve - a) @ d / chord**2
        if across < FLAT and along.min() >= 0.0 and along.max() <= 1.0:
            return none
    return none if away > FARTHEST * chord else curve
