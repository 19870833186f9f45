"""What fixes the phase of an orbit of an autonomous system.

A *section* is a hyperplane through a point of the orbit, at a right angle to the flow in the metric. It is
anchored anew at every point of a branch, so that the flow always crosses it well, and where the orbit has become slow
there it moves to where the orbit is fast. The *integral* condition asks for the phase nearest to that of the
last orbit, over the whole period (E. J. Doedel, 1981).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Section:
    """normal . (x(0) - point) = 0, with |normal| = 1 in the metric's dual norm."""

    point: np.ndarray
    normal: np.ndarray

    def residual(self, x: np.ndarray) -> float:
        """Left side of the condition."""
        return float(self.normal @ (x - self.point))


def section_at(point: np.ndarray, velocity: np.ndarray, magnitudes: np.ndarray) -> Section:
    """The section through a point at a right angle to the velocity, in units of the magnitudes."""
    normal = velocity / magnitudes**2
    return Section(point, normal / np.linalg.norm(normal * magnitudes))


@dataclass(frozen=True, eq=False)
class Reference:
    """An orbit and its velocity at times of quadrature, for the integral phase condition.

    `points` and `rows` have one array a segment, each of shape (s + 1, n): states of the last orbit and
    its velocities times quadrature weights, in the metric.
    """

    points: tuple[np.ndarray, ...]
    rows: tuple[np.ndarray, ...]


def reference_of(
    times: Sequence[np.ndarray],
    points: Sequence[np.ndarray],
    velocities: Sequence[np.ndarray],
    magnitudes: np.ndarray,
) -> Reference:
    """The reference that an orbit itself is: states and velocities at the steps of each segment."""
    rows = []
    for t, f in zip(times, velocities, strict=True):
        weights = np.zeros(len(t))  # the trapezoidal rule
        weights[:-1] += 0.5 * np.diff(t)
        weights[1:] += 0.5 * np.diff(t)
        rows.append(weights[:, None] * f / magnitudes**2)
    size = np.sqrt(sum(float(np.sum((r * magnitudes) ** 2)) for r in rows))
    return Reference(tuple(points), tuple(r / size for r in rows))
