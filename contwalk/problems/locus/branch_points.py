"""The condition of branch points that persist as two parameters vary, along one of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.numerics.linear import EPSILON, balanced
from contwalk.problems.locus import bordered
from contwalk.problems.locus.bordered import CrossingBorders, Deficient
from contwalk.problems.locus.plane import FloatPlace, Place, Plane

# Where both parameters stand in z.
SECOND, FIRST = -2, -1
# A branch point persists where moving the second parameter by its magnitude leaves no more than this of the
# equations, against their terms, that states cannot make good.
PERSISTS = 1e-6


@dataclass(frozen=True)
class BranchPoint:
    """Branches along a parameter cross: DF by states and that parameter loses rank (Moore 1980).

    F + mu b = 0 with b, the column of its borders: mu is zero where the branch point is one. The parameter
    is number `place` of z. Where branch points persist they are those along either, but the equations are
    singular where their curve is parallel to its axis.
    """

    borders: CrossingBorders
    place: int = FIRST
    unknowns: int = 1

    @property
    def unfolding(self) -> np.ndarray:
        """b, shape (N,)."""
        return self.borders.column

    def told(self, place: Place, own: Any) -> Deficient:
        """Both values of DF by states and the parameter."""
        return bordered.deficient(_by_one(place.jacobian, self.place), self.borders, place.solver)

    def gradients(self, place: Place, told: Deficient, own: Any) -> np.ndarray:
        """Derivatives of both values by z; mu has no part in them; shape (2, N + 3)."""
        moved = (np.insert(q, len(q) - (self.place != SECOND), 0) for q in told.right)  # as directions of z
        slopes = [-(told.left @ place.slopes(q)) for q in moved]
        return np.column_stack([np.array(slopes), np.zeros(2)])

    def levels(self, place: FloatPlace, told: Deficient, own: float) -> np.ndarray:
        """Rounding of both values, shape (2,)."""
        last = EPSILON * np.abs(place.jacobian[:, self.place])[:, None]
        noise = np.hstack([place.noise, last])
        return np.array([np.abs(told.left) @ noise @ np.abs(q) for q in told.right])


def _by_one(matrix: np.ndarray, place: int) -> np.ndarray:
    """The columns of states, drifts and one parameter, shape (M, N + 1), from those of z, (M, N + 2)."""
    return np.delete(matrix, FIRST + SECOND - place, axis=1)


def branch_point(plane: Plane, z: np.ndarray, units: np.ndarray | None = None) -> BranchPoint:
    """The condition of branch points near z, shape (N + 2,), that persist as both parameters vary.

    The vectors of its borders are taken in balanced units, or in given ones of z, shape (N + 2,): near an
    invariant face balance is lost.
    """
    jacobian = plane.jacobian(z)
    place = _moving_across(plane, z, jacobian)
    one = _by_one(jacobian, place)
    if units is not None:
        own = _by_one(units[None, :], place)[0]
        return BranchPoint(bordered.crossing_borders(one, own[:-1], own), place)
    scaled, d = balanced(one[:, :-1])
    last = float(np.abs(one[:, -1] / d).max())
    size = float(np.abs(scaled).max())
    weight = size / last if last > 0.0 and size > 0.0 else 1.0
    return BranchPoint(bordered.crossing_borders(one, d, np.append(d, weight)), place)


def _moving_across(plane: Plane, z: np.ndarray, jacobian: np.ndarray) -> int:
    """Which parameter the curve of branch points through z is farther from parallel to, by its place in z.

    With F_u q = 0, F_u h + F_parameter = 0 and B the second derivative, the eigenvalue of either branch that
    crosses passes zero as the parameter moves at the rate of the root of (p.B(q, h))^2 - p.B(q, q) p.B(h, h).
    """
    size = plane.size
    known = plane.linearize(z).levels[1]
    sizes = np.maximum(np.abs(z), 1.0) if known is None else known
    sizes = np.where(np.isfinite(sizes) & (sizes > 0.0), sizes, np.maximum(np.abs(z), 1.0))
    scaled = jacobian[:, :size] * sizes[:size]
    rows = np.abs(jacobian * sizes).max(axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)
    u, _, vh = np.linalg.svd(scaled / rows[:, None])
    q, p = np.append(vh[-1] * sizes[:size], [0.0, 0.0]), u[:, -1] / rows
    if abs(p @ jacobian[:, SECOND]) * sizes[SECOND] > PERSISTS:
        return FIRST  # no branch point along the second one
    place = FloatPlace(plane, z)
    along_q = p @ place.slopes(q)

    def passes(parameter: int) -> float:
        right = jacobian[:, parameter] - p * (p @ jacobian[:, parameter]) / (p @ p)
        h = np.zeros(size + 2)
        h[:size] = -sizes[:size] * np.linalg.lstsq(scaled, right, rcond=1e-12)[0]
        h[parameter] = 1.0
        square = (along_q @ h) ** 2 - (along_q @ q) * (p @ place.slopes(h) @ h)
        return float(abs(square)) ** 0.5 * sizes[parameter]

    return SECOND if passes(SECOND) > passes(FIRST) else FIRST
