"""Branches that run off to infinity, and how near their parameter's limit is told."""

import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.problems.equilibrium.unbounded import escape


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


def turnover(t, x, p, dx):
    """A chain of saturated steps whose rates nearly cancel: their rounding hides what the limit has left."""
    first, back = 2.0 * x[0] / (2.0 + x[0]), 3.0 * x[1] / (2.0 + x[1])
    dx[0] = p.lam - first + back
    dx[1] = first - back - x[1]


def logarithm(t, x, p, dx):
    dx[0] = p.lam * np.exp(x[0]) - x[0]


def hot(t, x, p, dx):
    """x = 1000 - log(lam): the amplitude hardly grows while the parameter falls by decades."""
    dx[0] = p.lam * np.exp(x[0] - 1000.0) - 1.0


def cold(t, x, p, dx):
    """x = 1000 + log(lam), which passes zero long after the parameter has arrived."""
    dx[0] = 1.0 - p.lam * np.exp(1000.0 - x[0])


def superlogarithm(t, x, p, dx):
    """Nearly x = log(-log(lam)): the field overflows at 6.6."""
    dx[0] = p.lam * np.exp(np.exp(x[0])) - 1.0 - np.exp(-x[0])


def step(t, x, p, dx):
    """The parameter tends to 1 upwards, and downwards to 0, where what makes it small overflows."""
    dx[0] = p.lam - 1.0 / (1.0 + np.exp(300.0 - x[0]))


ESCAPES = [
    (pole, [1.0], 1.0, 0.0),
    (shifted_pole, [1 / 0.7, 1 / 0.49], 1.0, 0.3),
    (cube, [1.0], 1.0, 0.0),
    (root, [1.0], 1.0, 0.0),
    (saturated, [1.0], 0.5, 1.0),
    (turnover, [2.4, 0.5], 0.5, 1.0),  # x[1] = lam, and lam + 3 lam / (2 + lam) = 2
    (logarithm, [0.25], 0.2, 0.0),
    (hot, [1000.0], 1.0, 0.0),
    (cold, [1000.0], 1.0, 0.0),
    (superlogarithm, [0.0], 2.0 * math.exp(-1.0), 0.0),
]


@pytest.mark.drawn(3)
@pytest.mark.parametrize(("field", "start", "value", "limit"), ESCAPES)
def test_a_branch_without_bound_says_where(field, start, value, limit):
    problem = small_problem(field, "xy"[: len(start)], {"lam": value}, "lam")
    branch = cw.continue_branch(problem, start, (-1.0, 2.0))
    assert (branch.outcome.status, branch.outcome.reason) == ("complete", "unbounded")
    (end,) = [p for p in labelled(branch, "EP") if p.kind == "unbounded"]
    # the parameter's magnitude is at most two, of which 1e-10 are left at the most
    (there,) = re.findall(r"at lam = (\S+)\. ", end.note)
    assert float(there) == pytest.approx(limit, abs=2e-10)
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


def test_an_exponential_that_overflows_downwards():
    problem = small_problem(step, "x", {"lam": 0.5}, "lam")
    branch = cw.continue_branch(problem, [300.0], (-1.0, 2.0))
    assert [p.kind for p in labelled(branch, "EP")] == ["unbounded", "unbounded"]
    down, up = labelled(branch, "EP")
    assert "tends to 0:" in down.note
    assert "tends to 1:" in up.note


def hyperbola(small):
    def field(t, x, p, dx):
        dx[0] = p.lam * x[0] - 1.0 - small * x[0] ** 2

    return field


def decay(small):
    def field(t, x, p, dx):
        dx[0] = p.lam - np.exp(-x[0]) - small * x[0]
        dx[1] = x[0] - x[1]

    return field


# Folds at x = small^-1/2 with lam = 2 small^1/2, and at x = -log(small) with lam = (1 + x) small. The
# parameter is at its lowest there, nearly zero, and grows to the end of its range afterwards.
TURNS = [
    (hyperbola(1e-12), [1.0], 1e6),
    (hyperbola(1e-20), [1.0], 1e10),
    (hyperbola(1e-23), [1.0], 10**11.5),
    (decay(1e-9), [0.0, 0.0], 9 * math.log(10)),
    (decay(1e-12), [0.0, 0.0], 12 * math.log(10)),
    (decay(1e-14), [0.0, 0.0], 14 * math.log(10)),
]


@pytest.mark.drawn(1)
@pytest.mark.parametrize(("field", "start", "fold"), TURNS)
def test_a_branch_that_turns_round_far_out_is_followed(field, start, fold):
    problem = small_problem(field, "xy"[: len(start)], {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, start, (-1.0, 2.0))
    assert [p.kind for p in labelled(branch, "EP")] == ["bound", "bound"]
    (point,) = labelled(branch, "LP")
    # where a fold is known by its parameter, x is known to the root of that
    assert point.state["x"] == pytest.approx(fold, rel=1e-6)


def test_the_end_of_a_fields_domain_is_no_escape():
    def field(t, x, p, dx):
        dx[0] = p.lam - np.exp(-x[0])
        dx[1] = np.sqrt(50.0 - x[0]) - x[1]

    problem = small_problem(field, "xy", {"lam": 1.0}, "lam")
    branch = cw.continue_branch(problem, [0.0, math.sqrt(50.0)], (-1.0, 2.0))
    assert branch.outcome.status == "failed"
    assert branch["x"].max() > 45.0


def rows_of(field, start, value, span):
    problem = small_problem(field, "x", {"lam": value}, "lam")
    return problem, [point.state.sample for point in cw.points(problem, start, span)]


def escaped(problem, a, b):
    return escape(problem, a, b, "x".__getitem__, "It grows")


def test_no_other_branch_has_an_escape():
    """Folds, vertical branches and branches that grow for good reason."""

    def fold(t, x, p, dx):
        dx[0] = p.lam - 1.0 + (x[0] - 2.0) ** 2

    def vertical(t, x, p, dx):
        dx[0] = p.lam * x[0]

    def steep(t, x, p, dx):
        dx[0] = p.lam - x[0] ** 0.125

    for field, start, value in ((fold, [2.7], 0.51), (vertical, [1.0], 0.0), (steep, [1.0], 1.0)):
        problem, samples = rows_of(field, start, value, (-1.0, 3.0))
        for a, b in pairwise(samples[:150]):
            assert escaped(problem, a, b) is None
            assert escaped(problem, b, a) is None


def test_a_step_that_ends_on_a_fold_is_no_escape():
    """The slope is nearly zero there too; but it does not stay so."""

    def fold(t, x, p, dx):
        dx[0] = p.lam - 1.0 + (x[0] - 2.0) ** 2

    problem, (first, *_) = rows_of(fold, [1.9], 1.0 - 0.01, (-1.0, 3.0))
    for apart in (1e-6, 1e-9, 1e-11, 1e-13):
        x = 2.0 - apart
        tangent = np.array([1.0, 2.0 * apart])
        tangent = tangent / np.linalg.norm(tangent / first.weights)
        last = replace(first, z=np.array([x, 1.0 - apart**2]), tangent=tangent)
        before = replace(first, tangent=first.tangent * np.sign(first.tangent[0]))
        assert escaped(problem, before, last) is None
