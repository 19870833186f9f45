"""Along a canard the parameter stands still while states move: nothing runs to infinity there."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import small_problem

import contwalk as cw
from contwalk.numerics.laws import Pair
from contwalk.problems import marching
from contwalk.problems.orbit.discretization import Discretization


def nerve(t, x, p, dx):
    dx[0] = x[0] - x[0] ** 3 / 3.0 - x[1] + p.I
    dx[1] = 0.02 * (x[0] + 0.7 - 0.8 * x[1])


@pytest.mark.long
def test_orbits_further_out_are_asked_seldom_along_a_canard(monkeypatch):
    """Each is as dear as a step of the walk."""
    asked = []
    held = marching._held

    def counted(*given):
        asked.append(1)
        return held(*given)

    monkeypatch.setattr(marching, "_held", counted)
    system = small_problem(nerve, "vw", {"I": 0.0}, "I").system
    problem = cw.Equilibrium(
        system, system.defaults(), "I", discretization=Discretization(scheme="collocation")
    )
    equilibria = cw.continue_branch(problem, [-1.2, -0.6], (0.0, 2.0))
    cycle = cw.switch_branch(problem, equilibria, "HB1", (0.0, 2.0), max_points=150)
    assert cycle.outcome.reason != "unbounded"
    assert len(asked) < 0.3 * len(cycle.points)


def test_where_the_parameter_stands_still_it_falls_no_more():
    def falls(first, last):
        return Pair(np.array([1.0, 2.0]), np.zeros(2), np.array([first, last])).falls

    assert falls(1e-3, 1e-4)
    assert not falls(1e-3, 0.0)
    assert not falls(0.0, 0.0)
    assert not falls(1e-3, -1e-4)
    assert not falls(1e-4, 1e-3)
