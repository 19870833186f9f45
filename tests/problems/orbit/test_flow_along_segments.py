"""The flow's direction where the segments of a closure start: all at once, and the same as one by one."""

from __future__ import annotations

import numpy as np
import pytest
from small_systems import circle, small_system

import contwalk as cw
from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.shooting import velocity


@pytest.fixture(scope="module")
def cut():
    """A circle in four segments, and its unknowns."""
    system = small_system(circle, ["x", "y"], {"mu": 0.49})
    settings = cw.Discretization(segments=4)
    orbit = cw.PeriodicOrbit(system, system.defaults(), "mu", discretization=settings).cut_into(4)
    angles = 0.5 * np.pi * np.arange(4)
    states = 0.7 * np.column_stack([np.cos(angles), np.sin(angles)])
    z = np.concatenate([states.ravel(), [2.0 * np.pi, 0.49]])
    return orbit.adapted_to(z, np.ones(len(z))), z


def test_all_directions_at_once_are_those_one_by_one(cut):
    orbit, z = cut
    found = monodromy.flow_directions(orbit, z)
    given = np.append(orbit.scalars(z), orbit.line.constants)
    each = [velocity(orbit.passages[0], x, 0.0, given) / orbit.duration(z) for x in orbit.starts(z)]
    assert found.tobytes() == np.array(each).tobytes()
    assert np.array_equal(monodromy.flow_direction(orbit, z, 0, 2), found[2])


def test_a_direction_that_does_not_exist_is_not_a_number_throughout(cut):
    orbit, z = cut
    broken = z.copy()
    broken[2] = np.inf
    found = monodromy.flow_directions(orbit, broken)
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2, 3]]).all()


def test_the_multiplier_of_a_circle_in_segments(cut):
    orbit, z = cut
    found = orbit.multipliers(z, orbit.linearize(z).jacobian)
    assert abs(found.values[0] - np.exp(-4.0 * np.pi * 0.49)) < 1e-9
