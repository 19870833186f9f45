"""What is known of the cycle that a branch begins with, and marked along it."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.errors import StartError


@pytest.fixture(scope="module")
def hopf():
    """The rest state of circles of radius sqrt(mu), born at mu = 0."""
    system = small_system(circle, ("x", "y"), {"mu": 0.5})
    rest = cw.Equilibrium(system, system.defaults(), "mu")
    return rest, cw.continue_branch(rest, [0.0, 0.0], range=(-0.5, 1.0))


def test_extremes_of_cycles_are_marked_where_they_are_born_of_equilibria(hopf):
    rest, start = hopf
    cycles = cw.switch_branch(rest, start, "HB1", range=(-0.5, 1.0), marks={"amp:x": [0.5], "max:y": [0.8]})
    found = [point.parameters["mu"] for point in cycles.special_points if point.label == "UZ"]
    # x = sqrt(mu) cos t: located to the accuracy of 1e-8, by default.
    np.testing.assert_allclose(found, [0.25, 0.64], rtol=1e-7)
    with pytest.raises(StartError, match="'amp:z' is not watched along the branch"):
        cw.switch_branch(rest, start, "HB1", range=(-0.5, 1.0), marks={"amp:z": [0.5]})


def test_no_error_is_told_of_the_row_at_which_a_branch_is_born(hopf):
    rest, start = hopf
    cycles = cw.switch_branch(rest, start, "HB1", range=(-0.5, 1.0), max_points=5)
    # The equations are singular at the birth: what they told there was 1e18 and the like.
    assert np.isnan(cycles["error"][0])
    assert np.all(cycles["error"][1:] < 1e-3)
    assert np.isfinite(start["error"]).all()
