"""Events on motions that are known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from moving_systems import OSCILLATOR

from contwalk.flow import METHODS, adaptive
from contwalk.flow.compiled.traced import field_of
from contwalk.flow.events.crossings import crossings
from contwalk.flow.events.guard import Guard

FIELD = field_of(OSCILLATOR)
EPSILON = np.finfo(float).eps


def above(t, x, p):
    return x[0] - p.level


def watch(function=above, direction="both"):
    return Guard(OSCILLATOR, "watched", function, direction)


def path(level, t1, *, x0=(1.0, 0.0), tolerance=1e-12, method="dop853", t0=0.0):
    """x = cos t from t = 0, with its parameters."""
    p = np.array([1.0, 0.0, level])
    c = FIELD.constants(p)
    return p, c, adaptive(FIELD, c, t0, np.array(x0), t1, tolerance, np.ones(2), method)


def found(level, t1, *guards, **options):
    method = options.get("method", "dop853")
    leaving = options.pop("leaving", {})
    p, c, made = path(level, t1, **options)
    return crossings(FIELD, c, p, made.times, made.states, guards, method, leaving), made


@pytest.mark.parametrize("method", METHODS)
def test_crossings_are_where_they_are_and_the_guard_is_zero_there(method):
    events, made = found(0.5, 20.0, watch(), method=method)
    exact = sorted(
        t
        for k in range(4)
        for t in (2 * math.pi * k + math.pi / 3, 2 * math.pi * (k + 1) - math.pi / 3)
        if t < 20
    )
    # Local errors of 1e-12 in each step add up, from 15 steps to 1399; the slope of the guard is 0.87.
    np.testing.assert_allclose([e.time for e in events], exact, rtol=0, atol=1e-12 * len(made.times))
    assert [e.rising for e in events] == [k % 2 == 1 for k in range(len(exact))]
    for event in events:
        # Newton's method ends within the rounding of x, and of the time, at a slope of 0.87.
        assert abs(event.state[0] - 0.5) <= 2 * EPSILON * (1.0 + event.time)
        assert event.rate == -event.state[1] or event.rate == event.state[1]


def test_two_crossings_within_one_step_are_both_found():
    level = 1.0 - 1e-6
    events, made = found(level, 10.0, watch(), tolerance=1e-8)
    inside = math.acos(level)  # 1.4e-3: a small part of a step
    assert np.diff(made.times).min() > 4 * inside or len(made.times) < 40
    turn = 2.0 * math.pi
    exact = [inside, turn - inside, turn + inside]
    # Global error of the path 1e-7; at the level the guard's slope is 1.4e-3.
    np.testing.assert_allclose([e.time for e in events], exact, rtol=0, atol=1e-3)
    assert [e.rising for e in events] == [False, True, False]
    assert events[1].step == events[2].step or events[1].step + 1 == events[2].step


@pytest.mark.parametrize("excess", [1e-6, 1e-9])
def test_a_guard_that_only_comes_near_has_no_event(excess):
    events, _ = found(-1.0 - excess, 20.0, watch())
    assert events == []


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_a_guard_that_dips_below_zero_has_two(depth):
    events, _ = found(-1.0 + depth, 5.0, watch())
    half = math.acos(1.0 - depth)
    # The guard is flat there: an error e of the path moves a crossing by e / slope, the slope being `half`.
    np.testing.assert_allclose(
        [e.time for e in events], [math.pi - half, math.pi + half], rtol=0, atol=1e-10 / half + 1e-10
    )


@pytest.mark.parametrize(("direction", "rising"), [("rising", True), ("falling", False)])
def test_only_crossings_in_the_wanted_direction_count(direction, rising):
    events, _ = found(0.5, 12.0, watch(direction=direction))
    assert len(events) == 2
    assert {e.rising for e in events} == {rising}


def test_a_motion_that_begins_on_its_guard_has_no_event_there():
    events, _ = found(1.0, 6.0, watch())  # x = level at t = 0, falling
    assert events == []
    events, _ = found(0.0, 6.0, watch(), x0=(0.0, 1.0))
    assert len(events) == 1
    assert events[0].time == pytest.approx(math.pi, abs=1e-10)


@pytest.mark.parametrize("noise", [1e-17, -1e-17])
def test_after_its_own_event_a_guard_has_the_sign_it_leaves_with(noise):
    events, _ = found(0.0, 3.0, watch(), x0=(noise, 1.0), leaving={0: 1})
    assert events == []
    events, _ = found(0.0, 4.0, watch(), x0=(noise, 1.0), leaving={0: 1})
    assert [e.rising for e in events] == [False]


def test_a_crossing_on_a_node_of_the_path_is_found_once():
    p, c, made = path(0.0, 10.0)
    node = float(made.states[5][0])
    p[2] = node
    c = FIELD.constants(p)
    events = crossings(FIELD, c, p, made.times, made.states, [watch()], "dop853")
    assert sum(abs(e.time - made.times[5]) < 1e-6 for e in events) == 1


def test_a_guard_may_depend_on_time():
    events, _ = found(0.0, 4.0, watch(lambda t, x, p: t - 1.5))
    assert [e.time for e in events] == [1.5]
    assert events[0].rate == 1.0


def test_events_of_several_guards_are_in_the_order_of_time():
    events, _ = found(0.5, 7.0, watch(), watch(lambda t, x, p: x[1]))
    assert [e.guard for e in events] == [0, 1, 0, 1]
    times = [e.time for e in events]
    assert times == sorted(times)
    np.testing.assert_allclose(
        times, [math.pi / 3, math.pi, 5 * math.pi / 3, 2 * math.pi], rtol=0, atol=1e-10
    )


def test_pieces_of_a_path_have_the_events_of_the_whole():
    p, c, made = path(0.5, 20.0)
    whole = crossings(FIELD, c, p, made.times, made.states, [watch()], "dop853")
    half = len(made.times) // 2
    parts = [slice(0, half + 1), slice(half, None)]
    pieces = [
        e for s in parts for e in crossings(FIELD, c, p, made.times[s], made.states[s], [watch()], "dop853")
    ]
    assert [e.time for e in pieces] == [e.time for e in whole]


def test_no_guard_and_no_step_give_no_event():
    p, c, made = path(0.5, 1.0)
    assert crossings(FIELD, c, p, made.times, made.states, [], "dop853") == []
    assert crossings(FIELD, c, p, made.times[:1], made.states[:1], [watch()], "dop853") == []


def test_a_guard_knows_its_value_its_rate_and_its_rounding():
    guard = watch(lambda t, x, p: x[0] * x[1] - t * t)
    p, x, t = np.array([2.0, 0.25, 0.0]), np.array([0.5, 3.0]), 1.5
    value, rate, noise = guard(t, x, p)
    slope = -4.0 * 0.5 - 0.5 * 3.0  # dv/dt
    assert value == 0.5 * 3.0 - 2.25
    assert rate == 3.0 * 3.0 + 0.5 * slope - 2.0 * t
    assert 2.0 * EPSILON < noise < 20.0 * EPSILON
    with pytest.raises(ValueError, match="1 times"):
        guard(t, x[:1], p)
