"""A Moebius band round a cycle, whose doubled orbits are known in closed form."""

from __future__ import annotations


def band(t, x, p, dx):
    """Round r = 1, phi' = 2: across it a' = (lam - 1 - a^2) a, b' = -b / 2 in a frame that makes half a turn
    a round. The doubled orbit a^2 = lam - 1 meets the image of itself after each round."""
    s = x[0] ** 2 + x[1] ** 2
    r = s**0.5
    cos, sin = x[0] / r, x[1] / r
    first = 0.5 * ((1.0 + cos) * x[2] + sin * x[3])
    second = 0.5 * (sin * x[2] + (1.0 - cos) * x[3])
    a = p.lam - 1.0 - first * first - second * second
    dx[0] = (1.0 - s) * x[0] - 2.0 * x[1]
    dx[1] = 2.0 * x[0] + (1.0 - s) * x[1]
    dx[2] = a * first - 0.5 * (x[2] - first) - x[3]
    dx[3] = a * second - 0.5 * (x[3] - second) + x[2]
