"""A rotating wave of three cells that doubles its period: its third has the multiplier -1, and so has it."""

import math

import numpy as np
import pytest
from hybrid_runs import assert_met, diagram
from small_systems import labelled, small_system

from contwalk.system import Symmetry

SPEED, REACH = 1.7, 0.04


def strip(t, x, p, dx):
    """z goes round the circle; w, seen from a frame that turns half as fast, obeys a' = m a - a^3, b' = -b.

    With m = REACH - mu^2 the wave w = 0 doubles where m = 0, to |w|^2 = m. In complex numbers w' is (i SPEED
    + m - 1) w / 2 + (m + 1) z w* / 2 - |w|^2 w.
    """
    m, away, size = REACH - p.mu**2, 1.0 - x[0] ** 2 - x[1] ** 2, x[2] ** 2 + x[3] ** 2
    dx[0] = x[0] * away - SPEED * x[1]
    dx[1] = x[1] * away + SPEED * x[0]
    turned = x[0] * x[2] + x[1] * x[3], x[1] * x[2] - x[0] * x[3]
    dx[2] = 0.5 * (-SPEED * x[3] + (m - 1.0) * x[2] + (m + 1.0) * turned[0]) - size * x[2]
    dx[3] = 0.5 * (SPEED * x[2] + (m - 1.0) * x[3] + (m + 1.0) * turned[1]) - size * x[3]


def third(t, x, p, y):
    """z by a third of a turn, w by two thirds."""
    c, s = -0.5, 0.5 * math.sqrt(3.0)
    y[0], y[1] = c * x[0] - s * x[1], s * x[0] + c * x[1]
    y[2], y[3] = c * x[2] + s * x[3], c * x[3] - s * x[2]


@pytest.mark.slow
def test_a_third_with_the_multiplier_minus_one_doubles_the_whole():
    """It was told that the orbits that leave had lost the symmetry; none was found, or the wave once more."""
    system = small_system(strip, "xyuv", {"mu": -0.3}, symmetries=(Symmetry("third", "spatial", third),))
    start = [1.0, 0.0, 0.1, 0.0]
    wave, doubled = diagram(system, "mu", (-0.31, 0.31), start, until="settled", follow=["PD", "BP"])
    points = labelled(wave, "PD", "BP", "NS", "LP")
    assert [(p.label, p.criticality) for p in points] == [("PD", "supercritical")] * 2
    for point, place in zip(points, (-0.2, 0.2), strict=True):
        assert_met(point, "mu", place)
        assert point.period_full == pytest.approx(2.0 * math.pi / SPEED, rel=1e-8)
    # Both ends are the wave; it is walked once, and closes up to the symmetry.
    assert (doubled.outcome.reason, doubled.info.closure) == ("rejoined", "third")
    size = np.hypot(doubled.points["state"][:, 2], doubled.points["state"][:, 3])
    # Steps are made for 1e-9 of the range; near its ends |w| is the root of that.
    inside = doubled["mu"][np.abs(doubled["mu"]) < 0.19], size[np.abs(doubled["mu"]) < 0.19]
    assert inside[1] ** 2 == pytest.approx(REACH - inside[0] ** 2, abs=1e-8)
    assert doubled.points["period"][1:-1] == pytest.approx(4.0 * math.pi / (3.0 * SPEED), rel=1e-8)
