"""Fields that bend: steps end where they do, so that multipliers and special points are those of the flow.

The same machines with modes and soft transitions pass the bends exactly; their points are given here.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import contwalk as cw
from contwalk.problems.orbit.lacking import Lacking
from contwalk.system import Mode, Parameter, State, System

ACCURACY = 1e-8


def circuit(t, x, p, dx):
    """Chua's circuit, its characteristic by absolute values."""
    bent = p.m1 * x[0] + 0.5 * (p.m0 - p.m1) * (abs(x[0] + 1.0) - abs(x[0] - 1.0))
    dx[0] = p.alpha * (x[1] - x[0] - bent)
    dx[1] = x[0] - x[1] + x[2]
    dx[2] = -p.beta * x[1]


CHUA = System(
    "chua_bent",
    states=(State("x"), State("y"), State("z")),
    parameters=(
        Parameter("alpha", 8.1),
        Parameter("beta", 14.28),
        Parameter("m0", -8.0 / 7.0),
        Parameter("m1", -5.0 / 7.0),
    ),
    modes=(Mode("only", circuit),),
)


def two_springs(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = 0.3 * math.cos(p.w * t) - 0.1 * x[1] - x[0] - 3.0 * max(x[0] - 1.0, 0.0)


BILINEAR = System(
    "bilinear_bent",
    states=(State("q"), State("v")),
    parameters=(Parameter("w", 1.1),),
    modes=(Mode("only", two_springs),),
    period=lambda p: 2.0 * math.pi / p.w,
)


def walked(system, free, start, span):
    asked = cw.Discretization(accuracy=ACCURACY)
    problem = cw.PeriodicOrbit(system, system.defaults(), free, discretization=asked)
    return cw.continue_branch(problem, start, span, until="settled")


@cache
def chua():
    return walked(CHUA, "alpha", [2.0, 0.1, -2.0], (8.05, 8.2))


@cache
def bilinear():
    return walked(BILINEAR, "w", [0.0, 0.0], (1.0, 1.25))


def test_a_doubling_is_found_where_it_is():
    branch = chua()
    (point,) = (p for p in branch.special_points if p.label != "EP")
    assert (point.label, point.status) == ("PD", "located")
    # By shooting with modes, to 1e-12 of itself: tests/peers/machines/chua.py.
    assert abs(point.parameters["alpha"] - 8.1729001058277) <= point.error + 1e-11
    assert point.error <= ACCURACY * 8.2
    assert branch.outcome.reason == "bound"


def test_its_criticality_is_not_told():
    branch = chua()
    (point,) = (p for p in branch.special_points if p.label == "PD")
    assert point.criticality is None
    assert "c" not in point.coefficients
    assert "slopes of the field jump" in point.note


def test_folds_are_found_where_they_are():
    """One of them is near the first touch, where the motion is slow at the bend."""
    branch = bilinear()
    folds = [p for p in branch.special_points if p.label != "EP"]
    assert [(p.label, p.status) for p in folds] == [("LP", "located"), ("LP", "located")]
    for point, known in zip(folds, (1.2070254733429877, 1.1297305167048513), strict=True):
        # Of soft transitions: known to 5e-11 themselves.
        assert abs(point.parameters["w"] - known) <= point.error + 5e-11
        assert point.error <= ACCURACY


def test_liouville():
    """The divergence is -0.1 whatever the bend does, so that multipliers have a known product."""
    branch = bilinear()
    products = np.prod(branch.points["spectrum"], axis=1)
    expected = np.exp(-0.1 * 2.0 * math.pi / branch["w"])
    # Steps of a walk are for 1e-6; the explicit pair is two digits better.
    np.testing.assert_allclose(products, expected, rtol=0, atol=1e-8)


class TestLacking:
    """A function whose derivatives are told without one of their terms."""

    def whole(self, y):
        x, a = y
        residual = np.array([x - a, x**2 + 3.0 * a - 1.0])
        return residual, np.array([[1.0, -1.0], [2.0 * x, 0.0]])  # 3 a lacks

    def test_the_last_step_tells_it(self):
        lacking = Lacking(1, np.ones(2))
        for y in (np.array([0.2, 0.2]), np.array([0.3, 0.3])):
            residual, jacobian = self.whole(y)
            told = lacking.added(y, residual, jacobian)
        way = np.array([1.0, 1.0])
        assert told[1] @ way == pytest.approx(2.0 * 0.3 + 3.0, rel=1e-12)
        assert np.array_equal(told[0], jacobian[0])

    def test_values_on_other_steps_are_not_compared(self):
        lacking = Lacking(1, np.ones(2))
        y = np.array([0.2, 0.2])
        lacking.added(y, *self.whole(y))
        lacking.on_other_steps()
        residual, jacobian = self.whole(y + 0.1)
        assert np.array_equal(lacking.added(y + 0.1, residual, jacobian), jacobian)

    def test_differences_along_a_direction_begin_it(self):
        lacking = Lacking(1, np.ones(2))
        y, way = np.array([0.2, 0.2]), np.array([1.0, 1.0])
        residual, jacobian = self.whole(y)
        lacking.along(way, np.array([2.0 * 0.2 + 3.0]), jacobian)
        assert lacking.added(y, residual, jacobian)[1] @ way == pytest.approx(3.4, rel=1e-12)
