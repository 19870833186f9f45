"""Doubled orbits whose halves are images of each other are closed up to the symmetry, and lose it as such."""

import math

import numpy as np
import pytest
from moebius import band
from small_systems import labelled, small_system

import contwalk as cw
from contwalk.system import State, Symmetry

T = math.pi
# Local errors of 1e-6 where an accuracy of 1e-8 is asked for, some ten of them.
WALKED = 1e-5


def across(t, x, p, image):
    image[0], image[1] = x[0], x[1]
    image[2], image[3] = -x[2], -x[3]


def test_an_autonomous_one_in_closed_form():
    states = ("x", "y", State("z", scale=1.0), State("w", scale=1.0))
    mirror = Symmetry("across", "spatial", across)
    system = small_system(band, states, {"lam": 0.9}, symmetries=(mirror,))
    problem = cw.PeriodicOrbit(system, system.defaults(), "lam")
    branch = cw.continue_branch(problem, [1.0, 0.0, 0.0, 0.0], (0.9, 1.2), period=T)
    (point,) = labelled(branch, "PD")
    doubled = cw.switch_branch(problem, branch, point, (0.9, 1.2))
    assert (doubled.info.closure, doubled.info.settings["fold"]) == ("across", 2)
    assert doubled.outcome.reason == "bound"
    assert not labelled(doubled, "BP", "LP", "PD", "NS")
    last = doubled.points[-1]
    assert last["period"] == pytest.approx(T, rel=WALKED)  # of the closure, half of the orbit's
    assert doubled["max:z"][-1] == pytest.approx(math.sqrt(0.2), rel=WALKED)
    assert doubled["min:z"][-1] == pytest.approx(-math.sqrt(0.2), rel=WALKED)
    exact = sorted([math.exp(-2.0 * 0.2 * T), math.exp(-0.5 * T), math.exp(-2.0 * T)], reverse=True)
    np.testing.assert_allclose(np.abs(last["spectrum"]), exact, rtol=0, atol=WALKED)


def pendulum(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.1 * x[1] - (1.0 + 4.0 * p.a * np.cos(2.0 * t)) * np.sin(x[0])


def mirrored(t, x, p, image):
    image[0], image[1] = -x[0], -x[1]


@pytest.mark.long
def test_a_forced_one_loses_its_mirror_at_a_symmetry_breaking_point():
    """A pendulum whose pivot shakes: the hanging state doubles, theta(t + T) = -theta(t) on what is born."""
    mirror = Symmetry("mirror", "spatial", mirrored)
    system = small_system(pendulum, ("theta", "v"), {"a": 0.02}, period=lambda p: T, symmetries=(mirror,))
    problem = cw.PeriodicOrbit(system, system.defaults(), "a")
    hanging = cw.continue_branch(problem, [0.0, 0.0], (0.02, 0.1))
    (point,) = labelled(hanging, "PD")
    doubled = cw.switch_branch(problem, hanging, point, (0.02, 0.4))
    assert (doubled.info.closure, doubled.info.subharmonic) == ("mirror", 2)
    (lost,) = labelled(doubled, "BP", "PD", "LP", "NS")
    assert (lost.label, lost.kind) == ("BP", "symmetry-breaking")
    # Recomputed by collocation: the 13 digits of the tests of published problems.
    assert abs(lost.parameters["a"] - 0.3147357514810003) <= lost.error + 4e-14
    assert (lost.period, lost.period_full) == (pytest.approx(T), pytest.approx(2.0 * T))
    whole = cw.switch_branch(problem, doubled, lost, (0.3, 0.32))
    assert whole.info.closure == "full"
    assert np.all(whole.points["period"] == pytest.approx(2.0 * T))
