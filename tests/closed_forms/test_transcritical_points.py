"""Transcritical points: tangents, exchange of stability, and all four half-branches in one diagram."""

import mpmath
import numpy as np
import pytest
from claimed_errors import assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw
from contwalk.problems.equilibrium.second_direction import tangent_through


def crossing(t, x, p, dx):
    """Branches x = 0 and mu = 1/4 + x + x^2; another direction follows the first."""
    dx[0] = x[0] * (p.mu - 0.25 - x[0] - x[0] ** 2)
    dx[1] = -x[1] + 2.0 * x[0]


def test_exchange_of_stability():
    problem = small_problem(crossing, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert (point.label, point.kind, point.criticality) == ("BP", "transcritical", None)
    assert_error_claim(point, "mu", mpmath.mpf("0.25"))
    assert (point.unstable_before, point.unstable_after) == (0, 1)


def test_the_tangents_of_both_branches():
    """Directions s q + t h with c11 s^2 + 2 c12 s t + c22 t^2 = 0 are those of the branches."""
    problem = small_problem(crossing, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    (point,) = bifurcations(branch)
    c = point.coefficients
    q = np.array([1.0, 2.0]) / np.sqrt(5.0)
    # x = 0 is t = 1, s = 0 (h = 0); the other has dx/dmu = 1, so s = sqrt(5) for t = 1.
    assert abs(c["c22"]) < 1e-14
    s = -2.0 * c["c12"] / c["c11"]
    assert s * q == pytest.approx([1.0, 2.0], rel=1e-12)
    other = cw.switch_branch(problem, branch, point, (-1.0, 1.0))
    check_branch(other, problem)
    start = int(np.flatnonzero(other["s"] == 0.0)[0])
    tangent = other.points["tangent"][start]
    assert tangent[:2] / tangent[2] == pytest.approx([1.0, 2.0], rel=1e-12)
    assert point.tangent[0] == point.tangent[1] == 0.0


def test_the_other_branch_is_followed_through_its_own_fold():
    problem = small_problem(crossing, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    other = cw.switch_branch(problem, branch, "BP1", (-1.0, 1.0))
    check_branch(other, problem)
    (fold,) = bifurcations(other)
    assert fold.label == "LP"
    assert_error_claim(fold, "mu", mpmath.mpf(0))
    assert other["mu"][0] == other["mu"][-1] == 1.0
    assert (
        np.max(np.abs(other["mu"] - 0.25 - other["x"] - other["x"] ** 2)) < 1e-13
    )  # rounding of terms of size one


@pytest.mark.parametrize("start", [[0.0], [-0.6]])
def test_all_four_half_branches_from_either_branch(start):
    """x (mu - x) = 0: lines x = 0 and x = mu; whichever is walked first, the other one is reached by
    switching.
    """

    def field(t, x, p, dx):
        dx[0] = x[0] * (p.mu - x[0])

    problem = small_problem(field, "x", {"mu": -0.6}, "mu")
    branch = cw.continue_branch(problem, start, (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert_error_claim(point, "mu", mpmath.mpf(0))
    other = cw.switch_branch(problem, branch, "BP1", (-1.0, 1.0))
    check_branch(other, problem)
    ends = {(round(b["x"][i], 12), b["mu"][i]) for b in (branch, other) for i in (0, -1)}
    assert ends == {(0.0, -1.0), (0.0, 1.0), (-1.0, -1.0), (1.0, 1.0)}
    # Stable: x = 0 below, x = mu above.
    for line in (branch, other):
        away = np.abs(line["mu"]) > 1e-9
        zero = np.abs(line["x"]) < 1e-12
        assert np.array_equal(line["stable"][away], (zero == (line["mu"] < 0))[away])


def test_an_isolated_point_of_equilibria_has_no_branches():
    """A fold point is not a branch point: switching there is refused with a sentence."""

    def field(t, x, p, dx):
        dx[0] = p.mu - x[0] ** 2

    problem = small_problem(field, "x", {"mu": 0.5}, "mu")
    branch = cw.continue_branch(problem, [0.7], (-1.0, 1.0))
    check_branch(branch, problem)
    with pytest.raises(cw.ContwalkError, match="No other branch leaves LP1"):
        cw.switch_branch(problem, branch, "LP1", (-1.0, 1.0))


def meeting_at_zero(t, x, p, dx):
    """At rest det F_u = 0.63 mu (0.74 - mu) - 0.6528 mu, which is zero at mu = 0 and mu = -0.1866 / 0.63."""
    dx[0] = (p.mu - 0.74) * x[0] + 0.51 * x[1] - 0.1386 * x[0] * x[1] - 0.6 * x[0] ** 3
    dx[1] = p.mu * (1.28 * x[0] - 0.63 * x[1]) - 0.93 * x[0] * x[1] ** 2 - 0.66 * x[1] ** 2 - 1.11 * x[1] ** 3


def test_the_tangent_at_zero_is_that_of_zero_to_a_rounding():
    """Where a located point is 1e-50 beside zero, a row of F_u is as small, and is none."""
    problem, weights = small_problem(meeting_at_zero, "xy", {"mu": 0.0}, "mu"), np.array([0.04, 0.08, 0.03])
    # With x = 0.51 y / 0.74 the second equation is mu (0.6528 / 0.74 - 0.63) y = 0.66 y^2.
    y = (0.6528 / 0.74 - 0.63) / 0.66
    known = np.array([0.51 / 0.74 * y, y, 1.0])
    for z in (np.zeros(3), np.array([1e-50, 1e-50, 1.7e-49])):
        tangent = tangent_through(problem, z, weights, known + 0.01)
        assert tangent / tangent[2] == pytest.approx(known, rel=1e-12)
