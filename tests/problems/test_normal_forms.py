"""Coefficients that are zero to their error have no sign."""

import pytest
from small_systems import labelled, small_problem

import contwalk as cw


def bautin(cubic, place):
    """r' = r (mu + cubic r^2 - r^4), phi' = 1.7 + r^2 about a place: l1 = 2 cubic / omega with |q| = 1."""

    def field(t, x, p, dx):
        u, v = x[0] - place[0], (x[1] - place[1]) / 3.0
        s = u * u + v * v
        growth, turn = p.mu + cubic * s - s * s, 1.7 + s
        dx[0] = growth * u - turn * v
        dx[1] = 3.0 * (turn * u + growth * v)

    return field


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
