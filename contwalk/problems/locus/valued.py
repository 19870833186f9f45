"""Conditions of curves of orbits that are values of functions, whose derivatives may be unknown.

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
# Their derivatives by it, shape (m, N + 2), None where nobody has them.
Derivatives = Callable[[Any, np.ndarray], np.ndarray | None]


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
    exactly : callable, optional
        See `Derivatives`.
    """

    values: Values
    weights: np.ndarray
    start: np.ndarray
    scale: np.ndarray
    unfolding: np.ndarray
    slopes: np.ndarray | None = None
    by_own: np.ndarray | None = None
    exactly: Derivatives | None = None

    def over(self, plane: Any, z: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, and its derivatives by (u, second, first) and by the further unknowns.

        With z of shape (N + j + 2,) and k further unknowns the shapes are (N + m,), (N + m, N + 2) and
        (N + m, k).
        """
        n = plane.size
        place = np.concatenate([z[:n], z[-2:]])
        residual, jacobian = in_plane(plane, place)
        values = self.values(plane, place)
        slopes = self._derivatives(plane, place)
        if slopes is None:
            slopes = self._differenced(plane, place, self.solutions(jacobian))
        changing = np.zeros((len(values), len(own))) if self.by_own is None else self.by_own
        by_own = np.vstack([self.unfolding, changing])
        moved, values = residual + self.unfolding @ own, values + changing @ own
        return np.concatenate([moved, values]), np.vstack([jacobian, slopes]), by_own

    def along(self, plane: Any, place: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
        """Derivatives along the solutions of F + b mu = 0, shape (m, N + 2), zero across them."""
        free, slopes = self.solutions(jacobian), self._derivatives(plane, place)
        if slopes is None:
            return self._differenced(plane, place, free)
        return np.asarray((slopes * self.weights) @ free @ free.T / self.weights)

    def _derivatives(self, plane: Any, place: np.ndarray) -> np.ndarray | None:
        """Derivatives by (u, second, first), shape (m, N + 2), where they are known."""
        return self.slopes if self.exactly is None else self.exactly(plane, place)

    def solutions(self, jacobian: np.ndarray) -> np.ndarray:
        """Directions along which F + b mu stays zero, orthonormal in the metric, shape (N + 2, l)."""
        n = len(self.weights) - 2
        whole = np.hstack([jacobian * self.weights, self.unfolding])
        sizes = np.linalg.norm(whole, axis=1)
        whole = whole / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        free = np.linalg.qr(whole.T, mode="complete")[0][: n + 2, len(whole) :]
        return np.asarray(np.linalg.qr(free)[0])

    def _differenced(self, plane: Any, place: np.ndarray, free: np.ndarray) -> np.ndarray:
        """Differences of both sides, as `along`."""
        rows = []
        for direction in free.T:
            step = BESIDE * self.weights * direction
            ahead, behind = (self.values(plane, place + sign * step) for sign in (1.0, -1.0))
            rows.append(np.outer((ahead - behind) / (2.0 * BESIDE), direction / self.weights))
        return np.asarray(np.sum(rows, axis=0))


def in_plane(plane: Any, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """F, shape (N,), and its derivatives by (u, second, first), shape (N, N + 2), at such a vector."""
    n = plane.size
    first, second = plane.on_lines(place)
    by_first = first.linearize(np.append(place[:n], place[-1]))
    by_second = second.linearize(np.append(place[:n], place[-2])).jacobian[:, n:]
    jacobian = by_first.jacobian
    return by_first.residual, np.hstack([jacobian[:, :n], by_second, jacobian[:, n:]])
