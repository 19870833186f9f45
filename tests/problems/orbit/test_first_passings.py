"""Where a state of an orbit first passes a value: on a circle that is gone round in two seconds."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from contwalk.problems.orbit.sampling import crossing

PERIOD = 2.0


def circle(share):
    turn = 2.0 * math.pi * np.asarray(share)
    return np.column_stack([np.cos(turn), np.sin(turn)])


CIRCLE = SimpleNamespace(states=2, duration=lambda z: PERIOD, curve=lambda z: SimpleNamespace(at=circle))


@pytest.mark.parametrize("value", [0.0, 0.5, -0.8])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_it_is_where_the_motion_is_and_goes_that_way(value, direction):
    shares = np.linspace(0.0, 1.0, 14)
    found = crossing(CIRCLE, np.zeros(3), PERIOD * shares, circle(shares), 1, value, direction)
    # On the way up the first state is that of the right half.
    assert found == pytest.approx([direction * math.sqrt(1.0 - value**2), value], abs=1e-14)


def test_an_orbit_that_begins_where_it_passes_passes_there():
    """Its end is before its beginning by rounding: between its instants there is no passing."""
    shares = np.linspace(0.0, 1.0, 14)
    states = circle(shares)
    assert states[-1, 1] < 0.0 <= states[0, 1]
    found = crossing(CIRCLE, np.zeros(3), PERIOD * shares, states, 1, 0.0, 1.0)
    np.testing.assert_array_equal(found, states[0])


def test_a_jump_from_the_end_to_the_beginning_is_no_passing():
    """An angle that goes round never comes back down to where it was."""
    shares = np.linspace(0.0, 1.0, 14)
    turning = np.column_stack([shares, 6.0 * shares])
    found = crossing(CIRCLE, np.zeros(3), PERIOD * shares, turning, 1, 3.0, -1.0)
    assert np.all(np.isnan(found))


def test_what_is_not_passed_has_no_state():
    shares = np.linspace(0.0, 1.0, 14)
    found = crossing(CIRCLE, np.zeros(3), PERIOD * shares, circle(shares), 1, 1.5, 1.0)
    assert np.all(np.isnan(found))
