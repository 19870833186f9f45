"""Impacts and switches where they are hard to see: grazing, crowded, late, on motions without error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_systems import BALL, COUNTERS, DAMPER, KICKS, STOP

from benchmarks.event_map import StepMap
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.system import Mode, Parameter, State, System, Transition

METHODS = ("dop853", "verner98", "radau9")


def machine(system, **values):
    return hybrid_machine(system, {**system.defaults(), **values})


def run(mover, x0, t1, *, t0=0.0, mode=None, tolerance=1e-11, method="dop853", weights=None, last=None):
    mode = mode or mover.system.modes[0].name
    weights = np.ones(len(mover.system.states)) if weights is None else np.array(weights)
    return list(motion_segments(mover, t0, np.array(x0), mode, t1, Control(tolerance, weights, method), last))


def times_of(found):
    return np.array([arc.times[-1] for arc in found if arc.transition is not None])


# -- grazing -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("depth", [1e-10, 1e-7, 1e-4])
def test_a_stop_that_is_just_reached(method, depth):
    found = run(machine(STOP, gap=1.0 - depth), [-1.0, 0.0], 4.0, tolerance=1e-13, method=method)
    assert [arc.transition for arc in found] == ["stop", None]
    # The path errs by some 1e-13; there the guard has the slope sqrt(2 depth).
    allowed = 1e-12 / math.sqrt(2.0 * depth)
    assert found[0].times[-1] == pytest.approx(math.pi - math.acos(1.0 - depth), abs=allowed)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("depth", [1e-9, 1e-6])
def test_a_stop_that_is_just_not_reached(method, depth):
    found = run(machine(STOP, gap=1.0 + depth), [-1.0, 0.0], 50.0, tolerance=1e-13, method=method)
    assert [arc.transition for arc in found] == [None]
    assert len(found[0].watched) == 16


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
def test_a_dip_within_one_step_of_a_motion_without_error(tolerance):
    # A parabola is integrated to rounding: at these tolerances in one step from 1 s before to 1 s after.
    mover = machine(BALL, e=1.0)
    depth = 1e-10
    found = run(mover, [5.0 - depth, -10.0], 2.5, tolerance=tolerance)
    assert [arc.transition for arc in found] == ["impact", None]
    upwards = System(
        "upwards",
        BALL.states,
        BALL.parameters,
        (Mode("flight", lambda t, x, p, dx: dx.__setitem__(slice(None), [x[1], p.g])),),
        BALL.transitions,
    )
    found = run(machine(upwards, e=1.0), [5.0 - depth, -10.0], 2.5, tolerance=tolerance)
    assert [arc.transition for arc in found] == ["impact", None]
    first = 1.0 - math.sqrt(depth / 5.0)
    assert found[0].times[-1] == pytest.approx(first, abs=1e-9)


# -- crowded -------------------------------------------------------------------------------------------------


def turns(t, x, p, dx):
    dx[0] = 1.0


def gap_of_teeth(t, x, p):
    return math.cos(p.teeth * x[0]) + 1.0 - p.depth


SHAFT = System(
    "shaft",
    (State("angle", period=2.0 * math.pi),),
    (Parameter("teeth", 40.0), Parameter("depth", 1e-3)),
    (Mode("turning", turns),),
    (Transition("tooth", "turning", "turning", gap_of_teeth, direction="both", role="watched"),),
)


@pytest.mark.parametrize("method", ["dop853", "verner98"])
@pytest.mark.parametrize("teeth", [7.0, 40.0, 123.0])
def test_the_teeth_of_a_shaft_that_turns_evenly(method, teeth):
    """Steps of any length have no error; each tooth makes the guard dip for one percent of its time."""
    found = run(machine(SHAFT, teeth=teeth), [0.0], 2.0 * math.pi, tolerance=1e-6, method=method)
    events = [event for arc in found for event in arc.watched]
    half = math.acos(1.0 - 1e-3) / teeth
    exact = [(2 * k + 1) * math.pi / teeth + side * half for k in range(int(teeth)) for side in (-1, 1)]
    assert len(events) == 2 * teeth
    np.testing.assert_allclose([event.time for event in events], exact, atol=1e-9)


@pytest.mark.drawn(1)
@pytest.mark.parametrize("method", ["dop853", "verner98"])
@pytest.mark.parametrize("half", [1.0, 0.125, 1.0 / 3.0])
def test_a_thousand_kicks_by_the_clock_through_which_one_step_could_go(method, half):
    found = run(machine(KICKS, half=half), [0.0], 1000.0 * half, tolerance=1e-6, method=method)
    np.testing.assert_allclose(times_of(found), half * (np.arange(1000) + 0.5), rtol=1e-13)


@pytest.mark.long
def test_fifty_impacts_in_each_of_a_hundred_periods_without_a_loss():
    found = run(
        machine(BALL, e=1.0), [0.0, 0.5 * 2.0 * math.pi / 50.0 * 10.0], 200.0 * math.pi, last="impact"
    )
    flights = 2.0 * math.pi / 50.0 * np.arange(1, len(found))
    assert len(found) >= 5000
    np.testing.assert_allclose(times_of(found), flights, rtol=1e-11)


def test_restitution_just_below_one_is_no_chatter():
    found = run(machine(BALL, e=0.999999), [0.0, 1e-3], 1.0, last="impact")
    assert found[-1].status == "ok"
    durations = 2e-4 * 0.999999 ** np.arange(len(found) - 1)
    np.testing.assert_allclose(times_of(found), np.cumsum(durations), rtol=1e-11)


@pytest.mark.parametrize("method", ["dop853", "verner98"])
@pytest.mark.parametrize("apart", [0.3, 1e-3, 1e-9, 0.0])
def test_the_first_of_two_feet_as_one_guard_with_a_kink(method, apart):
    def sinks(t, x, p, dx):
        dx[0] = x[2]
        dx[1] = x[2] - 1.0
        dx[2] = -1.0

    def lowest(t, x, p):
        return min(x[0], x[1])

    feet = System(
        "feet",
        (State("heel"), State("toe"), State("speed")),
        (),
        (
            Mode("falling", sinks),
            Mode("lying", lambda t, x, p, dx: dx.__setitem__(slice(None), [0.0, 0.0, 0.0])),
        ),
        (Transition("touch", "falling", "lying", lowest),),
    )
    # The heel is at zero at t = 2; the toe passes it when it is `apart` above the ground.
    found = run(machine(feet), [2.0, 4.0 - apart, 0.0], 3.0, method=method)
    exact = np.roots([-0.5, -1.0, 4.0 - apart]).max()
    assert [arc.transition for arc in found] == ["touch", None]
    assert found[0].times[-1] == pytest.approx(min(exact, 2.0), abs=1e-9)


# -- small, large, late --------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e6, 1e12])
def test_balls_of_any_size(size):
    found = run(machine(BALL, e=0.8, g=10.0 * size), [size, 0.0], 3.0, weights=[size, size], tolerance=1e-10)
    reference = run(machine(BALL, e=0.8), [1.0, 0.0], 3.0, tolerance=1e-10)
    assert len(found) == len(reference)
    np.testing.assert_allclose(times_of(found), times_of(reference), rtol=1e-12)


def test_a_ball_that_falls_late():
    # At t = 1e9 the time is known to 1e-7, and the ball to as much: impacts are not taken for penetrations.
    found = run(machine(BALL, e=1.0), [1.0, 0.0], 1e9 + 100.0, t0=1e9)
    fall = math.sqrt(0.2)
    exact = fall + 2.0 * fall * np.arange(len(found) - 1)
    assert found[-1].status == "ok"
    assert len(found) == 112 or len(found) == 113
    np.testing.assert_allclose(times_of(found) - 1e9, exact, atol=1e-4)


def test_two_events_one_rounding_apart_at_a_late_time():
    found = run(machine(COUNTERS), [0.5, 0.5 + 2e-10, 0.0], 1e6 + 0.7, t0=1e6)
    assert [arc.transition for arc in found] == ["a", "b", None]


@pytest.mark.parametrize("method", METHODS)
def test_a_one_sided_damper_that_is_stiff(method):
    found = run(machine(DAMPER, d=50.0), [-1.0, 0.0], 30.0, mode="extending", tolerance=1e-9, method=method)
    # It comes back creeping and does not turn again within the time.
    assert [arc.transition for arc in found] == ["turns_in", None]
    slow = 50.0 - math.sqrt(50.0**2 - 1.0)
    fast = 1.0 / slow
    exact = (fast * math.exp(-slow * (30.0 - math.pi)) - slow * math.exp(-fast * (30.0 - math.pi))) / (
        fast - slow
    )
    assert found[-1].states[-1][0] == pytest.approx(exact, rel=1e-7)


# -- the compiled way and the careful one --------------------------------------------------------------------


def random_machine(seed):
    """An oscillator between two stops whose places and restitution are random, one of them moving."""
    random = np.random.default_rng(seed)
    w, e1, e2 = random.uniform(0.5, 2.0), *random.uniform(0.3, 1.0, 2)
    right, left, swing = random.uniform(0.2, 0.9), -random.uniform(0.2, 0.9), random.uniform(0.0, 0.1)
    rate = random.uniform(1.0, 20.0)

    def moves(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -w * w * x[0] + math.cos(t)

    def to_the_right(t, x, p):
        return right + swing * math.sin(rate * t) - x[0]

    def bounces_right(t, x, p, x_plus):
        wall = swing * rate * math.cos(rate * t)
        x_plus[0] = x[0]
        x_plus[1] = wall - e1 * (x[1] - wall)

    def bounces_left(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = -e2 * x[1]

    return System(
        f"random{seed}",
        (State("x"), State("v")),
        (),
        (Mode("free", moves),),
        (
            Transition("right", "free", "free", to_the_right, reset=bounces_right),
            Transition("left", "free", "free", lambda t, x, p: x[0] - left, "falling", reset=bounces_left),
            Transition("middle", "free", "free", lambda t, x, p: x[0], "both", role="watched"),
        ),
    )


@pytest.mark.parametrize("seed", range(12))
def test_random_oscillators_between_stops(seed):
    mover = machine(random_machine(seed))
    fast = run(mover, [0.0, 0.5], 12.0, tolerance=1e-12)
    careful = run(mover, [0.0, 0.5], 12.0, tolerance=1e-12, method="verner98")
    count = min(len(fast), len(careful), 12)  # chaos makes more than that differ
    assert count > 3
    assert [arc.transition for arc in fast[:count]] == [arc.transition for arc in careful[:count]]
    times = [times_of(found[:count]) for found in (fast, careful)]
    np.testing.assert_allclose(*times, atol=1e-7)
    watched = [
        [event.time for arc in found[: count - 1] for event in arc.watched] for found in (fast, careful)
    ]
    np.testing.assert_allclose(*watched, atol=1e-7)


def test_the_derivative_beside_a_graze():
    # The speed at the stop is sqrt(2 depth): the map's derivative grows with its inverse.
    for depth in (1e-2, 1e-4, 1e-6):
        gap = 1.0 - depth
        step = StepMap(machine(STOP, gap=gap), "free", 1, np.ones(2))
        found = step.mapped(0.0, np.array([-1.0, 0.0]), 1e-13)
        speed = math.sqrt(1.0 - gap * gap)
        # x0 cos t = gap at the event, with x0 = -1.
        assert found.shift[0] == pytest.approx(gap / speed, rel=1e-9)
