"""Branches that are born as a parabola far narrower than any step, beside which shorter steps are errors."""

from __future__ import annotations

import math

import pytest
from small_systems import labelled, small_problem

import contwalk as cw

# Period of the doubled orbit by SciPy's DOP853 (1e-11), 20000 s from beside the orbit at the doubling.
PERIOD_AT_THE_END = 92.950256
RANGE = (0.21434, 0.4)


def three_sines(t, x, p, dx):
    """x' = sin y - b x, and so on round: |x'| <= 1 + b |x|, so that no motion grows without bound."""
    dx[0] = math.sin(x[1]) - p.b * x[0]
    dx[1] = math.sin(x[2]) - p.b * x[1]
    dx[2] = math.sin(x[0]) - p.b * x[2]


def test_a_doubled_orbit_whose_period_and_parameter_move_while_states_hardly_do_is_followed():
    """The parabola is 3e-6 wide, and solutions a tenth of that away are errors: it was `not_finite` there."""
    problem = small_problem(three_sines, "xyz", {"b": 0.35}, "b")
    rest = cw.continue_branch(problem, [2.3, 2.3, 2.3], RANGE)
    cycles = cw.switch_branch(problem, rest, "HB1", RANGE)
    (doubling,) = labelled(cycles, "PD")
    assert doubling.criticality == "supercritical"
    doubled = cw.switch_branch(problem, cycles, "PD1", RANGE)
    assert doubled.outcome.reason == "bound", doubled.outcome
    end = doubled.special_points[-1]
    assert end.parameters["b"] == RANGE[0]
    # On the steps of the walk, and not refined.
    assert end.period == pytest.approx(PERIOD_AT_THE_END, rel=1e-6)
    assert not doubled["unstable"][doubled["s"] != 0.0].any()
