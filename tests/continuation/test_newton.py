"""The corrector on equations in closed form: where it ends, and why it says that it does not get there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from made_up import MadeUp, circle, parabola

from contwalk.continuation.newton import correct
from contwalk.errors import PluginError
from contwalk.problems.problem import Linearization

ONES = np.ones(2)


def along(problem, guess, normal, **rest):
    return correct(problem, np.array(guess, dtype=float), np.array(normal, dtype=float), ONES, **rest)


def test_the_solution_lies_on_the_curve_and_in_the_hyperplane():
    for angle in (0.3, 1.2, 2.5):
        guess = 1.1 * np.array([math.cos(angle), math.sin(angle)]) + [0.02, -0.01]
        normal = np.array([-math.sin(angle + 0.2), math.cos(angle + 0.2)])
        found = along(circle(), guess, normal)
        assert found.ok
        # Quadratic convergence ends at a few roundings of numbers near one.
        assert abs(found.z @ found.z - 1.0) <= 1e-15
        assert abs(normal @ (found.z - guess)) <= 4e-16


def test_a_fold_is_regular_where_the_hyperplane_crosses_the_branch():
    found = along(parabola(), [0.01, 0.02], [1.0, 0.0])
    assert found.ok
    assert found.z == pytest.approx([0.01, 1e-4], abs=1e-17)


def test_it_converges_quadratically():
    """From 0.1 away: 1e-2, 1e-4, 1e-8, 1e-16; one more may be asked whether it is rounding."""
    assert along(circle(), [1.1, 0.0], [0.0, 1.0]).iterations <= 5
    assert not along(circle(), [1.1, 0.0], [0.0, 1.0], iterations=1).ok


def test_a_hyperplane_that_misses_the_curve_has_no_solution():
    found = along(circle(), [0.0, 1.5], [0.0, 1.0])
    assert (found.reason, found.ok) == ("no_convergence", False)
    assert found.sentence.endswith(".")


def test_a_singular_bordered_jacobian_is_said():
    """Across the circle at lam = 1 the hyperplane touches it: no correction is determined."""
    found = along(circle(), [0.0, 1.2], [0.0, 1.0])
    assert found.reason == "no_convergence"
    assert found.sentence == "The bordered Jacobian is singular."


def test_nothing_is_computed_where_a_correction_runs_off():
    """At 1e-8 the slope of the parabola is 2e-8, so that its height of one seems to vanish 5e7 away."""
    visited = []
    problem = MadeUp(lambda z: [1.0 + z[0] ** 2 - z[1]], lambda z: [[2.0 * z[0], -1.0]])
    linearize = problem.linearize
    problem.linearize = lambda z: visited.append(float(z[0])) or linearize(z)
    found = along(problem, [1e-8, 0.0], [0.0, 1.0])
    assert (found.reason, found.sentence) == ("no_convergence", "Newton's method runs off.")
    assert set(visited) == {1e-8}


def test_what_is_not_finite_is_said_with_its_place():
    problem = MadeUp(lambda z: [math.nan if z[0] > 2.0 else z[0] - z[1]], lambda z: [[1.0, -1.0]])
    found = along(problem, [3.0, 0.0], [0.0, 1.0])
    assert found.reason == "not_finite"
    assert "the made-up equations" in found.sentence


def test_where_it_is_not_finite_is_looked_for_only_when_that_is_read(monkeypatch):
    """The search evaluates a plugin in Python; a walk takes a shorter step, and asks nothing."""
    asked = []
    problem = MadeUp(lambda z: [math.nan if z[0] > 2.0 else z[0] - z[1]], lambda z: [[1.0, -1.0]])
    monkeypatch.setattr(MadeUp, "explain", lambda self, z: asked.append(z) or "somewhere")
    found = along(problem, [3.0, 0.0], [0.0, 1.0])
    assert (found.reason, asked) == ("not_finite", [])
    assert found.sentence == "The equations have no finite value: somewhere."
    assert len(asked) == 1


def test_a_plugin_that_raises_is_said_in_its_words():
    def f(z):
        raise PluginError("The tank is empty.", "Fill it.")

    found = along(MadeUp(f, lambda z: [[1.0, 0.0]]), [0.0, 0.0], [0.0, 1.0])
    assert (found.reason, found.sentence) == ("plugin_error", "The tank is empty.")


def atan_branch():
    """lam = atan x: the Newton step from |x| > 1.39 at fixed lam = 0 goes farther out each time."""
    return MadeUp(lambda z: [math.atan(z[0]) - z[1]], lambda z: [[1.0 / (1.0 + z[0] ** 2), -1.0]])


@pytest.mark.parametrize("start", [2.0, 10.0, 300.0])
def test_only_damped_steps_come_back_from_far_away(start):
    plain = along(atan_branch(), [start, 0.0], [0.0, 1.0], iterations=60)
    assert plain.reason == "no_convergence"
    damped = along(atan_branch(), [start, 0.0], [0.0, 1.0], iterations=60, damped=True)
    assert damped.ok
    assert abs(damped.z[0]) <= 1e-15
    assert damped.z[1] == 0.0


def test_damping_does_not_look_at_residuals_whose_units_mean_nothing():
    """The two equations differ by 1e12 in their units; a residual norm would only see the second one."""
    problem = MadeUp(
        lambda z: [math.atan(z[0]), 1e12 * (z[1] - z[0] ** 2)],
        lambda z: [[1.0 / (1.0 + z[0] ** 2), 0.0, 0.0], [-2e12 * z[0], 1e12, 0.0]],
    )
    found = correct(
        problem, np.array([5.0, 3.0, 0.5]), np.array([0.0, 0.0, 1.0]), np.ones(3), 60, damped=True
    )
    assert found.ok
    assert found.z == pytest.approx([0.0, 0.0, 0.5], abs=1e-15)


def test_dust_is_swept_away_but_not_a_small_parameter():
    problem = MadeUp(lambda z: [z[0] * (1.0 + z[1])], lambda z: [[1.0 + z[1], z[0]]])
    found = along(problem, [3e-20, 2e-25], [0.0, 1.0])
    assert found.ok
    assert found.z.tolist() == [0.0, 2e-25]


def test_what_shrinks_to_dust_on_the_way_is_exactly_zero():
    """x + x^3 = 0 from 0.5: convergence ends far below any rounding of what x could be, and not at zero."""
    problem = MadeUp(lambda z: [z[0] + z[0] ** 3], lambda z: [[1.0 + 3.0 * z[0] ** 2, 0.0]])
    assert along(problem, [0.5, 1.0], [0.0, 1.0]).z.tolist() == [0.0, 1.0]


def test_an_unknown_is_small_against_its_own_weight_only():
    """With a weight of 1e-20 an unknown of 3e-20 is no dust."""
    problem = MadeUp(lambda z: [1e20 * z[0] - 3.0], lambda z: [[1e20, 0.0]])
    found = correct(problem, np.array([2.9e-20, 0.0]), np.array([0.0, 1.0]), np.array([1e-20, 1.0]))
    assert found.ok
    assert found.z[0] == pytest.approx(3e-20, rel=1e-15)


def test_a_residual_that_stays_above_its_rounding_is_no_solution():
    """The derivative is right, but the equation has no zero: x^2 + 1e-6 on lam = 0."""
    problem = MadeUp(lambda z: [z[0] ** 2 + 1e-6], lambda z: [[2.0 * z[0], 0.0]])
    for start in (1.0, 1e-3, 1e-5):
        assert not along(problem, [start, 0.0], [0.0, 1.0], iterations=40).ok


def test_a_double_root_is_reached_to_its_rounding():
    """x^2 = 0 halves its error at each step; what counts is that the residual is rounding at last."""
    problem = MadeUp(lambda z: [z[0] ** 2], lambda z: [[2.0 * z[0], 0.0]])
    found = along(problem, [1e-7, 0.0], [0.0, 1.0])
    assert found.ok
    assert found.z[0] ** 2 <= 1e-14


def test_cheap_residuals_save_jacobians():
    """With `nearby` corrections follow by the same Jacobian; the solution is the same."""

    class Cheap(MadeUp):
        def linearize(self, z):
            plain = super().linearize(z)
            return Linearization(
                plain.residual,
                plain.jacobian,
                lambda: plain.levels,
                nearby=lambda: lambda y: np.array(self.f(y), dtype=float),
            )

    cheap = Cheap(circle().f, circle().df)
    found = along(cheap, [1.004, 0.0], [0.0, 1.0])
    usual = circle()
    same = along(usual, [1.004, 0.0], [0.0, 1.0])
    assert found.ok
    assert found.z == pytest.approx(same.z, abs=4e-16)
    assert cheap.evaluated < usual.evaluated
