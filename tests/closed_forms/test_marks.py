"""User marks at places known in closed form: values of the parameter and of observables, and extrema."""

import math

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from small_systems import bifurcations, labelled, small_problem

import contwalk as cw
from contwalk.system import Observable

SQUARE = Observable("square", lambda t, x, p: (x[:, 0] ** 2).max() + p.lam)
WAVE = Observable("wave", lambda t, x, p: math.sin(3.0 * x[0, 0]) + 0.0 * p.lam)


def line(t, x, p, dx):
    """x = lambda, with eigenvalue -1 - (lambda - 0.3)^2: largest at lambda = 0.3."""
    dx[0] = (p.lam - x[0]) * (1.0 + (p.lam - 0.3) ** 2)


def _marks(branch, kind):
    return [q for q in labelled(branch, "UZ") if q.kind == kind]


def test_values_of_the_parameter_are_met_exactly():
    problem = small_problem(line, "x", {"lam": 0.0}, "lam")
    values = [-0.75, 0.1, 1e-7, 0.9]
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"lam": values})
    check_branch(branch, problem)
    assert [q.parameters["lam"] for q in _marks(branch, "parameter")] == sorted(values)


def test_values_of_an_observable():
    problem = small_problem(line, "x", {"lam": 0.0}, "lam", observables=(SQUARE,))
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"square": [0.75, -0.2]})
    check_branch(branch, problem)
    # lambda^2 + lambda = level
    with mpmath.workdps(DIGITS):
        levels = [mpmath.mpf(0.75), mpmath.mpf(-0.2), mpmath.mpf(-0.2)]
        roots = [(-1 + s * mpmath.sqrt(1 + 4 * v)) / 2 for s, v in zip((1, 1, -1), levels, strict=True)]
    found = _marks(branch, "observable")
    assert len(found) == 3
    for point, root in zip(found, sorted(roots), strict=True):
        assert_error_claim(point, "lam", root)


@pytest.mark.parametrize("name", ["square", "wave"])
def test_smooth_extrema_of_an_observable(name):
    problem = small_problem(line, "x", {"lam": 0.1}, "lam", observables=(SQUARE, WAVE))
    branch = cw.continue_branch(problem, [0.1], (-1.0, 1.0), marks={name: ["extremum"]})
    check_branch(branch, problem)
    with mpmath.workdps(DIGITS):
        truths = [mpmath.mpf("-0.5")] if name == "square" else [-mpmath.pi / 6, mpmath.pi / 6]
    found = _marks(branch, "extremum")
    assert len(found) == len(truths)
    for point, truth in zip(found, truths, strict=True):
        assert_error_claim(point, "lam", truth)


def test_a_smooth_extremum_of_the_largest_real_part():
    problem = small_problem(line, "x", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"max_re": ["extremum"]})
    check_branch(branch, problem)
    (point,) = _marks(branch, "extremum")
    assert_error_claim(point, "lam", mpmath.mpf(0.3))
    assert branch["max_re"][point.index] == pytest.approx(-1.0, abs=1e-15)


def test_values_of_the_largest_real_part():
    """max_re = -1.25 at 0.3 +- 1/2 for a real eigenvalue."""
    problem = small_problem(line, "x", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"max_re": [-1.25]})
    check_branch(branch, problem)
    below, above = _marks(branch, "observable")
    with mpmath.workdps(DIGITS):
        assert_error_claim(below, "lam", mpmath.mpf(0.3) - mpmath.mpf("0.5"))
        assert_error_claim(above, "lam", mpmath.mpf(0.3) + mpmath.mpf("0.5"))


def test_values_of_the_largest_real_part_of_a_pair():
    def field(t, x, p, dx):
        dx[0] = (p.mu - 0.5) * x[0] - 2.0 * x[1]
        dx[1] = 2.0 * x[0] + (p.mu - 0.5) * x[1] - x[1] ** 3

    problem = small_problem(field, "xy", {"mu": 0.0}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-1.0, 1.0), marks={"max_re": [-0.7, 0.0, 0.2]})
    check_branch(branch, problem)
    found = _marks(branch, "observable")
    with mpmath.workdps(DIGITS):
        truths = [mpmath.mpf("0.5") + mpmath.mpf(v) for v in (-0.7, 0.0, 0.2)]
    assert len(found) == 3
    for point, truth in zip(found, truths, strict=True):
        assert_error_claim(point, "mu", truth)
    (hopf,) = bifurcations(branch)
    assert_error_claim(hopf, "mu", mpmath.mpf("0.5"))


def test_kinks_where_eigenvalues_change_roles_are_no_special_points():
    """Eigenvalues -1 + mu and -1 - mu meet at mu = 0: max_re = -1 + |mu| has a kink, not an extremum."""

    def field(t, x, p, dx):
        dx[0] = (p.mu - 1.0) * x[0]
        dx[1] = (-p.mu - 1.0) * x[1]

    problem = small_problem(field, "xy", {"mu": -0.37}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-0.9, 0.8), marks={"max_re": ["extremum", -0.5]})
    check_branch(branch, problem)
    assert bifurcations(branch) == []
    marks = labelled(branch, "UZ")
    assert [q.kind for q in marks] == ["observable", "observable"]
    assert np.allclose([q.parameters["mu"] for q in marks], [-0.5, 0.5], rtol=1e-15)


def test_marks_at_an_end_and_at_the_start_are_met_once():
    problem = small_problem(line, "x", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"lam": [-1.0, 1.0]})
    check_branch(branch, problem)
    assert [q.parameters["lam"] for q in labelled(branch, "UZ")] == [-1.0, 1.0]


def test_the_start_itself_is_marked():
    problem = small_problem(line, "x", {"lam": 0.25}, "lam")
    branch = cw.continue_branch(problem, [0.25], (-1.0, 1.0), marks={"lam": [0.25]})
    check_branch(branch, problem)
    assert [q.parameters["lam"] for q in labelled(branch, "UZ")] == [0.25]


def plates(t, x, p, dx):
    """A plate drawn to another one by a voltage: below the pull-in its pair has the real part -c / 2."""
    dx[0] = x[1]
    dx[1] = -0.1 * x[1] - x[0] + (p.lam / (1.0 - x[0])) ** 2


def test_what_stands_still_has_no_extremum_at_a_start():
    problem = small_problem(plates, "xv", {"lam": 0.0}, "lam")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-0.2, 0.2), marks={"max_re": ["extremum"]})
    check_branch(branch, problem)
    np.testing.assert_allclose(branch["max_re"], -0.05, rtol=1e-14)  # of a sum of a few terms
    assert not labelled(branch, "UZ")
