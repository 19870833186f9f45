"""Special points that nearly coincide, and folds much sharper than a step."""

import math

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, labelled, small_problem

import contwalk as cw


@pytest.mark.drawn(1)
@pytest.mark.parametrize("e", [1e-3, 1e-5, 1e-7])
def test_a_fold_so_sharp_that_the_step_shrinks_by_many_decades(e):
    """x^2 + e^2 = lambda^2 turns within e of lambda = 0; the first step is 0.02."""
    square = e * e

    def field(t, x, p, dx):
        dx[0] = x[0] ** 2 + square - p.lam**2

    problem = small_problem(field, "x", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [math.sqrt(1.0 - square)], (-1.0, 1.0))
    check_branch(branch, problem)
    (fold,) = bifurcations(branch)
    assert fold.label == "LP"
    with mpmath.workdps(DIGITS):
        assert_error_claim(fold, "lam", mpmath.sqrt(mpmath.mpf(square)))
    assert branch["lam"][0] == branch["lam"][-1] == 1.0
    if e <= 1e-5:
        assert branch["step"].min() < 1e-4 * branch["step"].max()


def _pair_of_hopf_points(apart, bent):
    half = 0.5 * apart

    def field(t, x, p, dx):
        if bent:
            rate = (math.sin(p.mu - 0.3) ** 2 - half**2) * math.exp(p.mu)
        else:
            rate = (p.mu - 0.3) ** 2 - half**2
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = rate * x[0] - x[1] - square * x[0]
        dx[1] = x[0] + rate * x[1] - square * x[1]

    return small_problem(field, "xy", {"mu": -1.0}, "mu")


@pytest.mark.drawn(1)
@pytest.mark.parametrize("apart", [1e-2, 1e-5, 1e-7])
@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("start", [-1.0, -0.9123])
def test_two_hopf_points_within_one_step(apart, bent, start):
    problem = _pair_of_hopf_points(apart, bent)
    problem = cw.Equilibrium(problem.system, {"mu": start}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    first, second = bifurcations(branch)
    assert (first.label, second.label) == ("HB", "HB")
    with mpmath.workdps(DIGITS):
        half = 0.5 * mpmath.mpf(apart)
        offset = mpmath.asin(half) if bent else half
        # The field's own half^2 is a float; its square root is half to 1e-16 of it.
        slack = 1e-15 * apart
        assert abs(mpmath.mpf(first.parameters["mu"]) - (mpmath.mpf(0.3) - offset)) <= first.error + slack
        assert abs(mpmath.mpf(second.parameters["mu"]) - (mpmath.mpf(0.3) + offset)) <= second.error + slack
    assert [(q.unstable_before, q.unstable_after) for q in (first, second)] == [(2, 0), (0, 2)]


def test_hopf_points_that_have_just_merged_are_not_reported():
    """(mu - 0.3)^2 + 1e-10 never vanishes."""

    def field(t, x, p, dx):
        rate = (p.mu - 0.3) ** 2 + 1e-10
        dx[0] = rate * x[0] - x[1]
        dx[1] = x[0] + rate * x[1]

    problem = small_problem(field, "xy", {"mu": -1.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    assert bifurcations(branch) == []


@pytest.mark.drawn(1)
@pytest.mark.parametrize("apart", [1e-2, 1e-5])
def test_two_folds_close_together(apart):
    """lambda = x^3 - 3 d^2 x turns at x = +-d; the parameters differ by 4 d^3."""
    d = apart

    def field(t, x, p, dx):
        dx[0] = p.lam - x[0] ** 3 + 3.0 * d * d * x[0]

    problem = small_problem(field, "x", {"lam": -1.0}, "lam")
    branch = cw.continue_branch(problem, [-1.0], (-1.0, 1.0))
    check_branch(branch, problem)
    folds = bifurcations(branch)
    assert [q.label for q in folds] == ["LP", "LP"]
    with mpmath.workdps(DIGITS):
        slope = mpmath.mpf(3.0 * d * d)
        for fold, side in zip(sorted(folds, key=lambda q: q.state["x"]), (1, -1), strict=True):
            assert_error_claim(fold, "lam", side * 2 * mpmath.sqrt(slope / 3) ** 3)


def test_two_folds_whose_parameters_are_1e_minus_5_apart():
    d = (1e-5 / 4.0) ** (1.0 / 3.0)

    def field(t, x, p, dx):
        dx[0] = p.lam - x[0] ** 3 + 3.0 * d * d * x[0]
        dx[1] = -x[1] + p.lam

    problem = small_problem(field, "xy", {"lam": -1.0}, "lam")
    branch = cw.continue_branch(problem, [-1.0, -1.0], (-1.0, 1.0))
    check_branch(branch, problem)
    first, second = bifurcations(branch)
    assert first.parameters["lam"] - second.parameters["lam"] == pytest.approx(1e-5, rel=1e-9)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("apart", [1e-5, 1e-7])
@pytest.mark.parametrize("same_state", [False, True])
def test_two_branch_points_close_together(apart, same_state):
    def different(t, x, p, dx):
        dx[0] = p.mu * x[0] - x[0] ** 3
        dx[1] = (p.mu - apart) * x[1] - x[1] ** 3

    def same(t, x, p, dx):
        dx[0] = p.mu * (p.mu - apart) * x[0] - x[0] ** 3

    field, states = (same, "x") if same_state else (different, "xy")
    problem = small_problem(field, states, {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0] * len(states), (-1.0, 1.0))
    check_branch(branch, problem)
    first, second = bifurcations(branch)
    assert (first.kind, second.kind) == ("pitchfork", "pitchfork")
    assert_error_claim(first, "mu", mpmath.mpf(0))
    assert_error_claim(second, "mu", mpmath.mpf(apart))


@pytest.mark.drawn(1)
@pytest.mark.parametrize("distance", [1e-3, 1e-6])
def test_a_branch_point_next_to_a_fold_is_found_on_both_branches(distance):
    """x (mu - x^2 + 2 e x): branch point at 0 and, on the curved branch, a fold at mu = -e^2."""
    e = math.sqrt(distance)

    def field(t, x, p, dx):
        dx[0] = x[0] * (p.mu - x[0] ** 2 + 2.0 * e * x[0])

    problem = small_problem(field, "x", {"mu": 1.0}, "mu")
    curved = cw.continue_branch(problem, [e + math.sqrt(1.0 + e * e)], (-1.0, 1.0))
    check_branch(curved, problem)
    assert sorted(q.label for q in bifurcations(curved)) == ["BP", "LP"]
    (point,), (fold,) = labelled(curved, "BP"), labelled(curved, "LP")
    with mpmath.workdps(DIGITS):
        assert_error_claim(fold, "mu", -(mpmath.mpf(e) ** 2))
    trivial = cw.switch_branch(problem, curved, "BP1", (-1.0, 1.0))
    check_branch(trivial, problem)
    assert np.all(np.abs(trivial["x"]) < 1e-14)
    below = cw.Equilibrium(problem.system, {"mu": -1.0}, "mu")
    straight = cw.continue_branch(below, [0.0], (-1.0, 1.0))
    check_branch(straight, below)
    (other,) = bifurcations(straight)
    for found in (point, other):
        assert found.kind == "transcritical"
        assert_error_claim(found, "mu", mpmath.mpf(0))
    again = cw.switch_branch(below, straight, "BP1", (-1.0, 1.0))
    check_branch(again, below)
    (same_fold,) = labelled(again, "LP")
    assert same_fold.parameters["mu"] == fold.parameters["mu"]
