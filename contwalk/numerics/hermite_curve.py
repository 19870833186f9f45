"""The curve between two neighbouring solutions, as their places and tangents tell it."""

from __future__ import annotations

import math

import numpy as np

from contwalk.numerics.linear import norm, norm_in


class HermiteCurve:
    """Cubic Hermite interpolation between two solutions, by position theta in 0..1 along the chord.

    Parameters
    ----------
    ends : pair of ndarray, shape (N + 1,)
    tangents : pair of ndarray, shape (N + 1,)
        Of any length, pointing from the first end to the second.
    weights : ndarray, shape (N + 1,)
        Of the metric.
    """

    def __init__(
        self,
        ends: tuple[np.ndarray, np.ndarray],
        tangents: tuple[np.ndarray, np.ndarray],
        weights: np.ndarray,
    ) -> None:
        self.ends, self.tangents, self.weights = ends, tangents, weights
        self.chord = ends[1] - ends[0]
        self.length = norm_in(self.chord, weights)
        self.normal = self.chord / weights**2 / max(self.length, 1e-300) ** 2
        # Lengths of the end tangents for an interpolation by theta.
        self._scales = [self.length / norm_in(tangent, weights) for tangent in tangents]

    @property
    def turn(self) -> float:
        """Angle between the tangents at its ends, radians."""
        u, v = (tangent / self.weights / norm_in(tangent, self.weights) for tangent in self.tangents)
        return 2.0 * math.atan2(norm(v - u), norm(v + u))

    @property
    def departure(self) -> float:
        """How far the chord's direction is from the mean direction of the tangents; nothing on an arc of a
        circle.
        """
        mean = sum(tangent / self.weights / norm_in(tangent, self.weights) for tangent in self.tangents)
        chord = self.chord / self.weights / max(self.length, 1e-300)
        return norm(chord - mean / max(norm(mean), 1e-300))

    def position(self, z: np.ndarray) -> float:
        """theta of the foot of z, shape (N + 1,), on the chord."""
        return float(self.normal @ (z - self.ends[0]))

    def guess(self, theta: float) -> np.ndarray:
        """The interpolated place at theta, shape (N + 1,)."""
        t, r = theta, 1.0 - theta
        scale_a, scale_b = self._scales
        ends = self.ends[0] + t * t * (3.0 - 2.0 * t) * self.chord
        z = ends + t * r * r * scale_a * self.tangents[0] - t * t * r * scale_b * self.tangents[1]
        return z + (theta - self.position(z)) * self.chord

    def direction(self, theta: float) -> np.ndarray:
        """Derivative of the interpolation by theta, shape (N + 1,).

        It is the way of the branch, also where its Jacobian is singular.
        """
        t, r = theta, 1.0 - theta
        scale_a, scale_b = self._scales
        along = 6.0 * t * r * self.chord
        along = along + (r * r - 2.0 * t * r) * scale_a * self.tangents[0]
        return along - (2.0 * t * r - t * t) * scale_b * self.tangents[1]
