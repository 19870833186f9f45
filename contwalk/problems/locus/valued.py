"""Conditions of curves of orbits that are values of functions, whose derivatives nobody has.

What an orbit's motion is measured by, and what soft transitions leave of an orbit's equations, is known at
one place at a time. Of its derivatives only those along the solutions of F = 0 matter: across them Newton's
method is led by F itself. These are as many as there are unknowns more than equations, two or three, and are
taken as differences of both sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

# How far along each direction the functions are looked at, in the metric.
BESIDE = 1e-4

# Values, shape (m,), at a vector (u, second, first) of a plane of orbits, shape (N + 2,).
Values = Callable[[Any, np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Valued:
    """Functions that vanish, beside F + b mu = 0.

    Parameters
    ----------
    values : callable
        See `Values`.
    weights : ndarray, shape (N + 2,)
        Typical magnitudes of (u, second, first).
    start, scale : ndarray, shape (N + 1 + k,)
        The place that it is made near, in the order (u, first, mu), and typical magnitudes.
    unfolding : ndarray, shape (N, k)
        b, a column for each further unknown mu.
    slopes : ndarray, shape (m, N + 2), optional
        Derivatives by (u, second, first), where they are known.
    by_own : ndarray, shape (m, k), optional
        Derivatives by the further unknowns, constant; None: the values know nothing of them.
    """

    values: Values
    weights: np.ndarray
    start: np.ndarray
    scale: np.ndarray
    unfolding: np.ndarray
    slopes: np.ndarray | None = None
    by_own: np.ndarray | None = None

    def over(self, plane: Any, z: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, and its derivatives by (u, second, first) and by the further unknowns.

        With z of shape (N + j + 2,) and k further unknowns the shapes are (N + m,), (N + m, N + 2) and
        (N + m, k).
        """
        n = plane.size
        place = np.concatenate([z[:n], z[-2:]])
        residual, jacobian = in_plane(plane, place)
        values = self.values(plane, place)
        slopes = self.differenced(plane, place, jacobian) if self.slopes is None else self.slopes
        changing = np.zeros((len(values), len(own))) if self.by_own is None else self.by_own
        by_own = np.vstack([self.unfolding, changing])
        moved, values = residual + self.unfolding @ own, values + changing @ own
        return np.concatenate([moved, values]), np.vstack([jacobian, slopes]), by_own

    def differenced(self, plane: Any, place: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """Derivatives by (u, second, first), shape (m, N + 2), zero across the solutions of F + b mu = 0."""
        n, scale = plane.size, self.weights
        whole = np.hstack([jacobian * scale, self.unfolding])
        sizes = np.linalg.norm(whole, axis=1)
        whole = whole / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        free = np.linalg.qr(whole.T, mode="complete")[0][: n + 2, len(whole) :]
        free = np.linalg.qr(free)[0]
        rows = []
        for direction in free.T:
            step = BESIDE * scale * direction
            ahead, behind = (self.values(plane, place + sign * step) for sign in (1.0, -1.0))
            rows.append(np.outer((ahead - behind) / (2.0 * BESIDE), direction / scale))
        return np.asarray(np.sum(rows, axis=0))


def in_plane(plane: Any, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F, shape (N,), and its derivatives by (u, second, first), shape (N, N + 2), at such a vector."""
    n = plane.size
    first, second = plane.on_lines(place)
    by_first = first.linearize(np.append(place[:n], place[-1]))
    by_second = second.linearize(np.append(place[:n], place[-2])).jacobian[:, n:]
    jacobian = by_first.jacobian
    return by_first.residual, np.hstack([jacobian[:, :n], by_second, jacobian[:, n:]])
