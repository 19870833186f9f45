"""What fixes the phase of an orbit of an autonomous system.

A *section* is a hyperplane through a point of the orbit, at a right angle to the flow in the metric. It is
anchored anew at every point of a branch, so that the flow always crosses it well. Where the orbit has become
slow there it moves to where the orbit is fast: near an equilibrium the flow hardly crosses anything. An orbit
that jumps has its section right before the largest jump. In the jump the state would depend on the instant by
far too much; long before it, the jump would come at another part of the period where the period has grown, on
steps that were made for rest. The *integral* condition asks for the phase nearest to that of the last orbit,
over the whole period (Doedel, 1981).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# Parts of the mean speed of an orbit, in the metric. One that is faster than the second somewhere, and for
# half its time not slower than the first, has jumps; of others the fastest speed counts.
SLOW, JUMPING = 0.05, 20.0
# Where it jumps, its section lies where it is as fast as this before the largest jump; and is well where it
# is up to this part of the period before that.
RISING, BEFORE = 10.0, 0.02


@dataclass(frozen=True, eq=False)
class Section:
    """normal . (x(0) - point) = 0, with |normal| = 1 in the metric's dual norm.

    `point` and `normal` have the shape (n,).
    """

    point: np.ndarray
    normal: np.ndarray

    def residual(self, x: np.ndarray) -> float:
        """Left side of the condition. x has the shape (n,)."""
        return float(self.normal @ (x - self.point))


def section_at(point: np.ndarray, velocity: np.ndarray, magnitudes: np.ndarray) -> Section:
    """The section through a point at a right angle to the velocity, in units of the magnitudes.

    All have the shape (n,).
    """
    normal = velocity / magnitudes**2
    return Section(point, normal / np.linalg.norm(normal * magnitudes))


def better_phase(times: np.ndarray, speeds: np.ndarray, lengths: np.ndarray) -> float | None:
    """The instant to which the section should move, None if it is well where it is.

    Parameters
    ----------
    times, speeds, lengths : ndarray, shape (s,)
        Middles of the orbit's steps, its speed there, and how long they are. The section is at the first.
    """
    mean = float(speeds @ lengths / lengths.sum())
    order = np.argsort(speeds)
    median = order[int(np.searchsorted(np.cumsum(lengths[order]), 0.5 * lengths.sum()))]
    if speeds.max() > JUMPING * mean and speeds[median] > SLOW * mean:
        return _before_the_jump(times, speeds / mean)
    return float(times[int(np.argmax(speeds))]) if speeds[0] < SLOW * speeds.max() else None


def _before_the_jump(times: np.ndarray, speeds: np.ndarray) -> float | None:
    """The instant right before an orbit is fastest, None if the section is not far from it; `speeds` are
    relative to the mean.
    """
    fastest = int(np.argmax(speeds))
    slower = np.flatnonzero(np.roll(speeds, -fastest) <= RISING)[
        -1
    ]  # the last one of the round that ends there
    before = (int(slower) + fastest) % len(speeds)
    ahead = float((times[fastest] - times[before]) % 1.0)
    if SLOW <= speeds[0] <= JUMPING and times[fastest] <= 2.0 * ahead + BEFORE:
        return None
    return float(times[before])


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
    """The reference that an orbit itself is: states and velocities at the steps of each segment.

    Of each segment, shapes (s + 1,) and (s + 1, n); magnitudes have (n,).
    """
    rows = []
    for t, f in zip(times, velocities, strict=True):
        weights = np.zeros(len(t))  # the trapezoidal rule
        weights[:-1] += 0.5 * np.diff(t)
        weights[1:] += 0.5 * np.diff(t)
        rows.append(weights[:, None] * f / magnitudes**2)
    size = np.sqrt(sum(float(np.sum((r * magnitudes) ** 2)) for r in rows))
    return Reference(tuple(points), tuple(r / size for r in rows))
