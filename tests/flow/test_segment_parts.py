"""Motions piece by piece, and when they have settled."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from moving_systems import DECAY, EXPLOSION, OSCILLATOR

from contwalk.flow.compiled.traced import field_of
from contwalk.flow.events.guard import Guard
from contwalk.flow.events.motion import Machine, magnitudes, segment_parts
from contwalk.flow.events.settling import Settling


def machine(system, *values, guards=()):
    field, p = field_of(system), np.array(values, dtype=float)
    return Machine(field, p, field.constants(p), guards, system.modes[0].name)


def test_pieces_follow_each_other_and_end_on_time():
    mover = machine(OSCILLATOR, 1.0, 0.0, 0.5)
    parts = list(segment_parts(mover, 0.0, np.array([1.0, 0.0]), 100.0, 1e-12, np.ones(2)))
    assert len(parts) > 2
    for a, b in itertools.pairwise(parts):
        assert a.times[-1] == b.times[0]
        np.testing.assert_array_equal(a.states[-1], b.states[0])
    assert parts[-1].times[-1] == 100.0
    # 300 steps of local error 1e-12
    np.testing.assert_allclose(parts[-1].states[-1], [math.cos(100), -math.sin(100)], atol=1e-9)


def test_events_carry_the_state_on_both_sides_and_the_mode():
    guard = Guard(OSCILLATOR, "middle", lambda t, x, p: x[0], "falling")
    mover = machine(OSCILLATOR, 1.0, 0.0, 0.5, guards=[guard])
    (event,) = [
        e
        for part in segment_parts(mover, 0.0, np.array([1.0, 0.0]), 6.0, 1e-12, np.ones(2))
        for e in part.events
    ]
    assert (event.name, event.mode, event.rising) == ("middle", "swinging", False)
    np.testing.assert_array_equal(event.before, event.after)
    assert event.time == pytest.approx(math.pi / 2, abs=1e-10)


def test_a_motion_that_cannot_go_on_says_so():
    parts = list(segment_parts(machine(EXPLOSION), 0.0, np.array([1.0]), 2.0, 1e-8, np.ones(1)))
    assert parts[-1].status in ("not_finite", "step_too_small")
    assert parts[-1].times[-1] <= 1.0 + 1e-6  # x = 1 / (1 - t)


def test_magnitudes_are_those_declared_or_those_seen():
    mover = machine(OSCILLATOR, 10.0, 0.0, 0.5)
    seen = magnitudes(mover, 0.0, np.array([1.0, 0.0]), 10.0, (None, None), "dop853")
    np.testing.assert_allclose(seen, [1.0, 10.0], rtol=0.3)  # mean of |sin|, twice: 1.27, but not above 1
    given = magnitudes(mover, 0.0, np.array([1.0, 0.0]), 10.0, (None, 3.0), "dop853")
    assert given[1] == 3.0
    rest = magnitudes(mover, 0.0, np.zeros(2), np.inf, (None, None), "dop853")
    np.testing.assert_array_equal(rest, [1.0, 1.0])


def settled_after(wave, periods, most=200, steps=50):
    """After how many pieces of `steps` steps, four samples to a step of length 0.3, a motion has settled."""
    settling = Settling(periods)
    t = np.arange(4 * steps + 1) * 0.075
    for number in range(1, most):
        if settling.add(np.stack([f(t) for f in wave], axis=1), steps):
            return number
        t = t + 0.3 * steps
    return None


def test_a_periodic_motion_has_settled_and_a_growing_one_has_not():
    assert settled_after((np.sin, lambda t: np.sin(t) + 0.3 * np.cos(t / 2)), (None, None)) is not None
    assert settled_after((lambda t: np.exp(1e-4 * t) * np.sin(t),), (None,)) is None


def test_a_slow_approach_is_not_an_arrival():
    def slow(t):
        return 1.0 + np.exp(-1e-3 * t)

    number = settled_after((slow,), (None,), most=5000)
    assert number is not None
    assert math.exp(-1e-3 * 15.0 * number) < 1e-5  # what it is still away when it counts as settled


def test_an_angle_that_turns_round_is_not_looked_at():
    assert settled_after((lambda t: t, np.sin), (2 * math.pi, None)) is not None
    assert settled_after((lambda t: t, np.sin), (None, None)) is None


def test_decay_settles_at_rest():
    mover, settling = machine(DECAY, 1.0, 0.0), Settling((None, None))
    for part in segment_parts(mover, 0.0, np.array([1.0, 0.5]), np.inf, 1e-8, np.ones(2)):
        if settling.add(part.states, len(part.times) - 1):
            break
    assert abs(part.states[-1][0]) < 1e-6
