"""Equilibria at zero that rounding leaves at 1e-17: what is noise tells no magnitudes."""

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw


def offset(t, x, p, dx):
    """0.3 * 0.1 is not 0.03 in floats: what is left of them moves the equilibrium away from zero by 1e-17."""
    dx[0] = p.a * x[0] - x[1] - x[0] ** 3 + 0.3 * p.c * np.cos(x[0]) - 0.03
    dx[1] = x[0] - x[1]


def test_the_branch_that_leaves_there_is_followed():
    """x1 = x0, and a = 1 + x0^2 + 0.03 (1 - cos x0) / x0 on the branch that crosses x = 0 at a = 1."""
    system = small_system(offset, "xy", {"a": 0.5, "c": 0.1})
    problem = cw.Equilibrium(system, system.defaults(), "a")
    rest = cw.continue_branch(problem, {"x": 0.0, "y": 0.0}, (0.0, 2.0))
    assert 0.0 < np.abs(rest.points["state"]).max() < 1e-15
    (point,) = [point for point in rest.special_points if point.label == "BP"]
    assert point.parameters["a"] == pytest.approx(1.0, abs=1e-15)
    crossing = cw.switch_branch(problem, rest, point.name, range=(0.0, 2.0))
    assert crossing.outcome.reason == "bound"
    x, y = crossing.points["state"][np.abs(crossing.points["state"][:, 0]) > 0.1].T
    assert x.min() < -0.9
    assert x.max() > 0.9
    np.testing.assert_allclose(y, x, rtol=1e-14)
    a = crossing.points["free"][np.abs(crossing.points["state"][:, 0]) > 0.1, 0]
    # Its own equation gives a from x to rounding; what cancels in 0.03 - 0.3 c cos x is divided by x > 0.1.
    np.testing.assert_allclose(a, 1.0 + x**2 + 0.03 * (1.0 - np.cos(x)) / x, rtol=1e-13)
