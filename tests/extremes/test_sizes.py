"""The smallest and a larger system, slow oscillations, and eigenvalues that coincide."""

import math

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw


def test_one_state():
    def field(t, x, p, dx):
        dx[0] = p.lam - math.exp(x[0])

    problem = small_problem(field, "x", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [0.0], (0.1, 5.0))
    check_branch(branch, problem)
    assert bifurcations(branch) == []
    assert np.allclose(branch["x"], np.log(branch["lam"]), rtol=1e-14, atol=1e-14)
    assert branch.points["spectrum"].shape[1] == 1


N = 12


def chain(t, x, p, dx):
    """x_k' = mu x_k - x_k^3 + x_(k-1) - 2 x_k + x_(k+1), fixed ends: eigenvalues mu - 4 sin^2(k pi / 26)."""
    for k in range(N):
        left = x[k - 1] if k > 0 else 0.0
        right = x[k + 1] if k < N - 1 else 0.0
        dx[k] = p.mu * x[k] - x[k] ** 3 + left - 2.0 * x[k] + right


def test_a_chain_of_twelve():
    problem = small_problem(chain, [f"x{k}" for k in range(N)], {"mu": -0.1}, "mu")
    branch = cw.continue_branch(problem, [0.0] * N, (-0.2, 4.5))
    check_branch(branch, problem)
    found = bifurcations(branch)
    assert len(found) == N
    with mpmath.workdps(DIGITS):
        for k, point in enumerate(found, start=1):
            truth = 4 * mpmath.sin(k * mpmath.pi / (2 * (N + 1))) ** 2
            assert (point.kind, point.criticality) == ("pitchfork", "supercritical")
            assert_error_claim(point, "mu", truth)
    # c = -sum q_k^4 over |q| = 1: for the first mode -(3/8) 2 / (N + 1) ... = -3 / (2 (N + 1)).
    assert found[0].coefficients["c"] == pytest.approx(-1.5 / (N + 1), rel=1e-12)
    other = cw.switch_branch(problem, branch, "BP1", (-0.2, 0.5))
    check_branch(other, problem)
    assert (other["stable"][np.abs(other["s"]) > 0.0] == 1).all()


@pytest.mark.parametrize("omega", [1e-3, 1e-6, 1e-9])
def test_a_hopf_point_with_a_very_slow_oscillation(omega):
    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - p.omega * x[1] - x[0] * square
        dx[1] = p.omega * x[0] + p.mu * x[1] - x[1] * square

    problem = small_problem(field, "xy", {"mu": -0.7, "omega": omega}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert hopf.label == "HB"
    assert_error_claim(hopf, "mu", mpmath.mpf(0))
    assert hopf.coefficients["omega"] == pytest.approx(omega, rel=1e-12)
    assert hopf.coefficients["l1"] == pytest.approx(-2.0 / omega, rel=1e-9)


def test_a_slow_hopf_point_near_a_double_zero():
    """x'' = -e x + mu x' - x^2 x': the pair is mu / 2 +- i sqrt(e - mu^2 / 4), nearly defective at mu = 0."""
    e = 1e-8

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -e * x[0] + p.mu * x[1] - x[0] ** 2 * x[1]

    problem = small_problem(field, "xv", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-0.6, 0.8))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert (hopf.label, hopf.criticality) == ("HB", "supercritical")
    assert_error_claim(hopf, "mu", mpmath.mpf(0))
    assert hopf.coefficients["omega"] == pytest.approx(math.sqrt(e), rel=1e-12)


@pytest.mark.parametrize("coupling", [0.0, 1.0])
def test_double_eigenvalues_along_the_whole_branch(coupling):
    """A block [[a, c], [0, a]] with a = -1 - lambda^2, defective for c = 1; nothing happens on the branch."""

    def field(t, x, p, dx):
        a = -1.0 - p.lam**2
        dx[0] = a * x[0] + coupling * x[1]
        dx[1] = a * x[1]

    problem = small_problem(field, "xy", {"lam": 0.4}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    assert bifurcations(branch) == []
    assert (branch["stable"] == 1).all()


@pytest.mark.parametrize("at", [0.0, 0.3137])
def test_a_pair_that_becomes_two_real_eigenvalues_and_back(at):
    """Eigenvalues -1 +- sqrt(lambda - at): a defective point, where max_re has a kink and no bifurcation
    is.
    """

    def field(t, x, p, dx):
        dx[0] = -x[0] + x[1]
        dx[1] = (p.lam - at) * x[0] - x[1]

    problem = small_problem(field, "xy", {"lam": -0.5}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 0.9), marks={"max_re": ["extremum"]})
    check_branch(branch, problem)
    assert bifurcations(branch) == []
    assert (branch["stable"] == 1).all()


def test_a_real_pair_meets_while_unstable_and_leaves_as_a_complex_one():
    """Counts change by one at each branch point, never at the meeting of the two."""

    def field(t, x, p, dx):
        dx[0] = p.lam * x[0] + x[1] - x[0] ** 3
        dx[1] = -0.0625 * x[0] + p.lam * x[1]

    problem = small_problem(field, "xy", {"lam": -0.5}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert hopf.label == "HB"
    assert_error_claim(hopf, "lam", mpmath.mpf(0))
    assert hopf.coefficients["omega"] == pytest.approx(0.25, rel=1e-13)
