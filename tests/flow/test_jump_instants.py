"""Guards that jump at instants of time, simulated: each jump through zero in their direction is one event.

The states rest, so that all instants are known.
"""

from __future__ import annotations

import numpy as np
import pytest
from hybrid_runs import machine

from benchmarks.event_map import StepMap
from contwalk.flow.hybrid.motion_events import MotionEvents, Standpoint
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.system import Transition

T = 4e-4
PERIODS = 20
CONTROL = Control(1e-9, np.ones(2))


def rests(t, x, p, dx):
    dx[0] = dx[1] = 0.0


def counted(t, x, p, after):
    after[0], after[1] = x[0], x[1] + 1.0


def system(*guards):
    """Each guard with its direction leads back to the only mode, and counts."""
    transitions = [
        Transition(f"event{k}", "only", "only", guard, direction, reset=counted)
        for k, (guard, direction) in enumerate(guards)
    ]
    return machine(["level", "count"], {"height": 1.0}, {"only": rests}, transitions, period=lambda p: T)


def met(*guards, level=0.5, until=(PERIODS + 0.3) * T):
    """Numbers and instants, in periods, of the events of a motion."""
    run = hybrid_machine(system(*guards), {"height": 1.0})
    segments = motion_segments(run, 0.0, np.array([level, 0.0]), "only", until, CONTROL)
    found = [each for each in segments if each.transition is not None]
    assert [each.status for each in found] == ["ok"] * len(found)
    return [(int(each.transition[-1]), each.times[-1] / T) for each in found]


def sawtooth(t, x, p):
    return x[0] - (t / T) % p.height


def turned(t, x, p):
    return (t / T) % 1.0 - x[0]


def square(t, x, p):
    return x[0] - 1.0 - np.sign(np.sin(2.0 * np.pi * t / T))


def stairs(t, x, p):
    return x[0] - np.floor(4.0 * ((t / T) % 1.0)) / 3.0


def pulse(t, x, p):
    return x[0] - 1.0 + np.where(abs((t / T) % 1.0 - 0.3) < 0.004, 1.0, 0.0)


def triangle(t, x, p):
    return x[0] - 2.0 * abs((t / T) % 1.0 - 0.5)


def glimpse(t, x, p):
    return x[0] - 1.0 + np.where(np.sin(2.0 * np.pi * t / T) > 1.0 - 1e-11, 1.0, 0.0)


def gap(t, x, p):
    return x[0] - np.where(abs((t / T) % 1.0 - 0.3) > 1e-5, 1.0, 0.0)


def glimpsed(t, x, p):
    return x[0] - 1.0 + np.floor(1.0 + np.cos(2.0 * np.pi * t / T - 1.0) - p.height + 1e-9)


def peaked(t, x, p):
    return x[0] - np.interp(np.sin(2.0 * np.pi * t / T), [-1.0, 1.0 - 1e-9, 1.0], [0.0, 0.0, 1.0])


GLIMPSE = np.arccos(1.0 - 1e-11) / (2.0 * np.pi)
GLIMPSED = np.arccos(1.0 - 1e-9) / (2.0 * np.pi)
every = np.arange(PERIODS + 1)


@pytest.mark.drawn(8)
@pytest.mark.parametrize(
    ("guard", "direction", "phases"),
    [
        (sawtooth, "rising", [0.0]),
        (sawtooth, "falling", [0.5]),
        (sawtooth, "both", [0.0, 0.5]),
        (turned, "falling", [0.0]),
        (turned, "rising", [0.5]),
        (square, "rising", [0.5]),
        (square, "falling", [0.0]),
        (stairs, "falling", [0.5]),
        (stairs, "rising", [0.0]),
        (pulse, "rising", [0.296]),
        (pulse, "falling", [0.304]),
        (triangle, "rising", [0.25]),
        (triangle, "falling", [0.75]),
        (glimpse, "rising", [0.25 - GLIMPSE]),
        (glimpse, "falling", [0.25 + GLIMPSE]),
        (gap, "rising", [0.3 - 1e-5]),
        (peaked, "falling", [0.25 - np.arccos(1.0 - 0.5e-9) / (2.0 * np.pi)]),
        (glimpsed, "rising", [0.5 / np.pi - GLIMPSED]),
        (lambda t, x, p: 0.5 - (t / T) % 1.0, "rising", [0.0]),  # of time alone
    ],
)
def test_each_jump_in_its_direction_is_one_event(guard, direction, phases):
    assert_met(guard, direction, phases, PERIODS)


def test_jumps_are_met_where_the_ends_of_steps_may_lie_on_them():
    # 300 periods are 0.12, by rounding on either side of the jump.
    assert_met(sawtooth, "rising", [0.0], 310)


def assert_met(guard, direction, phases, periods):
    every = np.arange(periods + 1)
    expected = np.sort(np.concatenate([every + phase for phase in phases]))
    expected = expected[(expected > 0.0) & (expected <= periods + 0.3)]
    found = np.array([at for _, at in met((guard, direction), until=(periods + 0.3) * T)])
    assert len(found) == len(expected)
    assert np.abs(found - expected).max() < 1e-11


def test_a_jump_that_is_not_through_zero_is_none():
    assert met((lambda t, x, p: x[0] + 1.0 - (t / T) % 1.0, "both")) == []


def test_guards_that_jump_at_one_instant_all_happen_in_their_order():
    found = met(
        (sawtooth, "rising"), (turned, "falling"), (lambda t, x, p: 2.0 * sawtooth(t, x, p), "rising")
    )
    assert [number for number, _ in found] == [0, 1, 2] * PERIODS
    assert np.abs(np.array([at for _, at in found[::3]]) - every[1:]).max() < 1e-11


def test_what_jumps_where_a_clock_happens_follows_at_once():
    clock = (lambda t, x, p: np.sin(np.pi * t / T), "both")
    found = met(clock, (sawtooth, "rising"))
    assert sorted(number for number, _ in found) == [0] * PERIODS + [1] * PERIODS
    assert np.abs(np.array([at for _, at in found]) - np.repeat(every[1:], 2)).max() < 1e-11


def test_a_motion_goes_on_over_a_jump_at_which_it_was_left():
    run, found = hybrid_machine(system((sawtooth, "rising")), {"height": 1.0}), []
    t, x, last = 0.0, np.array([0.5, 0.0]), None
    for end in T * np.arange(1, 51):
        for each in motion_segments(run, t, x, "only", end, CONTROL, last, goes_on=last is None and t > 0.0):
            t, last = float(each.times[-1]), each.transition
            x = each.states[-1] if last is None else each.after
            found += [] if last is None else [t]
    assert np.abs(np.array(found) / T - np.arange(1, 1 + len(found))).max() < 1e-11
    assert len(found) in (49, 50)  # the last jump is met by who goes on


def test_maps_over_events_meet_each_jump():
    over = StepMap(hybrid_machine(system((pulse, "rising")), {"height": 1.0}), "only", 3, np.ones(2))
    assert over(0.0, np.array([0.5, 0.0]), 1e-9)[0] / T == pytest.approx(2.296, abs=1e-12)


def test_motions_event_by_event_meet_each_jump():
    run = hybrid_machine(system((sawtooth, "rising"), (turned, "falling")), {"height": 1.0})
    over = MotionEvents(run, CONTROL)
    found = list(over.events(Standpoint(0.0, "only", np.array([0.5, 0.0])), (PERIODS + 0.3) * T))
    assert [name for name, _ in found] == ["event0", "event1"] * PERIODS
    assert np.abs(np.array([at for _, at in found[::2]]) / T - every[1:]).max() < 1e-11
