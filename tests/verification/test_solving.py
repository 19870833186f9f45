"""Conditions beside equations that are not satisfied yet: both are, where Newton's method stops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import small_system

from contwalk.branch import BranchInfo
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.functions import Functions, Parameters
from contwalk.verification.passage import COARSER, TIGHT, passed, zero_between
from contwalk.verification.solving import Sheet, solved


class Parabola(Equations):
    """y = x^2 and u = x + y, with x free: a curve, and a place some 1e-5 off it."""

    unit = False

    def __init__(self) -> None:
        self.size, self.z, self.sizes = 2, np.array([0.09 + 3e-5, 0.39, 0.3]), np.ones(3)

    def at(self, z: np.ndarray, relative: float) -> Evaluation:
        y, u, x = z
        jacobian = np.array([[1.0, 0.0, -2.0 * x], [-1.0, 1.0, -1.0]])
        return Evaluation(z, np.array([y - x**2, u - x - y]), jacobian, np.zeros((0, 0)), relative)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.05), (0.0, 1.0, -1.61), (5.0, -3.0, 0.2)])
def test_a_condition_that_changes_on_the_way_onto_the_curve_is_solved_all_the_same(direction):
    equations = Parabola()

    def beside(at: Evaluation) -> float:
        return float(np.array(direction) @ (at.z - equations.z))

    found = solved(Sheet(equations, COARSER * TIGHT), [beside])
    y, u, x = found.at.z
    np.testing.assert_allclose([y, u], [x**2, x + x**2], rtol=1e-15)
    assert abs(beside(found.at)) < 1e-15  # a rounding of terms of some tenths


@pytest.mark.parametrize(("moved", "found"), [(0.0, 0.25), (0.3, 0.0), (-0.8, 1.0)])
def test_what_rounding_leaves_without_a_zero_is_nearest_to_it_at_an_end(moved: float, found: float):
    assert abs(zero_between(lambda t: t - 0.25 + moved, 0.0, 1.0) - found) < 2e-9


def stiff(t, x, p, dx):
    """Van der Pol's relaxation: on slow stretches deviations decay within a millionth of a period."""
    dx[0] = x[1]
    dx[1] = p.mu * (1.0 - x[0] ** 2) * x[1] - x[0]


def test_a_stiff_motion_is_followed_by_a_method_for_such():
    """Along its slow branch log(x) - x^2 / 2 grows by t / mu, but for some 1 / mu^2."""
    system = small_system(stiff, "xy", {"mu": 1e5})
    info = BranchInfo("b1", "periodic_orbit", ("x", "y"), (), ("mu",), {"mu": 1e5}, 3, 2)
    functions = Functions(system, Parameters(system, info))
    x = np.array([2.0, 2.0 / (1e5 * -3.0)])
    lasts, p, scale = 0.5 * 1e5, np.array([1e5]), np.array([2.0, 1.0])
    found = [passed(functions, "only", 0.0, x, lasts, p, scale, each).end for each in (1e-9, 1e-11)]
    assert abs(found[1][0] - found[0][0]) < 1e-8
    assert math.log(found[1][0]) - 0.5 * found[1][0] ** 2 == pytest.approx(
        math.log(2.0) - 2.0 + 0.5, abs=1e-8
    )
    assert functions.taken is not None
    assert functions.taken[0] < 10_000
