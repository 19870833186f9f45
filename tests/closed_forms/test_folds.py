"""Folds with parameter values in closed form: the cusp, a parabola, a circle of equilibria."""

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, labelled, small_problem

import contwalk as cw


def cusp(t, x, p, dx):
    dx[0] = p.a + p.b * x[0] - x[0] ** 3


@pytest.mark.parametrize("b", [1.0, 0.3, 1e-3])
def test_the_cusp_has_folds_at_27_a2_equal_4_b3(b):
    problem = small_problem(cusp, "x", {"a": -2.0, "b": b}, "a")
    start = -(2.0 ** (1 / 3))
    branch = cw.continue_branch(problem, [start], (-2.0, 2.0))
    check_branch(branch, problem)
    first, second = bifurcations(branch)
    assert (first.label, second.label) == ("LP", "LP")
    with mpmath.workdps(DIGITS):
        fold = mpmath.sqrt(4 * mpmath.mpf(b) ** 3 / 27)
        assert_error_claim(first, "a", fold)
        assert_error_claim(second, "a", -fold)
        state = mpmath.sqrt(mpmath.mpf(b) / 3)
        # Every unknown is refined beyond floats, then rounded once.
        assert first.state["x"] == float(-state)
        assert second.state["x"] == float(state)
    assert [(p.unstable_before, p.unstable_after) for p in (first, second)] == [(0, 1), (1, 0)]


def test_below_the_cusp_there_is_no_fold():
    problem = small_problem(cusp, "x", {"a": -2.0, "b": -1e-3}, "a")
    branch = cw.continue_branch(problem, [-1.2], (-2.0, 2.0))
    check_branch(branch, problem)
    assert bifurcations(branch) == []
    assert branch.outcome.reason == "bound"


def test_the_same_folds_along_the_other_parameter():
    problem = small_problem(cusp, "x", {"a": 0.25, "b": 2.0}, "b")
    branch = cw.continue_branch(problem, [-1.3], (-1.0, 2.0))
    check_branch(branch, problem)
    (fold,) = bifurcations(branch)
    with mpmath.workdps(DIGITS):
        assert_error_claim(fold, "b", mpmath.cbrt(27 * mpmath.mpf("0.0625") / 4))


def parabola(t, x, p, dx):
    """lambda = k x^2 - 1/2 + x^3 / 7; two stable directions besides, one of them driven by the first."""
    dx[0] = p.lam + 0.5 - p.k * x[0] ** 2 - x[0] ** 3 / 7.0
    dx[1] = -2.0 * x[1] + x[0]
    dx[2] = -3.0 * x[2]


@pytest.mark.parametrize("k", [2.0, -0.5])
def test_sign_and_size_of_the_fold_coefficients_follow_the_curvature(k):
    problem = small_problem(parabola, "xyz", {"lam": -0.4 if k > 0 else -0.6, "k": k}, "lam")
    start = 0.25 if k > 0 else -0.4
    branch = cw.continue_branch(problem, [start, start / 2, 0.0], (-1.0, -0.3), max_step=0.03)
    check_branch(branch, problem)
    fold = next(q for q in bifurcations(branch) if abs(q.state["x"]) < 1e-6)
    assert_error_claim(fold, "lam", mpmath.mpf("-0.5"))
    a, b = fold.coefficients["a"], fold.coefficients["b"]
    # y' = b mu + a y^2: solutions at mu = -(a / b) y^2 where y = p.x is the first state over its share of q.
    q = np.array([1.0, 0.5, 0.0]) / np.hypot(1.0, 0.5)
    curvature = k * q[0] ** 2  # lambda + 1/2 = k x^2, x = q_1 y
    assert -a / b == pytest.approx(curvature, rel=1e-12)  # exact derivatives: rounding only
    assert np.sign(-a / b) == np.sign(k)
    # And from the branch itself, a parabola through its points next to the fold.
    near = np.abs(branch["x"]) < 0.1
    fitted = np.polynomial.Polynomial.fit(branch["x"][near] / q[0], branch["lam"][near], 4).convert().coef[2]
    assert fitted == pytest.approx(
        curvature, rel=1e-3
    )  # the cubic term and the fit's sixth order are below that


def circle(t, x, p, dx):
    dx[0] = x[0] ** 2 + p.lam**2 - 1.0


def test_what_lies_right_behind_the_start_of_a_closed_branch_is_told_once():
    """Its last step ends beyond the start: both sides of the circle have the mark, each once."""
    branch = cw.continue_branch(
        small_problem(circle, "x", {"lam": 0.6}, "lam"), [0.8], (-2.0, 2.0), marks={"lam": [0.6001]}
    )
    assert branch.outcome.reason == "closed"
    assert [p.label for p in branch.special_points] == ["UZ", "LP", "UZ", "LP", "EP"]


def test_a_circle_of_equilibria_is_closed_with_two_folds():
    problem = small_problem(circle, "x", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [1.0], (-2.0, 2.0))
    check_branch(branch, problem)
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "closed")
    folds = labelled(branch, "LP")
    assert len(folds) == len(bifurcations(branch)) == 2
    assert {round(q.parameters["lam"]) for q in folds} == {-1, 1}
    for fold in folds:
        assert_error_claim(fold, "lam", mpmath.mpf(round(fold.parameters["lam"])))
    # The whole circle is covered: no gap wider than a few steps.
    angles = np.sort(np.arctan2(branch["x"], branch["lam"]))
    assert np.max(np.diff(angles)) < 0.5
    assert (
        np.max(np.abs(branch["x"] ** 2 + branch["lam"] ** 2 - 1.0)) < 1e-12
    )  # the corrector ends at rounding


def roessler(t, x, p, dx):
    dx[0] = -x[1] - x[2]
    dx[1] = x[0] + p.a * x[1]
    dx[2] = 0.2 + x[2] * (x[0] - p.c)


@pytest.mark.slow
def test_a_pair_that_passes_right_at_a_fold_is_told_beside_it() -> None:
    """Roessler's equilibria fold at c^2 = 4 a b, where their trace is a - c / 2: with a = b both at once.

    There the eigenvalues are 0 and +-i omega, omega^2 = 2 - a^2; the line through a zero-Hopf point has both.
    """
    problem = small_problem(roessler, ["x", "y", "z"], {"c": 2.0, "a": 0.2}, "c")
    branch = cw.continue_branch(problem, [0.02, -0.1, 0.1], range=(0.1, 2.5))
    points = [p for p in branch.special_points if p.label != "EP"]
    assert sorted(p.label for p in points) == ["HB", "LP"]
    for point in points:
        assert point.status == "located"
        assert abs(point.parameters["c"] - 0.4) <= point.error < 1e-15
    hopf = next(p for p in points if p.label == "HB")
    assert hopf.criticality is None
    assert "no first Lyapunov coefficient" in hopf.note
    assert hopf.coefficients["omega"] == pytest.approx(1.4, rel=1e-14)
    counts = [(p.unstable_before, p.unstable_after) for p in points]
    assert counts[0][1] == counts[1][0]
    assert {abs(after - before) for before, after in counts} == {1, 2}
    for label in ("HB", "LP"):  # whose curves have the zero-Hopf point that they begin at
        curve = cw.continue_locus(problem.system, branch, f"{label}1", {"c": (0.1, 2.0), "a": (0.1, 0.4)})
        (point,) = [p for p in curve.special_points if p.label == "ZH"]
        assert abs(point.parameters["a"] - 0.2) <= point.errors["a"] + 2.0**-54
