"""Coefficients that are zero to their error have no sign."""

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

import contwalk as cw
from contwalk.problems.orbit.normal_forms import units
from contwalk.system import State


def bautin(cubic, place):
    """r' = r (mu + cubic r^2 - r^4), phi' = 1.7 + r^2 about a place: l1 = 2 cubic / omega with |q| = 1."""

    def field(t, x, p, dx):
        u, v = x[0] - place[0], (x[1] - place[1]) / 3.0
        s = u * u + v * v
        growth, turn = p.mu + cubic * s - s * s, 1.7 + s
        dx[0] = growth * u - turn * v
        dx[1] = 3.0 * (turn * u + growth * v)

    return field


@pytest.mark.drawn(2)
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.3, -0.7), (1e-17, 12.1)])
@pytest.mark.parametrize(
    ("cubic", "expected"),
    [(0.0, None), (1e-6, "subcritical"), (-1e-6, "supercritical"), (-1.0, "supercritical")],
)
def test_a_lyapunov_coefficient_that_is_zero_to_its_error_has_no_criticality(cubic, expected, place):
    problem = small_problem(bautin(cubic, place), "xy", {"mu": -0.3}, "mu")
    branch = cw.continue_branch(problem, list(place), (-0.5, 0.5))
    (point,) = labelled(branch, "HB")
    assert point.criticality == expected
    assert ("degenerate" in (point.note or "")) == (expected is None)
    # |q|^2 = |q_u|^2 + 9 |q_v|^2 = 1 with |q_u| = |q_v|: a radius r is |z| = r / 2 / sqrt(10), and so
    truth = 2.0 * cubic * 2.0 / 10.0 / 1.7
    assert abs(point.coefficients["l1"] - truth) <= 10.0 * point.coefficients["l1_error"] + 1e-14 * abs(truth)
    assert point.coefficients["l1_error"] < 1e-12


def quintic(cubic, place):
    """u' = u (mu + cubic u^2 - u^4) about a place, with a second state that follows: c = cubic |q_u|^2."""

    def field(t, x, p, dx):
        u, v = x[0] - place, x[1] - 0.5 * x[0]
        dx[0] = u * (p.mu + cubic * u * u - u**4)
        dx[1] = 0.5 * dx[0] - 2.0 * v

    return field


@pytest.mark.drawn(2)
@pytest.mark.parametrize("place", [0.0, 0.3, 12.1])
@pytest.mark.parametrize(
    ("cubic", "expected"),
    [(0.0, None), (1e-6, "subcritical"), (-1e-6, "supercritical"), (-1.0, "supercritical")],
)
def test_a_cubic_coefficient_that_is_zero_to_its_error_has_no_criticality(cubic, expected, place):
    problem = small_problem(quintic(cubic, place), "xy", {"mu": -0.3}, "mu")
    branch = cw.continue_branch(problem, [place, 0.5 * place], (-0.5, 0.5))
    (point,) = labelled(branch, "BP")
    assert (point.kind, point.criticality) == ("pitchfork", expected)
    assert (point.note is not None) == (expected is None)
    # |q| = 1 with q along (1, 1/2).
    c, truth = point.coefficients, cubic * 4.0 / 5.0
    assert abs(c["c"] - truth) <= 10.0 * c["c_error"] + 1e-14 * abs(truth)
    assert c["c_error"] < 1e-12


def test_deviations_are_measured_in_what_moves_where_a_state_is_at_rest_and_tells_no_size():
    """Of machines with modes too: a state that one mode does not have has no range over the orbit."""
    states = ["x", "y", State("z", scale=4.0), "w"]
    system = small_system(lambda t, x, p, dx: None, states, {})
    motion = np.array([[1.0, 0.0, 0.0, np.nan], [5.0, 0.0, 0.0, 7.0]])
    magnitudes = np.array([5.0, 1e-9, 4.0, 7.0])
    assert units(system, motion, magnitudes).tolist() == [2.0, 2.0, 4.0, 7.0]


def beside_a_double_zero(t, x, p, dx):
    """A fold at x = 0 and, for b2 > 0, a Hopf point at x = -b2 (Bogdanov and Takens)."""
    dx[0] = x[1]
    dx[1] = p.b1 + p.b2 * x[1] + x[0] ** 2 + x[0] * x[1]


@pytest.mark.drawn(2)
@pytest.mark.parametrize("apart", [1e-3, 1e-7, 1e-9, 0.0])
def test_a_hopf_point_beside_a_fold_is_found_or_said_to_be_hidden(apart):
    problem = small_problem(beside_a_double_zero, "xy", {"b1": -0.3, "b2": apart}, "b1")
    branch = cw.continue_branch(problem, [-np.sqrt(0.3), 0.0], (-0.5, 0.2))
    (fold,) = labelled(branch, "LP")
    found = [point.state["x"] for point in labelled(branch, "HB")]
    hidden = "a Hopf point this near to the fold is not told apart" in (fold.note or "")
    assert found == ([] if hidden else [pytest.approx(-apart, rel=1e-9)])
    assert hidden if apart == 0.0 else not (hidden and apart > 1e-8)
