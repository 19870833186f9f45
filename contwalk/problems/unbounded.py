"""Branches that run off to infinity while their parameter converges.

As an unknown x grows, lambda_inf - lambda falls like x^-p, or faster. Two neighbouring solutions with their
slopes d lambda / dx tell p, and with it how far the parameter still is from its limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contwalk.problems.problem import Sample

# The parameter is at its limit if what is left is this part of its magnitude; it must still be seen to move.
REST, SEEN = 1e-10, 1e-14
# Powers that are believed, and how well the step itself must fit: a fold that is nearly met has neither.
POWERS = (0.1, 100.0)
FITS = 0.2


@dataclass(frozen=True)
class Escape:
    """Which unknown grows without bound, and the limit of the parameter."""

    which: int
    limit: float


def escape(a: Sample, b: Sample) -> Escape | None:
    """Where a branch runs off to infinity beyond two neighbouring solutions; None if it does not."""
    which = int(np.argmax(np.abs(b.tangent[:-1]) / b.weights[:-1]))
    x, y = float(a.z[which]), float(b.z[which])
    if not abs(y) > abs(x) > 0.0 or x * y < 0.0 or a.tangent[which] * b.tangent[which] * y * y <= 0.0:
        return None
    first, last = (float(s.tangent[-1] / s.tangent[which]) for s in (a, b))
    if not (first * last > 0.0 and abs(last) < abs(first)):
        return None
    power = float(np.log(first / last) / np.log(y / x)) - 1.0
    if not POWERS[0] <= power <= POWERS[1]:
        return None
    moved, size = b.parameter - a.parameter, float(b.weights[-1])
    rest = last * y / power
    fits = abs((first * x - last * y) / power - moved) <= FITS * abs(moved)
    if not fits or abs(rest) > REST * size or abs(moved) < SEEN * size:
        return None
    return Escape(which, b.parameter + rest)
