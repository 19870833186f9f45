"""Units must not matter: parameters over sixteen decades, states of 1e-9 beside 1e9, stiff and undamped
systems.
"""

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw
from contwalk.system import State


def test_a_parameter_from_1e_minus_8_to_1e8():
    def field(t, x, p, dx):
        dx[0] = (p.lam - 1e-6) * x[0] - x[0] ** 3
        dx[1] = (p.lam - 1e6) * x[1] - x[1] ** 2

    problem = small_problem(field, "xy", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0], (1e-8, 1e8))
    check_branch(branch, problem)
    assert branch.outcome.reason == "bound"
    first, second = bifurcations(branch)
    assert (first.kind, second.kind) == ("pitchfork", "transcritical")
    assert_error_claim(first, "lam", mpmath.mpf(1e-6))
    assert_error_claim(second, "lam", mpmath.mpf(1e6))


def test_a_fold_at_a_tiny_parameter_of_a_wide_range():
    def field(t, x, p, dx):
        dx[0] = p.lam - 1e-5 - (x[0] - 2.0) ** 2

    problem = small_problem(field, "x", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [3.0], (1e-8, 1e2))
    check_branch(branch, problem)
    (fold,) = bifurcations(branch)
    assert fold.label == "LP"
    assert_error_claim(fold, "lam", mpmath.mpf(1e-5))


SMALL, LARGE = 1e-9, 1e9


def scaled_brusselator(t, x, p, dx):
    u, v = x[0] / SMALL, x[1] / LARGE
    dx[0] = SMALL * (p.A - (p.B + 1.0) * u + u * u * v)
    dx[1] = LARGE * (p.B * u - u * u * v)


@pytest.mark.parametrize("declared", [False, True])
def test_states_of_1e_minus_9_and_1e9(declared):
    scales = (SMALL, LARGE) if declared else (None, None)
    states = [State(name, scale=s) for name, s in zip("uv", scales, strict=True)]
    problem = small_problem(scaled_brusselator, states, {"A": 1.0, "B": 1.5}, "B")
    branch = cw.continue_branch(problem, [SMALL, 1.5 * LARGE], (1.0, 3.0))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert hopf.label == "HB"
    with mpmath.workdps(DIGITS):
        # u at the equilibrium is 1e-9 A as a float; the quotient by the same float is A: B = 1 + A^2 to
        # rounding.
        assert abs(hopf.parameters["B"] - 2.0) <= max(hopf.error, 4.0 * np.finfo(float).eps)
    assert hopf.criticality == "supercritical"
    assert hopf.coefficients["omega"] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("declared", [False, True])
def test_a_branch_of_1e_minus_9_leaves_a_trivial_one(declared):
    def field(t, x, p, dx):
        u, v = x[0] / SMALL, x[1] / LARGE
        dx[0] = SMALL * (p.mu * u - u**3)
        dx[1] = LARGE * (u * u - v)

    scales = (SMALL, LARGE) if declared else (None, None)
    states = [State(name, scale=s) for name, s in zip("uv", scales, strict=True)]
    problem = small_problem(field, states, {"mu": -1.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem, (SMALL, LARGE))
    (point,) = bifurcations(branch)
    assert (point.kind, point.criticality) == ("pitchfork", "supercritical")
    assert_error_claim(point, "mu", mpmath.mpf(0))
    other = cw.switch_branch(problem, branch, "BP1", (-1.0, 1.0))
    check_branch(other, problem, (SMALL, LARGE))
    assert other.outcome.reason == "bound"
    assert other["u"][[0, -1]] == pytest.approx([-SMALL, SMALL], rel=1e-12)
    assert other["v"][[0, -1]] == pytest.approx([LARGE, LARGE], rel=1e-12)


def test_stiffness_ratio_1e4_and_damping_1e_minus_6():
    """Two oscillators, k = 1 and 1e4; the first loses its damping of 1e-6 at nearly mu = 1e-6."""

    def field(t, x, p, dx):
        dx[0] = x[2]
        dx[1] = x[3]
        dx[2] = -x[0] - (p.c - p.mu) * x[2] - x[2] ** 3 + 0.1 * (x[1] - x[0])
        dx[3] = -1e4 * x[1] - p.c * x[3] + 0.1 * (x[0] - x[1])

    problem = small_problem(field, ["a", "b", "va", "vb"], {"mu": -1e-3, "c": 1e-6}, "mu")
    branch = cw.continue_branch(problem, [0.0] * 4, (-1e-3, 1e-3))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert_error_claim(hopf, "mu", _hopf_of_two_oscillators(1e-6))
    assert hopf.criticality == "supercritical"
    assert (hopf.unstable_before, hopf.unstable_after) == (0, 2)


def _hopf_of_two_oscillators(c):
    """mu at which l^4 + a3 l^3 + a2 l^2 + a1 l + a0 has the roots +- i w: a1^2 - a1 a2 a3 + a0 a3^2 = 0."""
    with mpmath.workdps(DIGITS):
        c, k = mpmath.mpf(c), mpmath.mpf(0.1)
        first, second = 1 + k, mpmath.mpf(1e4) + k

        def hurwitz(mu):
            d = c - mu
            a3, a2, a1, a0 = d + c, first + second + c * d, d * second + c * first, first * second - k * k
            return a1**2 - a1 * a2 * a3 + a0 * a3**2

        return mpmath.findroot(hurwitz, (c, c * (1 + mpmath.mpf("1e-9"))), tol=1e-60)


@pytest.mark.parametrize("ratio", [1e4, 1e8])
def test_a_fold_beside_a_stiff_direction(ratio):
    def field(t, x, p, dx):
        dx[0] = p.lam - x[0] ** 2 + 0.25 * (x[1] - x[0])
        dx[1] = -p.ratio * (x[1] - x[0])

    problem = small_problem(field, "xy", {"lam": 0.5, "ratio": ratio}, "lam")
    start = np.sqrt(0.5)
    branch = cw.continue_branch(problem, [start, start], (-1.0, 1.0))
    check_branch(branch, problem)
    (fold,) = bifurcations(branch)
    assert fold.label == "LP"
    assert_error_claim(fold, "lam", mpmath.mpf(0))
