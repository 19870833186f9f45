"""What an orbit's equations are solved to is little beside the error of the steps that they are made of."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.problems.initial.orbit_from_state import orbit_at
from contwalk.problems.parameter_line import ParameterLine


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8])
@pytest.mark.parametrize("segments", [1, 3])
def test_a_residual_that_counts_as_none_changes_no_digit_of_the_error(segments, accuracy):
    """Errors are told with two digits: a hundredth of them is not seen."""
    system = small_system(circle, "xy", {"mu": 1.0})
    chosen = cw.Discretization(segments=segments, accuracy=accuracy)
    line = ParameterLine.of(system, system.defaults(), "mu")
    problem, z = orbit_at(system, line, None, np.array([1.0, 0.0]), 2.0 * math.pi, discretization=chosen)
    solved_to, errors = problem.linearize(z).levels[0], problem.errors_at(z)
    ends = [row for segment in problem.layout.segments for row in np.r_[segment.ends]]
    assert len(ends) == 2 * segments
    assert np.all(solved_to[ends] > 0.0)
    assert np.all(solved_to[ends] <= 0.01 * errors[ends])
