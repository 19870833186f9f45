"""Rows at one place: a bifurcation exactly at a point of the walk lies between those whose counts differ."""

import numpy as np
import pytest
from small_systems import small_system

import contwalk as cw


def focus(t, x, p, dx):
    dx[0] = p.a * x[0] - x[1]
    dx[1] = x[0] + p.a * x[1]


@pytest.mark.parametrize("start", [-0.5, 0.0, 0.0006, 0.5])
def test_counts_change_at_special_points_only(start):
    """The Hopf point is at a = 0 exactly, where rounding decides the count of a row that lies on it."""
    system = small_system(focus, "xy", {"a": start})
    problem = cw.Equilibrium(system, {"a": start}, free="a")
    branch = cw.continue_branch(problem, {"x": 0.0, "y": 0.0}, (-1.0, 1.0))
    points = branch.points
    (hopf,) = [point for point in branch.special_points if point.label == "HB"]
    assert hopf.parameters["a"] == pytest.approx(0.0, abs=1e-15)
    assert np.all(np.diff(points["s"]) >= 0.0)
    assert np.all(points["unstable"][: hopf.index] == 0)
    assert np.all(points["unstable"][hopf.index + 1 :] == 2)
