"""Families of equilibria: declared and pinned, declared and free, not declared at all."""

import math

import numpy as np
import pytest
from invariants import check_branch
from small_systems import bifurcations, small_problem

import contwalk as cw
from contwalk.errors import StartError
from contwalk.system import Neutral


def along_y(t, x, p, v):
    v[0] = 0.0
    v[1] = 1.0


def shelf(t, x, p, dx):
    """Equilibria (mu, y) for every y."""
    dx[0] = -x[0] + p.mu
    dx[1] = 0.0 * x[1]


def test_a_family_is_held_at_the_value_of_a_parameter():
    neutral = Neutral("family", along_y, pin="y", value="place")
    problem = small_problem(shelf, "xy", {"mu": 0.0, "place": 0.75}, "mu", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.0, 0.2], (-1.0, 1.0))
    check_branch(branch, problem)
    assert branch.outcome.reason == "bound"
    assert np.allclose(branch["y"], 0.75, rtol=4e-16, atol=0.0)
    assert branch.points["spectrum"].shape[1] == 1
    assert np.allclose(branch["max_re"], -1.0, rtol=1e-14)
    assert (branch["stable"] == 1).all()
    assert np.max(np.abs(branch.points["unknowns"][:, 2])) < 1e-14  # no drift


def test_a_family_can_be_followed_along_itself():
    """The parameter that says where the family is held may be the free one."""
    neutral = Neutral("family", along_y, pin="y", value="place")
    problem = small_problem(shelf, "xy", {"mu": 0.5, "place": 0.0}, "place", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.5, 0.0], (-1.0, 1.0))
    check_branch(branch, problem)
    assert np.allclose(branch["y"], branch["place"], rtol=1e-14, atol=1e-14)


def test_a_family_is_held_where_it_starts():
    neutral = Neutral("family", along_y, pin="y")
    problem = small_problem(shelf, "xy", {"mu": 0.0}, "mu", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.0, 0.2], (-1.0, 1.0))
    check_branch(branch, problem)
    assert np.all(branch["y"] == 0.2)
    assert branch.points["spectrum"].shape[1] == 1


def ring(t, x, p, dx):
    """A circle of equilibria of radius sqrt(mu); r' = r (mu - r^2), no rotation; z follows the radius."""
    square = x[0] ** 2 + x[1] ** 2
    dx[0] = x[0] * (p.mu - square)
    dx[1] = x[1] * (p.mu - square)
    dx[2] = square - x[2] * (1.0 + p.mu)


def turning(t, x, p, v):
    v[0] = -x[1]
    v[1] = x[0]
    v[2] = 0.0


@pytest.mark.parametrize("angle", [0.0, 0.6, 2.0])
def test_a_rotation_is_held_without_a_pin(angle):
    neutral = Neutral("rotation", turning)
    problem = small_problem(ring, "xyz", {"mu": 0.5}, "mu", neutral=(neutral,))
    radius = math.sqrt(0.5)
    start = [radius * math.cos(angle), radius * math.sin(angle), 0.5 / 1.5]
    branch = cw.continue_branch(problem, start, (0.1, 1.0))
    check_branch(branch, problem)
    assert branch.points["spectrum"].shape[1] == 2
    # r' = r (mu - r^2) has rate -2 mu at the circle; z has -(1 + mu).
    expected = np.maximum(-2.0 * branch["mu"], -1.0 - branch["mu"])
    assert np.allclose(branch["max_re"], expected, rtol=1e-12)
    assert np.allclose(branch["x"] ** 2 + branch["y"] ** 2, branch["mu"], rtol=1e-12)
    # The angle is that of the start all the way.
    cross = branch["x"] * math.sin(angle) - branch["y"] * math.cos(angle)
    assert np.max(np.abs(cross)) < 1e-12
    assert (branch["stable"] == 1).all()


def test_an_undeclared_direction_is_reported_and_not_counted():
    problem = small_problem(shelf, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.2], (-1.0, 1.0))
    check_branch(branch, problem)
    assert "undeclared neutral direction" in branch.outcome.message
    assert "y +1" in branch.outcome.message or "y -1" in branch.outcome.message
    assert np.all(branch["unstable"] == 0)
    assert np.allclose(branch["y"], 0.2, rtol=1e-14)
    assert branch.points["spectrum"].shape[1] == 1


def test_a_declared_direction_is_not_reported():
    neutral = Neutral("family", along_y, pin="y")
    problem = small_problem(shelf, "xy", {"mu": 0.0}, "mu", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.0, 0.2], (-1.0, 1.0))
    assert "undeclared" not in branch.outcome.message


def test_a_direction_that_is_neutral_at_the_start_only_is_not_held():
    """y' = (mu - 1/2) y is neutral at mu = 1/2 alone: that is a bifurcation, and must be seen by the
    branch.
    """

    def field(t, x, p, dx):
        dx[0] = -x[0] + p.mu
        dx[1] = (p.mu - 0.5) * x[1] + p.mu - 0.5

    neutral = Neutral("family", along_y, pin="y")
    problem = small_problem(field, "xy", {"mu": 0.5}, "mu", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.5, -1.0], (0.0, 1.0))
    check_branch(branch, problem)
    assert branch.points["spectrum"].shape[1] == 2
    assert branch["unstable"][0] == 0
    assert branch["unstable"][-1] == 1


def test_bifurcations_are_found_beside_a_held_direction():
    def field(t, x, p, dx):
        dx[0] = (p.mu - 0.25) * x[0] - x[0] ** 3
        dx[1] = 0.0 * x[1]

    neutral = Neutral("family", along_y, pin="y")
    problem = small_problem(field, "xy", {"mu": 0.0}, "mu", neutral=(neutral,))
    branch = cw.continue_branch(problem, [0.0, 3.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (point,) = bifurcations(branch)
    assert (point.label, point.kind, point.criticality) == ("BP", "pitchfork", "supercritical")
    assert point.parameters["mu"] == 0.25


def test_a_hopf_point_beside_a_rotation_says_what_its_coefficient_means():
    def field(t, x, p, dx):
        square = x[0] ** 2 + x[1] ** 2
        dx[0] = p.mu * x[0] - x[1] - x[0] * square
        dx[1] = x[0] + p.mu * x[1] - x[1] * square
        dx[2] = 0.0 * x[2]

    def along_z(t, x, p, v):
        v[0] = v[1] = 0.0
        v[2] = 1.0

    problem = small_problem(field, "xyz", {"mu": -0.5}, "mu", neutral=(Neutral("family", along_z, pin="z"),))
    branch = cw.continue_branch(problem, [0.0, 0.0, 1.0], (-1.0, 1.0))
    check_branch(branch, problem)
    (hopf,) = bifurcations(branch)
    assert hopf.coefficients["l1"] == pytest.approx(-2.0, rel=1e-12)
    assert "pinned" in hopf.note


def cube(t, x, p, dx):
    dx[0] = (p.mu - x[0]) ** 3


def square_beside(t, x, p, dx):
    dx[0] = (p.mu - x[0]) ** 2 * (1.0 + x[1] ** 2)
    dx[1] = x[0] - 2.0 * x[1]


MULTIPLE_ROOTS = [(cube, [1.0]), (square_beside, [1.0, 0.5])]


@pytest.mark.parametrize(("field", "start"), MULTIPLE_ROOTS)
def test_a_multiple_root_is_no_family(field, start):
    """x = mu is a multiple root for every mu: held at its start, it solves nothing at another mu."""
    problem = small_problem(field, "xy"[: len(start)], {"mu": 1.0}, "mu")
    with pytest.raises(StartError, match="multiple root"):
        cw.continue_branch(problem, start, (0.0, 4.0))


def test_a_family_that_ends_is_not_held_beyond_its_end():
    """y is free while mu <= 1/2 only; beyond, y' = (mu - 1/2)^2 takes a force to hold."""

    def field(t, x, p, dx):
        dx[0] = p.mu - x[0]
        dx[1] = np.maximum(p.mu - 0.5, 0.0) ** 2

    for neutral in ((), (Neutral("family", along_y, pin="y"),)):
        problem = small_problem(field, "xy", {"mu": 0.0}, "mu", neutral=neutral)
        branch = cw.continue_branch(problem, [0.0, 0.2], (-1.0, 1.0))
        assert branch["mu"].min() == -1.0
        assert branch["mu"].max() <= 0.5
        assert (branch.outcome.status, branch.outcome.reason) == ("failed", "no_convergence")
        assert "takes a force" in branch.outcome.message


def test_a_steady_motion_is_no_equilibrium():
    """x moves on with the velocity 1: a declared direction along x must not make it rest."""

    def field(t, x, p, dx):
        dx[0] = 1.0 + x[1] - p.mu
        dx[1] = p.mu - x[1]

    def along_x(t, x, p, v):
        v[0] = 1.0
        v[1] = 0.0

    problem = small_problem(field, "xy", {"mu": 0.0}, "mu", neutral=(Neutral("place", along_x, pin="x"),))
    with pytest.raises(StartError):
        cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0))


def ill(t, x, p, dx):
    dx[0] = -p.beta * x[0] * x[1]
    dx[1] = p.beta * x[0] * x[1] - x[1]


def ill_and_removed(t, x, p, dx):
    ill(t, x, p, dx)
    dx[2] = x[1]


@pytest.mark.parametrize(("field", "states"), [(ill, "SI"), (ill_and_removed, "SIR")])
def test_a_line_of_equilibria_changes_its_stability_and_no_branch_leaves(field, states):
    """Kermack and McKendrick (1927): at rest nobody is ill, for every S. The rate beta S - 1 passes zero;
    where some are ill S falls, and nothing rests.
    """
    problem = small_problem(field, states, {"beta": 0.5}, "beta")
    branch = cw.continue_branch(problem, [0.8, *[0.0] * (len(states) - 1)], (0.2, 3.0))
    (point,) = [each for each in branch.special_points if each.label == "BP"]
    assert (point.kind, point.status) == (None, "located")
    assert point.parameters["beta"] == pytest.approx(1.25, rel=1e-14)
    assert (point.unstable_before, point.unstable_after) == (0, 1)
    assert "no branch leaves" in point.note
    with pytest.raises(StartError, match="No other branch leaves"):
        cw.switch_branch(problem, branch, point, (0.2, 3.0))
