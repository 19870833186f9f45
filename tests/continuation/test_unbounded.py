"""Branches that run off to infinity, and how near their parameter's limit is told."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.problems.unbounded import escape


def pole(t, x, p, dx):
    dx[0] = 1.0 - p.lam * x[0]


def shifted_pole(t, x, p, dx):
    dx[0] = 1.0 - (p.lam - 0.3) * x[0]
    dx[1] = x[0] ** 2 - x[1]


def cube(t, x, p, dx):
    dx[0] = 1.0 - p.lam * x[0] ** 3


def root(t, x, p, dx):
    dx[0] = 1.0 - p.lam * np.sqrt(x[0])


def saturated(t, x, p, dx):
    dx[0] = p.lam - x[0] / (1.0 + x[0])


def logarithm(t, x, p, dx):
    dx[0] = p.lam * np.exp(x[0]) - x[0]


ESCAPES = [
    (pole, [1.0], 1.0, 0.0),
    (shifted_pole, [1 / 0.7, 1 / 0.49], 1.0, 0.3),
    (cube, [1.0], 1.0, 0.0),
    (root, [1.0], 1.0, 0.0),
    (saturated, [1.0], 0.5, 1.0),
    (logarithm, [0.25], 0.2, 0.0),
]


@pytest.mark.parametrize(("field", "start", "value", "limit"), ESCAPES)
def test_a_branch_without_bound_says_where(field, start, value, limit):
    problem = small_problem(field, "xy"[: len(start)], {"lam": value}, "lam")
    branch = cw.continue_branch(problem, start, (-1.0, 2.0))
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "unbounded")
    (end,) = [p for p in labelled(branch, "EP") if p.kind == "unbounded"]
    # the parameter's magnitude is at most two, of which 1e-10 are left at the most, before a last step
    assert end.parameters["lam"] == pytest.approx(limit, abs=1e-9)
    assert f"tends to {limit:g}" in end.note
    assert len(branch) < 900  # not by running into `max_points`


def test_both_directions_may_be_without_bound():
    def field(t, x, p, dx):
        dx[0] = p.lam - np.arctan(x[0])

    problem = small_problem(field, "x", {"lam": 0.5}, "lam")
    branch = cw.continue_branch(problem, [0.5], (-2.0, 2.0))
    assert [p.kind for p in labelled(branch, "EP")] == ["unbounded", "unbounded"]
    ends = [p.parameters["lam"] for p in labelled(branch, "EP")]
    assert ends == pytest.approx([-math.pi / 2, math.pi / 2], abs=1e-9)


def rows_of(field, start, value, span):
    problem = small_problem(field, "x", {"lam": value}, "lam")
    return [point.here.sample for point in cw.points(problem, start, span)]


def test_no_other_branch_has_an_escape():
    """Folds, vertical branches and branches that grow for good reason."""

    def fold(t, x, p, dx):
        dx[0] = p.lam - 1.0 + (x[0] - 2.0) ** 2

    def vertical(t, x, p, dx):
        dx[0] = p.lam * x[0]

    def steep(t, x, p, dx):
        dx[0] = p.lam - x[0] ** 0.125

    for field, start, value in ((fold, [2.7], 0.51), (vertical, [1.0], 0.0), (steep, [1.0], 1.0)):
        samples = rows_of(field, start, value, (-1.0, 3.0))[:150]
        for a, b in pairwise(samples):
            assert escape(a, b) is None
            assert escape(b, a) is None


def test_a_step_that_ends_on_a_fold_is_no_escape():
    """The slope is nearly zero there too; but no power of x explains the step."""

    def fold(t, x, p, dx):
        dx[0] = p.lam - 1.0 + (x[0] - 2.0) ** 2

    (first, *_) = rows_of(fold, [1.9], 1.0 - 0.01, (-1.0, 3.0))
    for apart in (1e-6, 1e-9, 1e-11, 1e-13):
        x = 2.0 - apart
        tangent = np.array([1.0, 2.0 * apart])
        tangent = tangent / np.linalg.norm(tangent / first.weights)
        last = replace(first, z=np.array([x, 1.0 - apart**2]), tangent=tangent)
        before = replace(first, tangent=first.tangent * np.sign(first.tangent[0]))
        assert escape(before, last) is None
