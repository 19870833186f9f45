"""Pitchforks: both signs, criticality by the critical mode alone, and the branch that leaves."""

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, labelled, small_problem, small_system

import contwalk as cw
from contwalk.system import Neutral, State, Symmetry


@pytest.mark.drawn(3)
@pytest.mark.parametrize("cubic", [-1.0, 1.0, -250.0])
@pytest.mark.parametrize("extra", [None, -3.0, 2.0])
def test_both_signs_with_an_extra_direction(cubic, extra):
    def one(t, x, p, dx):
        dx[0] = (p.mu - 0.1) * x[0] + cubic * x[0] ** 3

    def two(t, x, p, dx):
        dx[0] = (p.mu - 0.1) * x[0] + cubic * x[0] ** 3
        dx[1] = extra * x[1] + x[0] * x[1]

    field, states = (one, "x") if extra is None else (two, "xy")
    problem = small_problem(field, states, {"mu": -0.6}, "mu")
    branch = cw.continue_branch(problem, [0.0] * len(states), (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert (point.label, point.kind) == ("BP", "pitchfork")
    assert_error_claim(point, "mu", mpmath.mpf(0.1))
    assert point.criticality == ("supercritical" if cubic < 0 else "subcritical")
    assert point.coefficients["c"] == pytest.approx(cubic, rel=1e-13)
    unstable = int(extra is not None and extra > 0)
    assert (point.unstable_before, point.unstable_after) == (unstable, unstable + 1)


def slaved(t, x, p, dx):
    """x' = mu x + x y, y' = -2 y + k x^2: on the centre manifold y = k x^2 / 2, so c = k / 2."""
    dx[0] = p.mu * x[0] + x[0] * x[1]
    dx[1] = -2.0 * x[1] + p.k * x[0] ** 2


@pytest.mark.parametrize("k", [-3.0, 1.0])
def test_the_coefficient_against_the_curvature_of_the_branch_that_leaves(k):
    problem = small_problem(slaved, "xy", {"mu": -0.5, "k": k}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert point.coefficients["c"] == pytest.approx(k / 2.0, rel=1e-13)
    other = cw.switch_branch(problem, branch, "BP1", (-1.0, 1.0))
    check_branch(other, problem)
    assert other.info.parent == ("b1", point.s)
    # mu = -c x^2 on it; here exactly, so the fit is good to the corrector's rounding.
    fit = np.polynomial.Polynomial.fit(other["x"], other["mu"], 2).convert().coef
    assert fit[2] == pytest.approx(-point.coefficients["c"], rel=1e-9)
    assert abs(fit[1]) < 1e-9
    # All of it, both halves, to the end of the range.
    assert np.sign(other["x"][0]) == -np.sign(other["x"][-1])
    reached = -np.sign(k)
    assert other["mu"][0] == other["mu"][-1] == reached
    assert (other["stable"][other["mu"] != 0.0] == 1).all() == (k < 0)


def test_the_branch_of_a_pitchfork_passes_its_branch_point_when_walked_from_afar():
    def field(t, x, p, dx):
        dx[0] = p.mu * x[0] - x[0] ** 3

    problem = small_problem(field, "x", {"mu": 0.81}, "mu")
    branch = cw.continue_branch(problem, [0.9], (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert (point.label, point.kind) == ("BP", "pitchfork")
    assert_error_claim(point, "mu", mpmath.mpf(0))
    # The parabola is stable on both sides of its branch point.
    assert (point.unstable_before, point.unstable_after) == (0, 0)
    assert branch["x"][0] == pytest.approx(-branch["x"][-1], rel=1e-12)
    trivial = cw.switch_branch(problem, branch, "BP1", (-1.0, 1.0))
    check_branch(trivial, problem)
    assert np.all(trivial["x"] == 0.0)
    assert (trivial["mu"][0], trivial["mu"][-1]) == (-1.0, 1.0)


def test_an_imperfect_pitchfork_is_a_fold_and_no_branch_point():
    def field(t, x, p, dx):
        dx[0] = p.h + p.mu * x[0] - x[0] ** 3

    problem = small_problem(field, "x", {"mu": 1.0, "h": 1e-4}, "mu")
    branch = cw.continue_branch(problem, [-0.95], (-1.0, 1.0))
    check_branch(branch, problem)
    (fold,) = bifurcations(branch)
    assert fold.label == "LP"
    with mpmath.workdps(DIGITS):
        assert_error_claim(fold, "mu", 3 * mpmath.cbrt(mpmath.mpf(1e-4) ** 2 / 4))
    connected = cw.continue_branch(problem, [1.0], (-1.0, 1.0))
    check_branch(connected, problem)
    assert bifurcations(connected) == []


def test_a_nearly_symmetric_crossing_is_transcritical():
    """x (mu + e x - x^2): for e = 1e-6 the branches still cross transversally, and a fold follows at mu =
    -e^2/4.
    """

    def field(t, x, p, dx):
        dx[0] = x[0] * (p.mu + 1e-6 * x[0] - x[0] ** 2)

    problem = small_problem(field, "x", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert (point.label, point.kind, point.criticality) == ("BP", "transcritical", None)


def test_two_pitchforks_on_one_branch():
    def field(t, x, p, dx):
        dx[0] = (p.mu - 0.2) * x[0] - x[0] ** 3
        dx[1] = (p.mu - 0.7) * x[1] + x[1] ** 3 + 0.5 * x[0] ** 2

    problem = small_problem(field, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    first, second = labelled(branch, "BP")
    assert_error_claim(first, "mu", mpmath.mpf(0.2))
    assert_error_claim(second, "mu", mpmath.mpf(0.7))
    assert (first.criticality, second.criticality) == ("supercritical", "subcritical")
    assert [first.unstable_after, second.unstable_after] == [1, 2]


def drifting(t, x, p, dx):
    """Four oscillators on a circle, of frequencies that sum up to zero: K. Kuramoto (1984), chapter 5."""
    for i, own in enumerate((-1.0, -0.2, 0.2, 1.0)):
        dx[i] = own + sum(p.K / 4.0 * np.sin(x[j] - x[i]) for j in range(4))


def together(t, x, p, v):
    v[:] = [1.0, 1.0, 1.0, 1.0]


def turned_over(t, x, p, image):
    image[:] = [-x[3], -x[2], -x[1], -x[0]]


def test_a_pitchfork_of_angles_of_which_one_is_pinned():
    """sin(x_i - psi) = w_i / q with q = K r: the outer two pass a right angle together where q = 1.

    One of them alone goes on beyond it there: their cosines cancel, and K = 2 q^2 / sqrt(q^2 - 0.04).
    """
    system = small_system(
        drifting,
        [State(f"a{i}", period=2.0 * np.pi) for i in range(4)],
        {"K": 3.0},
        neutral=(Neutral("together", together, pin="a0"),),
        symmetries=(Symmetry("over", "spatial", turned_over),),
    )
    problem = cw.Equilibrium(system, system.defaults(), "K")
    parent = cw.continue_branch(problem, [0.0, 0.4, 0.6, 1.0], (1.0, 5.0))
    (point,) = labelled(parent, "BP")
    # The image of what leaves is what leaves the other way, carried along by the pinned angle.
    assert point.kind == "symmetry-breaking"
    assert_error_claim(point, "K", 2 / mpmath.sqrt(mpmath.mpf("0.96")))
    branch = cw.switch_branch(problem, parent, "BP1", (1.0, 5.0))
    assert branch.outcome.reason == "bound"
    q = np.sqrt((branch["K"] ** 2 + branch["K"] * np.sqrt(branch["K"] ** 2 - 0.64)) / 8.0)
    # Equilibria are known to some roundings, and q turns at the pitchfork like their root there.
    assert np.abs(np.sin(0.5 * (branch["a2"] - branch["a1"])) - 0.2 / q).max() < 1e-7
    assert np.ptp(branch["a1"]) > 2.0
