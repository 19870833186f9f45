"""Corrections by the derivatives at the last solution, where residuals are far cheaper than derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from made_up import MadeUp, circle, parabola

from contwalk.continuation.newton import correct
from contwalk.errors import PluginError
from contwalk.problems.problem import Linearization

ONES = np.ones(2)


class Cheap(MadeUp):
    """Its residual may be asked for without its derivatives, which are dear."""

    dear, meshed = True, object()

    def linearize(self, z: np.ndarray) -> Linearization:
        found = super().linearize(z)
        levels = found.levels
        known = Linearization(
            found.residual,
            found.jacobian,
            lambda: levels,
            nearby=lambda: lambda there: np.array(self.f(there), dtype=float),
        )
        known.dear = self.dear
        return known


def cheap(of: MadeUp) -> Cheap:
    return Cheap(of.f, of.df, of.eigenvalues)


@pytest.mark.parametrize("step", [1e-3, 0.03, 0.2])
def test_one_linearization_is_left_to_verify_the_solution(step):
    problem, beside = cheap(circle()), np.array([math.cos(1.0), math.sin(1.0)])
    tangent = np.array([-math.sin(1.0), math.cos(1.0)])
    guess = beside + step * tangent
    found = correct(problem, guess, tangent, ONES, beside=beside)
    assert found.ok
    assert problem.evaluated == 2  # at the solution beside, which the engine has at hand, and at this one
    assert abs(found.z @ found.z - 1.0) <= 1e-15
    assert abs(tangent @ (found.z - guess)) <= 4e-16
    assert found.linearization is not None
    assert found.linearization.excess <= 2.0
    assert 1 <= found.iterations <= 2


def test_derivatives_that_cost_little_are_not_spared():
    problem, beside = cheap(circle()), np.array([math.cos(1.0), math.sin(1.0)])
    problem.dear = False
    tangent = np.array([-math.sin(1.0), math.cos(1.0)])
    guess = beside + 0.2 * tangent
    found = correct(problem, guess, tangent, ONES, beside=beside)
    plain = correct(circle(), guess, tangent, ONES)
    assert problem.evaluated > 2  # Newton's method from the guess itself
    np.testing.assert_allclose(found.z, plain.z, rtol=0, atol=1e-15)


def test_a_solution_is_the_same_whatever_it_was_looked_for_from():
    guess, tangent = np.array([0.55, 0.8]), np.array([-0.8, 0.6])
    beside = np.array([math.cos(1.0), math.sin(1.0)])
    plain = correct(circle(), guess, tangent, ONES)
    found = correct(cheap(circle()), guess, tangent, ONES, beside=beside)
    np.testing.assert_allclose(found.z, plain.z, rtol=0, atol=1e-15)


def test_derivatives_that_do_not_lead_there_are_given_up():
    """Those of the other side of a fold lead away: Newton's method begins at the guess, as without them."""
    guess, normal = np.array([0.5, 0.3]), np.array([0.0, 1.0])
    plain = correct(cheap(parabola()), guess, normal, ONES)
    found = correct(cheap(parabola()), guess, normal, ONES, beside=np.array([-0.6, 0.36]))
    assert found.ok
    np.testing.assert_array_equal(found.z, plain.z)
    assert found.iterations == plain.iterations


def test_a_residual_without_a_value_on_the_way_is_given_up():
    def f(z):
        return [math.nan if 1.0 < z[0] < 1.02 else z[0] ** 2 - z[1]]

    problem = Cheap(f, lambda z: [[2.0 * z[0], -1.0]])
    found = correct(problem, np.array([1.01, 1.21]), np.array([0.0, 1.0]), ONES, beside=np.array([0.9, 0.81]))
    assert found.reason == "not_finite"
    found = correct(problem, np.array([1.03, 1.21]), np.array([0.0, 1.0]), ONES, beside=np.array([0.9, 0.81]))
    assert found.z == pytest.approx([1.1, 1.21], abs=1e-15)


def test_a_plugin_that_refuses_a_place_on_the_way_is_asked_no_further():
    """Derivatives beside a singular point lead anywhere, such as to a period that is negative."""

    def f(z):
        if z[0] < -1.0:
            raise PluginError("period(p) is negative.")
        return [z[0] ** 2 - z[1]]

    problem = Cheap(f, lambda z: [[2.0 * z[0], -1.0]])
    guess, normal = np.array([0.4, 0.3]), np.array([0.0, 1.0])
    found = correct(problem, guess, normal, ONES, beside=np.array([1e-6, 1e-12]))
    assert found.ok
    assert found.z == pytest.approx([math.sqrt(0.3), 0.3], abs=1e-15)


def test_exact_equations_are_not_linearized_at_the_last_solution():
    """Their derivatives cost as much as their residual: one linearization a correction was for nothing."""
    beside, tangent = np.array([math.cos(1.0), math.sin(1.0)]), np.array([-math.sin(1.0), math.cos(1.0)])
    counted = []
    for given in (beside, None):
        problem = circle()
        assert correct(problem, beside + 0.03 * tangent, tangent, ONES, beside=given).ok
        counted.append(problem.evaluated)
    assert counted[0] == counted[1]
