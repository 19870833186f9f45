"""Doubled orbits beside which deviations grow by more than one integration can carry."""

import math

import numpy as np
import pytest
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.system import State

RATE, LOW, HIGH = 12.0, 0.99, 1.04


def band(t, x, p, dx):
    """A Moebius band round the cycle r = 1, phi' = 2: across it a' = (lam - 1 - a^2) a, b' = -b / 2 in a
    frame that makes half a turn a round; and a state that grows by exp(12 pi) = 2e16 in a round."""
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
    dx[4] = RATE * x[4] - first


# The first as many as the growth asks for, the second as in a run file.
@pytest.mark.parametrize("segments", [None, 20])
def test_a_doubled_orbit_is_never_integrated_in_one_piece(segments):
    states = ("x", "y", *(State(name, scale=1.0) for name in "zwu"))
    system = small_system(band, states, {"lam": LOW})
    given = cw.Discretization(accuracy=1e-8, segments=segments)
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam", discretization=given)
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0, 0.0], (LOW, HIGH), period=math.pi)
    (point,) = labelled(branch, "PD")
    doubled = cw.switch_branch(problem, branch, point, (LOW, HIGH))
    assert doubled.outcome.reason == "bound"
    last = doubled.points[-1]
    # Local errors of 1e-6, a hundred times.
    assert last["period"] == pytest.approx(2.0 * math.pi, rel=1e-4)
    amplitude = np.max([doubled["max:z"][-1], -doubled["min:z"][-1]])
    assert amplitude == pytest.approx(math.sqrt(HIGH - 1.0), rel=1e-4)  # a, where phi = 0
    # Of a' = (lam - 1 - a^2) a over two rounds, and the growing state's.
    assert last["spectrum"][1].real == pytest.approx(math.exp(-4.0 * math.pi * (HIGH - 1.0)), rel=1e-4)
    assert math.log(abs(last["spectrum"][0])) == pytest.approx(2.0 * math.pi * RATE, rel=1e-5)
