"""Defining systems of fields in closed form: each point where it is, and each refusal where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import small_problem

from contwalk.problems.equilibrium.defining_systems import real_eigenvalue
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.equilibrium.points.branch_point import branch_point
from contwalk.problems.equilibrium.points.hopf import hopf
from contwalk.problems.equilibrium.points.multiple_zero import multiple_zero
from contwalk.problems.equilibrium.second_direction import (
    branch_point_seeds,
    directions,
    reach,
    second_direction,
    tangent_through,
)
from contwalk.problems.problem import Sample
from contwalk.system import State


def sample_at(problem: Equilibrium, *z: float) -> Sample:
    """The sample at a place that need not be a solution: a guess for a defining system."""
    place, weights = np.array(z), np.ones(len(z))
    tangent = np.zeros(len(z))
    tangent[-1] = 1.0
    return problem.examine(place, tangent, weights, problem.linearize(place), None)


def quadratic(t, x, p, dx):
    dx[0] = p.lam - (x[0] - p.a) ** 2
    dx[1] = -2.0 * x[1] + x[0]


def fork(t, x, p, dx):
    dx[0] = p.lam * x[0] + p.b * x[0] ** 2 - x[0] ** 3 + p.c
    dx[1] = -x[1]


def swing(t, x, p, dx):
    dx[0] = p.lam * x[0] - p.w * x[1]
    dx[1] = p.w * x[0] + p.lam * x[1]
    dx[2] = -x[2]


def fold_problem(a=1.0 / 3.0):
    return small_problem(quadratic, "xy", {"lam": 0.1, "a": a}, "lam")


def fork_problem(c=0.0, b=0.0):
    return small_problem(fork, "xy", {"lam": 0.1, "b": b, "c": c}, "lam")


def swing_problem(w=2.0):
    return small_problem(swing, "xyz", {"lam": 0.1, "w": w}, "lam")


# -- folds ---------------------------------------------------------------------------------------------------


def test_a_fold_is_known_to_the_last_bit():
    rough = real_eigenvalue(fold_problem(), sample_at(fold_problem(), 0.4, 0.2, 0.05), None)
    found = rough.settled()
    assert found.refined
    assert found.z == pytest.approx([1.0 / 3.0, 1.0 / 6.0, 0.0], abs=6e-17)
    assert found.error <= 1e-20
    assert abs(found.critical @ [1.0, -2.0]) <= 1e-15 * np.abs(found.critical).max()


def test_where_there_is_no_fold_none_is_found():
    """lam = x + x^3 never turns."""

    def field(t, x, p, dx):
        dx[0] = p.lam - x[0] - x[0] ** 3

    problem = small_problem(field, "x", {"lam": 0.1}, "lam")
    for x in (-0.5, 0.0, 0.5):
        assert real_eigenvalue(problem, sample_at(problem, x, x + x**3), None) is None


def test_an_eigenvalue_of_a_given_value():
    """The eigenvalue of the fold's field is -2 (x - a): it is -1 at x = a + 1/2, lam = 1/4."""
    found = real_eigenvalue(fold_problem(), sample_at(fold_problem(), 0.8, 0.4, 0.2), -1.0).settled()
    assert found.z == pytest.approx([1.0 / 3.0 + 0.5, 0.5 * (1.0 / 3.0 + 0.5), 0.25], abs=2e-16)


# -- branch points -------------------------------------------------------------------------------------------


def test_a_branch_point_is_known_to_the_last_bit():
    found = branch_point(fork_problem(), sample_at(fork_problem(), 0.02, 0.01, -0.04)).settled()
    assert found.z.tolist() == [0.0, 0.0, 0.0]
    assert found.error <= 1e-20
    assert [abs(float(entry)) for entry in found.data[3:5]] == pytest.approx([1.0, 0.0], abs=1e-15)


@pytest.mark.parametrize("c", [1e-3, 1e-8, 1e-13])
def test_an_unfolded_branch_point_is_none(c):
    """What would have to be added to the equations is c, far above their rounding."""
    assert branch_point(fork_problem(c), sample_at(fork_problem(c), 0.0, 0.0, 1e-3)) is None


def test_below_rounding_an_unfolding_is_nothing():
    assert branch_point(fork_problem(1e-20), sample_at(fork_problem(1e-20), 0.0, 0.0, 1e-3)) is not None


def test_what_the_equations_round_may_be_nothing_in_floats_and_something_in_truth():
    """0.83 times 1.32 is 1.0956 in floats, and 1.3e-16 off exactly: refinement saw it come, and gave up."""

    def field(t, x, p, dx):
        dx[0] = p.lam * x[0] + x[0] ** 2 + 0.83 * p.m - 1.0956
        dx[1] = -x[1]

    problem = small_problem(field, "xy", {"lam": 0.1, "m": 1.32}, "lam")
    assert problem.linearize(np.zeros(3)).residual.tolist() == [0.0, 0.0]
    found = branch_point(problem, sample_at(problem, 0.0, 0.0, 1e-3)).settled()
    assert found.refined
    assert found.z == pytest.approx(np.zeros(3), abs=1e-20)


def test_two_eigenvalues_that_vanish_together_and_one_alone():
    def both(t, x, p, dx):
        dx[0] = p.lam * x[0] - x[0] ** 3
        dx[1] = 2.0 * p.lam * x[1] - x[1] ** 3
        dx[2] = -x[2]

    problem = small_problem(both, "xyz", {"lam": 0.1}, "lam")
    found = multiple_zero(problem, sample_at(problem, 0.0, 0.0, 0.0, 1e-3)).settled()
    assert found.multiplicity == 2
    assert np.abs(found.z).max() <= 1e-15
    assert multiple_zero(fork_problem(), sample_at(fork_problem(), 0.0, 0.0, 1e-3)) is None


# -- Hopf points ---------------------------------------------------------------------------------------------


def test_a_hopf_point_with_its_frequency():
    problem = swing_problem(1.0 / 3.0)
    sample = sample_at(problem, 0.0, 0.0, 0.0, 0.03)
    found = hopf(problem, sample, 0).settled()
    assert found.z.tolist() == [0.0, 0.0, 0.0, 0.0]
    assert found.data.omega == pytest.approx(1.0 / 3.0, abs=1e-16)
    q = found.data.right
    # (A - i omega) q = 0 with A = [[0, -w], [w, 0]]: q is (1, -i) times a number, whichever one was asked.
    assert abs(q[1] + 1j * q[0]) <= 1e-15 * abs(q[0])
    same = hopf(problem, sample, 1).settled()
    assert same.data.omega == found.data.omega


def test_a_pair_with_a_given_real_part():
    found = hopf(swing_problem(), sample_at(swing_problem(), 0.0, 0.0, 0.0, 0.03), 0, shift=-0.5).settled()
    assert found.z[-1] == pytest.approx(-0.5, abs=1e-16)
    assert found.data.omega == pytest.approx(2.0, abs=4e-16)


def test_a_double_zero_is_no_hopf_point():
    """x' = y, y' = lam + x^2 + ... has omega = 0 at its fold, the degenerate solution of the equations."""

    def field(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -p.lam + x[0] ** 2 + 0.5 * x[1]

    problem = small_problem(field, "xy", {"lam": 0.04}, "lam")
    # The pair at x = -0.2 has the real part 0.25 for ever: it never crosses.
    assert hopf(problem, sample_at(problem, -0.2, 0.0, 0.04), 0) is None


def test_where_a_pair_does_not_cross_there_is_none():
    def field(t, x, p, dx):
        dx[0] = -(1.0 + p.lam**2) * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] - (1.0 + p.lam**2) * x[1]

    problem = small_problem(field, "xy", {"lam": 0.1}, "lam")
    assert hopf(problem, sample_at(problem, 0.0, 0.0, 0.1), 0) is None


# -- directions at a branch point ----------------------------------------------------------------------------


def test_the_two_directions_of_a_transcritical_point():
    """x (lam + b x): x = 0, and x = -lam / b."""
    b = 0.5
    problem = fork_problem(b=b)
    found = directions(problem, np.zeros(3), np.ones(3))
    slopes = sorted(t[0] / t[-1] for t in found)
    assert slopes == pytest.approx([-1.0 / b, 0.0], abs=1e-14)
    assert all(np.linalg.norm(t) == pytest.approx(1.0) for t in found)


def test_the_directions_do_not_depend_on_the_metric():
    problem = fork_problem(b=0.5)
    for weights in (np.array([1e-3, 1.0, 1.0]), np.array([1.0, 1.0, 1e4])):
        slopes = sorted(t[0] / t[-1] for t in directions(problem, np.zeros(3), weights))
        assert slopes == pytest.approx([-2.0, 0.0], abs=1e-10)


def test_a_pitchfork_is_left_at_a_right_angle():
    found = directions(fork_problem(), np.zeros(3), np.ones(3))
    shares = sorted(abs(t[-1]) for t in found)
    assert shares == pytest.approx([0.0, 1.0], abs=1e-14)


def test_an_isolated_point_has_no_directions():
    """x^2 + lam^2 = 0 has one real solution."""

    def field(t, x, p, dx):
        dx[0] = x[0] ** 2 + p.lam**2

    problem = small_problem(field, "x", {"lam": 0.0}, "lam")
    assert directions(problem, np.zeros(2), np.ones(2)) == []
    assert tangent_through(problem, np.zeros(2), np.ones(2), np.array([0.0, 1.0])) is None


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_tangent_through_is_the_nearest_one_and_faces_the_same_way(sign):
    problem = fork_problem(b=0.5)
    near = sign * np.array([0.1, 0.0, 1.0])
    assert tangent_through(problem, np.zeros(3), np.ones(3), near) == pytest.approx(
        [0.0, 0.0, sign], abs=1e-14
    )
    steep = sign * np.array([-2.0, 0.1, 1.1])
    expected = sign * np.array([-2.0, 0.0, 1.0]) / math.sqrt(5.0)
    assert tangent_through(problem, np.zeros(3), np.ones(3), steep) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
def test_the_seed_is_the_branch_that_the_parent_is_not(size):
    """In the units of the states: where x is small, x = -2 lam is hardly told from x = 0 in others."""
    from contwalk.branch import SpecialPoint

    states, values = (State("x", scale=size), "y"), {"lam": 0.1, "b": 0.5, "c": 0.0}
    problem = small_problem(fork, states, values, "lam")
    for parent, other in (((0.0, 0.0, 1.0), (-2.0, 0.0, 1.0)), ((2.0, 0.0, -1.0), (0.0, 0.0, 1.0))):
        point = SpecialPoint("BP", 0.0, unknowns=(0.0, 0.0, 0.0), tangent=parent)
        (seed,) = branch_point_seeds(problem, point)
        assert seed.tangent / seed.tangent[-1] == pytest.approx(other, abs=1e-14 * max(1.0 / size, 10.0))
        assert seed.tangent[-1] > 0.0
        assert not seed.one_sided


def test_how_far_the_branch_reaches():
    """Of a pitchfork |x| = sqrt(lam); of the transcritical point |x| = 2 lam; y stays."""
    bent = reach(fork_problem(), np.zeros(3), np.array([1.0, 0.0, 0.0]), 0.04)
    assert bent == pytest.approx([0.2, 0.0, 0.04], rel=1e-12)
    straight = reach(fork_problem(b=0.5), np.zeros(3), np.array([-2.0, 0.0, 1.0]), 0.04)
    assert straight == pytest.approx([0.08, 0.0, 0.04], rel=1e-14)


def test_more_than_one_direction_only_where_there_is():
    assert second_direction(fork_problem(), np.zeros(3)) is not None
    # At a fold the parameter's column is not in the range; beside a branch point nothing is singular.
    assert second_direction(fold_problem(0.0), np.zeros(3)) is None
    assert second_direction(fork_problem(), np.array([0.0, 0.0, 1e-6])) is None
