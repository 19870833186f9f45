"""Branches along which the parameter stands still: a second eigenvalue passes zero on them, or they cross."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_problem, small_system

from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram, Plan
from contwalk.problems.equilibrium.vertical import spectrum_beside
from contwalk.studies.opening import opened

POINTS = 80


def walked(field, states, free, value, depth=1):
    """The diagram from zero, branch points followed."""
    system = small_system(field, states, {free: value})
    settings = Settings(range=(-1.0, 1.0), max_points=POINTS)
    opening = opened(system, {free: value}, free, np.zeros(len(states)), settings)
    made = Diagram([Start(system, free, {free: value}, opening, "start")], Plan(settings, depth=depth))
    assert list(made.events())
    return made.branches


def counts_agree(branch, certain):
    """Stored counts are those of `certain(state)`, and change where a special point says so."""
    points = [p for p in branch.special_points if p.label != "EP"]
    for row in branch.points:
        if not row["special"] and row["s"] != 0.0:
            assert row["unstable"] == certain(row["state"])
    for point in points:
        for count, row in ((point.unstable_before, point.index - 1), (point.unstable_after, point.index + 1)):
            # Of pairs that stay on the axis, as without damping, no sign is known.
            known = branch["unstable"][row] >= 0
            assert count == (branch["unstable"][row] if known else None)


# -- a second eigenvalue that passes zero --------------------------------------------------------------------


def turning(t, x, p, dx):
    """At mu = 0 the curve a = b - b^3, with the eigenvalues 0 and 3 b^2 - 1: it turns back at b^2 = 1/3."""
    dx[0] = p.mu * x[0]
    dx[1] = x[0] - x[1] + x[1] ** 3


def mixed(t, x, p, dx):
    """The same in turned coordinates, so that no entry of the Jacobian is zero."""
    a, b = x[0] + 0.3 * x[1], x[1] - 0.2 * x[0]
    u, v = p.mu * a, a - b + b**3
    dx[0] = (u - 0.3 * v) / 1.06
    dx[1] = (v + 0.2 * u) / 1.06


@pytest.mark.parametrize("field", [turning, mixed])
def test_a_vertical_branch_goes_on_where_a_second_eigenvalue_passes_zero(field):
    """It used to creep up to the place for the rest of its points, and told of a Hopf point."""

    def b_of(state):
        return state[1] if field is turning else state[1] - 0.2 * state[0]

    _, branch = walked(field, "xy", "mu", -0.5)
    assert np.all(np.abs(branch["mu"]) <= 1e-15)
    b = np.array([b_of(row["state"]) for row in branch.points])
    assert np.abs(b).max() > 1.0
    # Where b^2 = 1 the equilibria a = 0, b = 1 or -1, which there are for every mu, cross it.
    crossed, turned = [("BP", "located")], [("LP", "unlocated")]
    passed = [p for p in labelled(branch, "LP", "BP", "HB") if abs(p.s) > 0.0]
    assert [(p.label, p.status) for p in passed] == crossed + turned + turned + crossed
    for point in passed[1:3]:
        assert "second real eigenvalue" in point.note
        assert point.error is None  # nothing tells how far it is
        # A real eigenvalue is bracketed to 1e-5 of a step of at most 0.1.
        assert abs(b_of(list(point.state.values()))) == pytest.approx(1.0 / math.sqrt(3.0), abs=2e-6)
    counts_agree(branch, lambda state: int(3.0 * b_of(state) ** 2 > 1.0))


def test_the_zero_of_the_branch_itself_is_left_where_the_spectrum_is_stored():
    _, branch = walked(turning, "xy", "mu", -0.5)
    b = branch.points["state"][:, 1]
    expected = np.sort(np.column_stack([np.zeros(len(b)), 3.0 * b**2 - 1.0]), axis=1)[:, ::-1]
    # Only at the branch point that it was born at the zero is computed with the others.
    assert branch.points["spectrum"].real == pytest.approx(expected, abs=1e-13)
    assert branch["max_re"] == pytest.approx(np.maximum(expected[:, 0], 0.0), abs=1e-13)


def two_oscillators(t, x, p, dx):
    """At mu = 0 any a is an equilibrium, beside two undamped oscillators with frequencies of their own."""
    a, y, v, z, w = x
    dx[0] = p.mu * a
    dx[1], dx[2] = v, -(1.0 + a**2) * y
    dx[3], dx[4] = w, -(3.0 + a) * z


def test_a_vertical_branch_of_a_machine_without_damping_is_walked():
    """The pairs on the imaginary axis were told without the zero beside them: an internal error."""
    _, branch = walked(two_oscillators, "ayvzw", "mu", -0.5)
    assert np.all(np.abs(branch["mu"]) <= 1e-15)
    a = branch.points["state"][:, 0]
    assert a.min() < -3.0 < 3.0 < a.max()
    # z'' = -(3 + a) z has a positive eigenvalue where a < -3.
    counts_agree(branch, lambda state: int(state[0] < -3.0))


@pytest.mark.parametrize("b", [0.3, 1.0 / math.sqrt(3.0), 0.8])
def test_what_is_beside_the_zero_is_certain_where_both_meet(b):
    """At b^2 = 1/3 zero is a defective eigenvalue of A; beside the branch the other is simple."""
    problem = small_problem(mixed, "xy", {"mu": 0.0}, "mu")
    a = b - b**3
    z = np.array([(a - 0.3 * b) / 1.06, (b + 0.2 * a) / 1.06, 0.0])
    way = np.array([(1.0 - 3.0 * b**2 - 0.3) / 1.06, (1.0 + 0.2 * (1.0 - 3.0 * b**2)) / 1.06, 0.0])
    speed = float(np.linalg.norm(way))
    sample = problem.examine(z, way / speed, np.ones(3), problem.linearize(z), 0)
    assert sample.still
    assert sample.eigenvalues == pytest.approx([3.0 * b**2 - 1.0, 0.0], abs=1e-14)
    assert sample.errors.max() < 1e-14
    assert sample.rates[0] == pytest.approx(6.0 * b / speed, rel=1e-12)
    assert sample.spectrum.real.tolist() == sorted(sample.eigenvalues.real, reverse=True)


def test_at_a_fold_the_parameter_has_no_share_in_the_tangent_but_turns():
    problem = small_problem(lambda t, x, p, dx: dx.__setitem__(0, p.mu - x[0] ** 2), "x", {"mu": 0.0}, "mu")
    z = np.zeros(2)
    sample = problem.examine(z, np.array([1.0, 0.0]), np.ones(2), problem.linearize(z), 0)
    assert not sample.still


def driven(t, x, p, dx):
    """At mu = 0.49 the line a = -0.25 b / 0.14, with the eigenvalues 0 and -0.14."""
    dx[0] = (p.mu - 0.63) * x[0] - 0.25 * x[1]
    dx[1] = -0.49 * x[1] + p.mu * x[1]


@pytest.mark.parametrize("b", [0.7, 3.0])
def test_what_cancels_exactly_is_still_known_to_the_rounding_of_the_parameter(b):
    """-0.49 b + mu b is zero without any rounding; a tangent from there had a share of the parameter."""
    problem = small_problem(driven, "ab", {"mu": 0.49}, "mu")
    z, weights = np.array([-0.25 * b / 0.14, b, 0.49]), np.array([2.0, 1.0, 0.49])
    for share in (0.0, 3e-18, -3e-18):  # far below half an ulp of mu
        way = np.array([1.0, -0.56, share])
        assert problem.examine(z, way, weights, problem.linearize(z), 0).still


def swapped(t, x, p, dx):
    """At mu = 0.67 / 2.34 the line a = -b with c = d = 0."""
    a, b, c, d = x
    dx[0] = (p.mu - 0.67) * a - 1.34 * p.mu * b - 1.3 * d + 0.68 * b**2 * c
    dx[1] = (p.mu - 0.67) * b - 1.34 * p.mu * a - 1.3 * c + 0.68 * a**2 * d
    dx[2] = (p.mu - 0.67) * c - 0.45 * np.sin(1.3 * b) * d
    dx[3] = (p.mu - 0.67) * d - 0.45 * np.sin(1.3 * a) * c


@pytest.mark.parametrize("a", [60.0, 129.0])
def test_unknowns_that_are_noise_of_zero_do_not_make_the_parameter_move(a):
    """They are multiplied by the squares of large ones: far out the branch was a fold at every point."""
    problem = small_problem(swapped, "abcd", {"mu": 0.3}, "mu")
    z, weights = np.array([a, -a, -5.8e-18, -1.5e-18, 0.67 / 2.34]), np.array([a, a, 0.04, 0.04, 0.3])
    here = problem.linearize(z)
    way = here.tangent(np.array([1.0, -1.0, 0.0, 0.0, 0.0]) / weights**2, weights)
    assert way[-1] != 0.0
    sample = problem.examine(z, way, weights, here, 0)
    assert sample.still
    assert sample.unstable == 0


@pytest.mark.parametrize("slope", [1e-11, 1e-13])
def test_a_branch_that_hardly_moves_the_parameter_is_not_one_that_keeps_it(slope):
    """mu = slope x: 450 roundings of mu on the way of x by its size, where the second is 1e-13."""
    field = lambda t, x, p, dx: dx.__setitem__(0, (p.mu - slope * x[0]) * (1.0 + x[0] ** 2))  # noqa: E731
    problem = small_problem(field, "x", {"mu": 0.0}, "mu")
    z = np.array([1.0, slope])
    assert not problem.examine(z, np.array([1.0, slope]), np.ones(2), problem.linearize(z), 0).still


def test_pinned_directions_are_left_out_as_well():
    """diag(0, 0, -2): one zero is pinned, the other the branch's own."""
    matrix = np.diag([0.0, 0.0, -2.0])
    nothing = np.zeros((3, 3))
    found = spectrum_beside(
        (matrix, nothing, nothing), np.array([0.0, 2.0, 0.0]), np.zeros(3), np.eye(3)[:, :1], 0
    )
    assert found.values.tolist() == pytest.approx([-2.0, 0.0], rel=4e-15, abs=0.0)
    assert found.still
    assert found.unstable(1) == 0


# -- branches that cross at one value of the parameter -------------------------------------------------------


def crossing(t, x, p, dx):
    """At mu = 0: the line b = 0, and the parabola a = 1 + b^2, which cross at a = 1."""
    dx[0] = p.mu * x[0]
    dx[1] = (x[0] - 1.0) * x[1] - x[1] ** 3


def test_two_vertical_branches_cross_at_a_located_point():
    """It used to be unlocated, with counts that contradicted the rows beside it."""
    _, line, parabola, *_ = walked(crossing, "ab", "mu", -0.5, depth=2)
    point = next(p for p in labelled(line, "BP") if p.state["a"] > 0.0)
    assert (point.status, point.kind, point.criticality) == ("located", None, None)
    assert "keep the parameter" in point.note
    assert point.state["a"] == 1.0  # known to more digits than a float has
    assert point.state["b"] == 0.0
    counts_agree(line, lambda state: int(state[0] > 1.0))
    a, b = parabola.points["state"].T
    assert np.abs(b).max() > 0.5
    assert a == pytest.approx(1.0 + b**2, rel=1e-14)
    assert np.all(parabola["mu"] == 0.0)
