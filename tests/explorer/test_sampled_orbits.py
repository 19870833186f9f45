"""Straight lines between the instants that are taken are as near to the motion as they claim."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.explorer.sampling import sampled
from contwalk.workflow.stored.orbit_motions import Motion


def circle(radius, count=2000):
    times = np.linspace(0.0, 2.0 * np.pi, count)
    return Motion(times, radius * np.stack([np.cos(times), np.sin(times)], axis=1), (), 2.0 * np.pi)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3])
def test_lines_are_as_near_as_asked(tolerance):
    found = sampled([circle(1.0), circle(0.5)], tolerance, 1e-3)
    assert found.error <= tolerance
    assert len(found.times[0]) == len(found.times[1])
    for motion, times, states in zip([circle(1.0), circle(0.5)], found.times, found.states, strict=True):
        lines = np.stack([np.interp(motion.times, times, column) for column in states.T], axis=1)
        assert np.abs(lines - motion.states).max() <= tolerance * np.ptp(motion.states)
    # An arc of length h departs from its chord by h**2 / 8 of its radius, half the range: so many chords.
    assert len(found.times[0]) <= 1.6 * 2.0 * np.pi / np.sqrt(16.0 * tolerance) + 4


def test_more_instants_where_the_motion_bends():
    times = np.linspace(0.0, 1.0, 4001)
    motion = Motion(times, np.tanh((times - 0.3) / 0.01)[:, None], (), 1.0)
    found = sampled([motion], 1e-2, 1e-2)
    assert found.error <= 1e-2
    near = np.abs(found.times[0] - 0.3) < 0.05
    assert near.sum() > 0.5 * len(near)


def test_both_sides_of_an_event_are_kept():
    times = np.concatenate([np.linspace(0.0, 1.0, 50), np.linspace(1.0, 3.0, 50)])
    states = np.concatenate([np.linspace(0.0, 1.0, 50), np.linspace(-1.0, 0.0, 50)])[:, None]
    found = sampled([Motion(times, states, ((1.0, "hit"),), 3.0)], 1e-3, 1e-3)
    jump = np.flatnonzero(np.diff(found.times[0]) == 0.0)
    assert len(jump) == 1
    assert found.states[0][jump[0] : jump[0] + 2, 0].tolist() == [1.0, -1.0]


def test_events_that_come_at_once_leave_nothing_between_them():
    times = np.array([0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.5, 2.0])
    states = np.array([0.0, 0.5, 1.0, 5.0, 5.0, 0.0, 0.5, 1.0])[:, None]
    found = sampled([Motion(times, states, (), 2.0)], 1e-3, 1e-3)
    assert found.error <= 1e-3
    assert found.states[0].max() == 1.0


def test_an_orbit_that_has_just_been_born_is_no_reason_for_many_instants():
    rough = np.random.default_rng(1)
    small = circle(1e-9)
    noisy = Motion(small.times, small.states + 1e-9 * rough.normal(size=small.states.shape), (), small.period)
    alone, beside = sampled([circle(1.0)], 1e-2, 1e-2), sampled([noisy, circle(1.0)], 1e-2, 1e-2)
    assert len(beside.times[0]) <= len(alone.times[0])
