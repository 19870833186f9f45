"""Machines with events whose motion between them is stiff, against closed forms.

A ball bounces on a table that shakes, and its bounce is told by a sensor that follows its speed at a rate K:
s' = K (v - s). After a few 1 / K it is s = v + g / K, so that with s - g / K for v in the bounce the orbits
are those of the ball alone, but for exp(-K T), and so are its points (tests/peers/machines/bouncing_ball.py).
The sensor adds a multiplier exp(-K T).
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hybrid_runs import diagram, machine

from contwalk.system import Transition

GRAVITY, ELASTIC, OMEGA = 9.81, 0.5, 35.0
FOLD, DOUBLING = 0.008386128961011121, 0.0122270534710955


def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -GRAVITY
    dx[2] = p.K * (x[1] - x[2])


def height(t, x, p):
    return x[0] - p.A * np.sin(OMEGA * t)


def bounce(t, x, p, x_plus):
    table = p.A * OMEGA * np.cos(OMEGA * t)
    x_plus[0], x_plus[2] = x[0], x[2]
    x_plus[1] = table - ELASTIC * (x[2] - GRAVITY / p.K - table)


@cache
def branch(rate):
    ball = machine(
        ["y", "v", "s"],
        {"A": 0.01, "K": rate},
        {"flight": fall},
        [Transition("bounce", "flight", "flight", height, reset=bounce)],
        period=lambda p: 2.0 * math.pi / OMEGA,
    )
    start = [0.018611376863, -0.719080881363, -0.719080881363 + GRAVITY / rate]
    (found,) = diagram(ball, "A", (0.008, 0.0125), start, events={"GR": "ignore"}, depth=0)
    return found


@pytest.mark.parametrize("rate", [pytest.param(1e3, marks=pytest.mark.long), 1e7])
class TestSensor:
    def test_special_points_are_those_of_the_ball(self, rate):
        points = [p for p in branch(rate).special_points if p.label != "EP"]
        assert [(p.label, p.status) for p in points] == [("LP", "located"), ("PD", "located")]
        for point, known in zip(points, (FOLD, DOUBLING), strict=True):
            # The closed form is known to a rounding of its terms.
            assert abs(point.parameters["A"] - known) <= point.error + 1e-14 * known

    def test_multipliers(self, rate):
        """Those of the ball have the product e^2, and the sensor has forgotten everything."""
        rows = branch(rate).points
        spectrum = rows["spectrum"]
        apart = np.abs(spectrum[:, 0] * spectrum[:, 1] - ELASTIC**2)
        # The error of the first one enters with the second one, and the other way round; both are below one
        # but for a first one of up to 4.2.
        assert np.all(apart <= 10.0 * rows["spectrum_error"])
        # exp(-K T) is below 1e-78: what is left is rounding.
        assert np.abs(spectrum[:, 2]).max() < 1e-13
