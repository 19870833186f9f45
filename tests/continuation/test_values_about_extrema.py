"""A value that is marked just below a maximum is met twice within one step, before and behind it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.system import Observable

TOP = 0.0312345


def hill(t, x, p, dx):
    dx[0] = 1.0 - (p.mu - TOP) ** 2 - x[0]


def height(t, x, p):
    return x[-1][0]


@pytest.mark.parametrize("below", [1e-2, 1e-4, 1e-10, 1e-14])
def test_a_value_about_a_maximum_is_met_on_both_sides(below):
    problem = small_problem(hill, "x", {"mu": -1.0}, "mu", observables=(Observable("h", height),))
    level = 1.0 - below
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"h": [level]})
    aside = math.sqrt(1.0 - level)
    # Where the value is met the rate is 2 aside: rounding of the value over it.
    found = [p.parameters["mu"] for p in labelled(branch, "UZ")]
    assert found == pytest.approx([TOP - aside, TOP + aside], abs=np.spacing(1.0) / aside)


def test_a_value_above_the_maximum_is_not_met():
    problem = small_problem(hill, "x", {"mu": -1.0}, "mu", observables=(Observable("h", height),))
    branch = cw.continue_branch(problem, [0.0], (-1.0, 1.0), marks={"h": [1.0 + 1e-12]})
    assert labelled(branch, "UZ") == []


def test_a_value_of_the_parameter_beside_a_fold_is_met_on_both_sides():
    def field(t, x, p, dx):
        dx[0] = p.mu - x[0] ** 2

    problem = small_problem(field, "x", {"mu": 1.0}, "mu")
    branch = cw.continue_branch(problem, [1.0], (-0.5, 2.0), marks={"mu": [1e-7]})
    found = [(p.label, p.parameters["mu"]) for p in labelled(branch, "UZ", "LP")]
    assert found == [("UZ", 1e-7), ("LP", pytest.approx(0.0, abs=1e-15)), ("UZ", 1e-7)]


def test_a_value_beside_a_kink_is_met_on_both_sides():
    """The larger one of two eigenvalues that cross, -2 + d and -2 - 2 d, is least where they do."""

    def field(t, x, p, dx):
        dx[0] = (p.mu - TOP - 2.0) * x[0]
        dx[1] = (-2.0 * (p.mu - TOP) - 2.0) * x[1]

    problem = small_problem(field, "xy", {"mu": -0.5}, "mu")
    branch = cw.continue_branch(problem, [0.0, 0.0], (-0.5, 0.5), marks={"max_re": [-1.99999]})
    found = [p.parameters["mu"] for p in labelled(branch, "UZ")]
    assert found == pytest.approx([TOP - 0.5e-5, TOP + 1e-5], abs=1e-14)
