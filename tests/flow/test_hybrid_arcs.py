"""Motions with impacts and switches that are known in closed form."""

from __future__ import annotations

import inspect
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hybrid_systems import BALL, CHANGING, COUNTERS, DAMPER, KICKS, STOP, SWAP

from contwalk.errors import StartError, SystemDefinitionError
from contwalk.flow import METHODS, along
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import applied, hybrid_machine, motion_segments
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.system import Mode, Parameter, State, System, Transition

EPSILON = np.finfo(float).eps


def machine(system, **values):
    return hybrid_machine(system, {**system.defaults(), **values})


def run(mover, x0, t1, *, t0=0.0, mode=None, tolerance=1e-11, method="dop853", just_after=None):
    weights = np.ones(len(mover.system.states))
    mode = mode or mover.system.modes[0].name
    control = Control(tolerance, weights, method)
    return list(motion_segments(mover, t0, np.array(x0), mode, t1, control, just_after))


def times_of(found):
    return np.array([arc.times[-1] for arc in found if arc.transition is not None])


# -- one arc after the other ---------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_a_ball_hits_the_floor_when_it_must(method):
    found = run(machine(BALL, e=0.8), [1.0, 0.0], 3.0, method=method)
    fall = math.sqrt(2.0 / 10.0)
    exact = [fall + 2 * fall * sum(0.8**j for j in range(1, k + 1)) for k in range(len(found) - 1)]
    # Parabolas are integrated to rounding, and each impact adds some of it.
    np.testing.assert_allclose(times_of(found), exact, rtol=0, atol=1e-13)
    for arc in found[:-1]:
        assert arc.transition == "impact"
        assert not arc.rising
        np.testing.assert_array_equal(arc.after, [arc.states[-1][0], -0.8 * arc.states[-1][1]])
    for a, b in itertools.pairwise(found):
        assert b.times[0] == a.times[-1]
        np.testing.assert_array_equal(b.states[0], a.after)
    last = found[-1]
    assert (last.transition, last.after, last.status, last.times[-1]) == (None, None, "ok", 3.0)


@pytest.mark.parametrize("method", METHODS)
def test_the_states_of_an_arc_are_those_of_its_steps(method):
    mover = machine(STOP, e=0.7)
    for arc in run(mover, [-1.0, 0.0], 10.0, method=method, tolerance=1e-8):
        flow = mover.mode("free")
        again = along(flow.field, flow.c, arc.times, arc.states[0], method)
        # An implicit step's equations are solved from a guess that the step before has left.
        allowed = 4 * EPSILON if method.startswith("radau") else 0.0
        np.testing.assert_allclose(arc.states, again, rtol=0, atol=allowed)


@pytest.mark.parametrize("restitution", [1.0, 0.999999])
def test_a_hundred_impacts_with_hardly_a_loss(restitution):
    found = run(machine(BALL, e=restitution), [0.0, 1.0], 20.0, just_after="impact")
    assert len(found) == 100 + (restitution < 1)
    exact = 0.2 * np.cumsum(restitution ** np.arange(len(found) - 1))
    np.testing.assert_allclose(times_of(found), exact, rtol=0, atol=1e-12)


def test_an_impact_that_grazes_is_not_missed_however_long_the_steps():
    depth = 1e-10
    mover = machine(STOP, gap=1.0 - depth)
    for tolerance in (1e-3, 1e-6, 1e-12):
        amplitude = 1.0
        found = run(mover, [-amplitude, 0.0], 4.0, tolerance=tolerance)
        assert [arc.transition for arc in found] == ["stop", None] or tolerance > 1e-8
    # Where the error of the steps is far below the depth, the instant is that of the closed form.
    at = math.pi - math.acos(1.0 - depth)
    speed = math.sqrt(2.0 * depth)
    assert found[0].times[-1] == pytest.approx(at, abs=1e-11 / speed)


@pytest.mark.parametrize("depth", [1e-10, 1e-8, 1e-4])
def test_a_grazing_impact_of_an_exact_path_is_found(depth):
    """A parabola is integrated without error in steps of any length; the ball just gets to the ceiling."""
    bounce = BALL.transitions[0].reset
    ceiling = System(
        "ceiling",
        states=BALL.states,
        parameters=BALL.parameters,
        modes=BALL.modes,
        transitions=(Transition("touch", "flight", "flight", lambda t, x, p: p.floor - x[0], reset=bounce),),
    )
    mover = machine(ceiling, e=1.0, floor=5.0 - depth)
    found = run(mover, [0.0, 10.0], 50.0, tolerance=1e-3)
    first = 1.0 - math.sqrt(depth / 5.0)
    assert found[0].transition == "touch"
    # Heights near 5 are known to some 1e-14; the slope of the guard is 10 (1 - first).
    assert found[0].times[-1] == pytest.approx(first, abs=3e-14 / (10.0 * (1.0 - first)))
    assert len(found) == 2


def test_a_guard_on_a_motion_without_error_is_resolved():
    # The field is zero: error control of the states alone would take one step through a thousand kicks.
    mover = machine(KICKS)
    found = run(mover, [0.0], 1000.0, tolerance=1e-8)
    np.testing.assert_allclose(times_of(found), np.arange(1000) + 0.5, rtol=4 * EPSILON)
    assert found[-1].states[-1][0] == 1000.0


def test_fifty_impacts_per_period_on_a_moving_table():
    period = 2.0 * math.pi
    mover = machine(BALL, e=1.0, g=100.0, a=1e-3, omega=1.0)
    flight = period / 50.0
    found = run(mover, [0.0, 0.5 * 100.0 * flight], 3 * period, just_after="impact")
    assert 145 <= len(found) <= 155
    for arc in found[:-1]:
        begin, end, (y, v) = arc.times[0], arc.times[-1], arc.states[0]
        duration = end - begin
        np.testing.assert_allclose(
            arc.states[-1], [y + v * duration - 50.0 * duration**2, v - 100.0 * duration], atol=1e-12
        )
        assert abs(arc.states[-1][0] - 1e-3 * math.sin(end)) < 1e-13  # 6 m/s times the rounding of t = 20
        inside = np.linspace(0.0, duration, 1000)[1:-1]
        assert (y + v * inside - 50.0 * inside**2 > 1e-3 * np.sin(begin + inside)).all()


def test_a_fast_table_under_a_high_flight_is_not_passed_through():
    mover = machine(BALL, e=0.0, a=0.01, omega=400.0)
    found = run(mover, [10.0, 0.0], 2.0, tolerance=1e-6)
    at = found[0].times[-1]
    times = np.linspace(0.0, at, 2_000_001)[:-1]
    assert (10.0 - 5.0 * times**2 > 0.01 * np.sin(400.0 * times)).all()
    assert 10.0 - 5.0 * at**2 == pytest.approx(0.01 * math.sin(400.0 * at), abs=1e-13)


# -- several transitions -------------------------------------------------------------------------------------


def test_two_events_a_picosecond_apart_are_two():
    found = run(machine(COUNTERS), [0.5, 0.5 + 1e-12, 0.0], 0.7)
    assert [arc.transition for arc in found] == ["a", "b", None]
    assert found[1].times[-1] - found[0].times[-1] == pytest.approx(1e-12, abs=4 * EPSILON)
    found = run(machine(COUNTERS), [0.5 + 1e-12, 0.5, 0.0], 0.7)
    assert [arc.transition for arc in found] == ["b", "a", None]


@pytest.mark.parametrize("apart", [0.0, 5e-17, -5e-17])
def test_of_two_events_at_once_the_one_declared_first_happens_first(apart):
    found = run(machine(COUNTERS), [0.5, 0.5 + apart, 0.0], 0.7)
    assert [arc.transition for arc in found] == ["a", "b", None]
    assert len(found[1].times) == 1
    assert found[1].times[0] == found[0].times[-1]
    np.testing.assert_allclose(found[-1].states[-1], [0.8, 1.8, 1.0], atol=1e-14)


@pytest.mark.parametrize(("level", "expected"), [(True, ["a", "b", None]), (False, ["a", None])])
def test_a_guard_that_a_reset_carries_past_zero_happens_at_once_where_that_is_declared(level, expected):
    def steps_down(t, x, p, x_plus):
        x_plus[0] = 1.0
        x_plus[1] = x[1] - 5.0
        x_plus[2] = x[2]

    first, second = COUNTERS.transitions
    system = System(
        "pushed",
        COUNTERS.states,
        (),
        COUNTERS.modes,
        (
            Transition("a", first.source, first.target, first.guard, reset=steps_down),
            replace(second, level=level),
        ),
    )
    found = run(machine(system), [0.5, 3.0, 0.0], 0.7)
    assert [arc.transition for arc in found] == expected
    counted = 1.8 if level else 3.0 - 5.0 - 0.7
    np.testing.assert_allclose(found[-1].states[-1][:2], [0.8, counted], atol=1e-14)


@pytest.mark.parametrize("method", ["dop853", "radau5"])
@pytest.mark.parametrize("height", [-3e-6, -0.1])
def test_a_guard_below_zero_and_rising_falls_through_zero_later(height, method):
    """A ball that its reset puts below the floor, going up with speed 1: it comes up, and down again."""

    def throws(t, x, p, after):
        after[0] = height
        after[1] = math.sqrt(1.0 - 20.0 * height)  # 1 where it passes the floor

    (bounce,) = BALL.transitions
    system = replace(BALL, transitions=(replace(bounce, reset=throws),))
    found = run(machine(system), [0.0, 1.0], 3.0, method=method, just_after="impact", tolerance=1e-12)
    below = (math.sqrt(1.0 - 20.0 * height) - 1.0) / 10.0
    exact = 0.2 + (0.2 + below) * np.arange(len(found) - 1)
    assert len(found) > 5
    np.testing.assert_allclose(times_of(found), exact, rtol=0, atol=1e-9)


def test_a_kick_where_a_pendulum_passes_zero_needs_no_mode_of_its_own():
    """The kick carries it past zero, and on: the guard has to come back before it can fall again."""

    def kick(t, x, p, after):
        after[0] = x[0] - 0.2
        after[1] = x[1]

    stop = STOP.transitions[0]
    swings = replace(
        STOP,
        transitions=(Transition("kick", stop.source, stop.target, lambda t, x, p: x[0], reset=kick),),
    )
    found = run(machine(swings), [1.0, 0.0], 12.0)
    assert times_of(found)[0] == pytest.approx(0.5 * math.pi, abs=1e-9)
    # From (-0.2, -1) the circle is round again after the angle to (0, -r) of a whole turn.
    turn = 2.0 * math.pi - math.atan2(0.2, 1.0)
    assert times_of(found)[1] - times_of(found)[0] == pytest.approx(turn, abs=1e-9)


def test_soft_transitions_of_a_one_sided_damper():
    d = 0.1
    found = run(machine(DAMPER, d=d), [-1.0, 0.0], 20.0, mode="extending", tolerance=1e-13)
    turn = math.sqrt(1.0 - d * d)
    factor = math.exp(-d * math.pi / turn)
    exact = np.cumsum([math.pi, math.pi / turn] * 4)[: len(found) - 1]
    np.testing.assert_allclose(times_of(found), exact, rtol=0, atol=1e-11)
    ends = [arc.states[-1][0] for arc in found[:-1]]
    np.testing.assert_allclose(ends, [1, -factor, factor, -(factor**2), factor**2, -(factor**3)], atol=1e-11)
    assert [arc.mode for arc in found[:3]] == ["extending", "compressing", "extending"]
    for arc in found[:-1]:
        np.testing.assert_array_equal(arc.after, arc.states[-1])


def test_modes_have_states_of_their_own():
    found = run(machine(CHANGING), [7.0, 1.0, 7.0], 9.0)  # what does not exist is not looked at
    leaks, flies = math.log(2.0), 2.0
    exact = np.cumsum([leaks, flies] * 4)[: len(found) - 1]
    np.testing.assert_allclose(times_of(found), exact, rtol=0, atol=1e-9)
    for arc in found:
        absent = [0, 2] if arc.mode == "leaking" else [1]
        assert not arc.states[:, absent].any()
    np.testing.assert_allclose(found[0].after, [0.0, 0.0, 2.0], atol=1e-10)
    np.testing.assert_array_equal(found[1].after, [0.0, 1.0, 0.0])


def test_names_are_swapped_after_the_reset():
    found = run(machine(SWAP), [0.5, 0.25], 3.0)
    start, expected = np.array([0.5, 0.25]), []
    for _ in found[:-1]:
        duration = 1.0 - start[0]
        start = np.array([start[1] * math.exp(-duration), 1.0])
        expected.append(start)
    np.testing.assert_allclose([arc.after for arc in found[:-1]], expected, atol=1e-9)


def test_watched_transitions_are_reported_and_do_nothing():
    found = run(machine(STOP, gap=0.5), [-1.0, 0.0], 6.0)
    events = [event for arc in found for event in arc.watched]
    assert {event.name for event in events} == {"middle"}
    # It passes the middle after a quarter turn, hits the stop 30 degrees later, and turns back there.
    exact = math.pi * np.array([1 / 2, 1 / 2 + 1 / 3, 3 / 2 + 1 / 3])
    np.testing.assert_allclose([event.time for event in events], exact, atol=1e-10)
    assert [event.rising for event in events] == [True, False, True]
    np.testing.assert_array_equal(events[0].before, events[0].after)


def test_applied_is_reset_and_relabelling():
    np.testing.assert_array_equal(
        applied(machine(SWAP), SWAP.transition("full"), 0.0, np.array([1.0, 0.5])), [0.5, 1.0]
    )
    np.testing.assert_array_equal(
        applied(machine(CHANGING), CHANGING.transition("empty"), 0.0, [9.0, 0.5, 9.0]), [0.0, 0.0, 2.0]
    )


# -- where it begins -----------------------------------------------------------------------------------------


def test_a_start_past_a_guard_is_no_event():
    (fall,) = run(machine(BALL), [-0.5, 0.0], 1.0)
    assert (fall.transition, fall.status) == (None, "ok")


def test_a_start_past_a_guard_that_does_not_come_back_is_refused():
    ball = machine(BALL)
    with pytest.raises(StartError, match=r"'impact' is -0.5 at the start") as caught:
        past_zero(ball, 0.0, np.array([-0.5, 0.0]), "flight", np.ones(2))
    assert "at: impact" in caught.value.remedy
    assert "positive" in caught.value.remedy
    assert "falls through zero" in past_zero(ball, 0.0, np.array([-0.5, 4.0]), "flight", np.ones(2))
    assert past_zero(ball, 0.0, np.array([0.0, 1.0]), "flight", np.ones(2)) == ""


def test_a_start_on_a_guard_leaves_it_or_passes_it_at_once():
    leaving = run(machine(BALL), [0.0, 1.0], 0.1)
    assert [arc.transition for arc in leaving] == [None]
    hitting = run(machine(BALL), [0.0, -1.0], 0.01)
    assert [arc.transition for arc in hitting] == ["impact", None]
    assert len(hitting[0].times) == 1
    np.testing.assert_array_equal(hitting[0].after, [0.0, 0.5])


def test_rounding_at_the_start_is_no_side():
    found = run(machine(BALL, floor=0.1 + 0.2), [0.3, 1.0], 0.1)  # 0.3 - (0.1 + 0.2) = -5.6e-17
    assert [arc.transition for arc in found] == [None]


# -- release from rest ---------------------------------------------------------------------------------------


def released(order: int, direction: str) -> System:
    """A chain of integrators that is held at zero until sin t > f, which drives the last one.

    When it is let go, the first state and so many of its derivatives are zero: sin t = f just then.
    """

    def slide(t, x, p, dx):
        for i in range(order - 1):
            dx[i] = x[i + 1]
        dx[order - 1] = np.sin(t) - p.f

    def stick(t, x, p, dx):
        for i in range(order):
            dx[i] = 0.0 * x[i]

    def stop(t, x, p, after):
        after[0] = x[0]  # zero but for rounding
        for i in range(1, order):
            after[i] = 0.0 * x[i]

    return System(
        "released",
        tuple(State(f"x{i}") for i in range(order)),
        (Parameter("f", 0.5),),
        (Mode("slide", slide), Mode("stick", stick)),
        transitions=(
            Transition("stop", "slide", "stick", lambda t, x, p: x[0], direction, stop),
            Transition("go", "stick", "slide", lambda t, x, p: np.sin(t) - p.f, "rising", level=True),
        ),
    )


@pytest.mark.drawn(12)
@pytest.mark.parametrize("direction", ["falling", "both"])
@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("f", np.linspace(0.15, 0.95, 5).tolist())
def test_what_was_held_leaves_although_its_speed_and_acceleration_are_zero(order, f, direction):
    """The first derivative that is not zero is that of order + 1, cos t > 0: rounding is no sign."""
    start = math.asin(f)

    def repeated(n: int, t: float) -> float:  # integral of the sine
        return math.sin(t - 0.5 * n * math.pi)

    def place(t: float) -> float:
        """The first state: the force integrated as often as there are states."""
        own = f * (t - start) ** order / math.factorial(order)
        early = sum(repeated(order - k, start) * (t - start) ** k / math.factorial(k) for k in range(order))
        return repeated(order, t) - early - own

    found = run(machine(released(order, direction), f=f), [0.0] * order, 60.0, mode="stick")
    assert {leg.status for leg in found} == {"ok"}
    for held, leg in itertools.pairwise(found):
        if held.transition != "go" or held.times[0] == held.times[-1]:
            continue
        turns = 2.0 * math.pi * round((held.times[-1] - start) / (2.0 * math.pi))
        assert held.times[-1] - turns == pytest.approx(start, abs=1e-12)
        last = float(leg.times[-1]) - turns
        assert last > start + 0.5
        # The tolerance is 1e-11 a step, in units of 1 for each state.
        room = 1e-9 * last**order
        assert leg.states[-1][0] == pytest.approx(place(last), abs=room)
        assert leg.transition is None or abs(place(last)) <= room
        between = np.linspace(start + 0.4, last - 0.01, 50)
        assert min(place(float(t)) for t in between) > 0.0


# -- what cannot go on ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("restitution", "floor", "error"), [
    (0.5, 0.0, 1e-14), (0.9, 0.0, 1e-12), (0.99, 0.0, 1e-9), (1e-9, 0.0, 1e-15),
    (0.5, 1.0, 1e-9), (0.9, -3.0, 1e-8),
])  # fmt: skip
def test_chatter_is_named_with_the_instant_at_which_it_ends(restitution, floor, error):
    found = run(machine(BALL, e=restitution, floor=floor), [floor + 1.0, 0.0], 1000.0)
    fall = math.sqrt(0.2)
    exact = fall + 2.0 * fall * restitution / (1.0 - restitution)
    last = found[-1]
    assert last.status == "chatter"
    assert last.accumulation == pytest.approx(exact, abs=error * exact)
    assert f"{last.accumulation:.15g}" in last.reason
    assert "must declare a mode" in last.reason


def test_a_ball_that_keeps_its_speed_long_is_no_chatter():
    found = run(machine(BALL, e=0.999), [0.0, 1e-3], 0.1, just_after="impact")
    assert found[-1].status == "ok"
    assert len(found) > 500


@pytest.mark.parametrize("floor", [0.0, 1.0])
def test_without_restitution_the_ball_stays(floor):
    found = run(machine(BALL, e=0.0, floor=floor), [1.0 + floor, 0.0], 10.0)
    assert [arc.status for arc in found] == ["sticking"]
    assert found[0].transition == "impact"
    assert "must declare a mode" in found[0].reason
    np.testing.assert_allclose(found[0].after, [floor, 0.0], atol=1e-15)


def test_without_restitution_a_mass_that_its_spring_pulls_back_leaves():
    found = run(machine(STOP, e=0.0, gap=0.5), [-1.0, 0.0], 20.0, tolerance=1e-13)
    assert [arc.status for arc in found] == ["ok"] * len(found)
    hit = math.pi - math.acos(0.5)
    # It starts from the stop at rest, and comes back at rest after a whole turn.
    np.testing.assert_allclose(times_of(found)[:1], hit, atol=1e-11)
    assert found[1].times[-1] == pytest.approx(20.0)
    t = found[1].times
    np.testing.assert_allclose(found[1].states[:, 0], 0.5 * np.cos(t - hit), atol=1e-10)


def test_a_reset_that_does_not_leave_its_guard_is_named():
    kicked = System(
        "kicked",
        BALL.states,
        BALL.parameters,
        BALL.modes,
        (Transition("through", "flight", "flight", BALL.transitions[0].guard, level=True),),
    )
    found = run(machine(kicked), [1.0, 0.0], 10.0)
    assert found[-1].status == "sticking"
    assert "'through'" in found[-1].reason
    assert "correct the reset" in found[-1].reason


def test_modes_that_hand_over_to_each_other_forever_are_named():
    def right(t, x, p, dx):
        dx[0] = -1.0

    def left(t, x, p, dx):
        dx[0] = 1.0

    sliding = System(
        "sliding",
        (State("x"),),
        (),
        (Mode("right", right), Mode("left", left)),
        (
            Transition("to_left", "right", "left", lambda t, x, p: x[0]),
            Transition("to_right", "left", "right", lambda t, x, p: x[0], "rising"),
        ),
    )
    found = run(machine(sliding), [1.0], 10.0)
    assert found[-1].status == "sticking"
    assert found[-1].times[-1] == pytest.approx(1.0)
    assert "without any time between them" in found[-1].reason


def test_a_rocking_block_comes_to_rest_by_impacts_on_both_sides():
    def tips_right(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = -1.0

    def tips_left(t, x, p, dx):
        dx[0] = x[1]
        dx[1] = 1.0

    def slower(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = 0.5 * x[1]

    block = System(
        "block",
        (State("angle"), State("rate")),
        (),
        (Mode("right", tips_right), Mode("left", tips_left)),
        (
            Transition("down_right", "right", "left", lambda t, x, p: x[0], reset=slower),
            Transition("down_left", "left", "right", lambda t, x, p: x[0], "rising", reset=slower),
        ),
    )
    found = run(machine(block), [0.5, 0.0], 10.0, mode="right")
    assert found[-1].status == "chatter"
    assert found[-1].accumulation == pytest.approx(1.0 + 2.0, abs=1e-13)


def test_a_field_that_ends_is_named():
    def blows_up(t, x, p, dx):
        dx[0] = x[0] * x[0]

    system = System("up", (State("x"),), (), (Mode("up", blows_up),), (
        Transition("never", "up", "up", lambda t, x, p: x[0] + 1.0),
    ))  # fmt: skip
    found = run(machine(system), [1.0], 2.0)
    assert found[-1].status in ("not_finite", "step_too_small")
    assert "mode 'up'" in found[-1].reason


@pytest.mark.parametrize("method", ["dop853", "verner98"])
def test_a_field_that_does_not_exist_beyond_a_guard(method):
    def drains(t, x, p, dx):
        dx[0] = -math.sqrt(x[0]) - 0.5

    def nothing(t, x, p, out):
        out[0] = 0.0

    modes = Mode("full", drains), Mode("dry", nothing)
    empty = Transition("empty", "full", "dry", lambda t, x, p: x[0], reset=nothing)
    system = System("tank", (State("level"),), (), modes, (empty,))
    found = run(machine(system), [1.0], 3.0, method=method)
    assert [arc.transition for arc in found] == ["empty", None]
    # With s = sqrt(level), -2 s ds = (s + 1/2) dt.
    assert found[0].times[-1] == pytest.approx(2.0 - math.log(3.0), abs=1e-9)


def test_a_reset_without_a_value_is_named():
    def fails(t, x, p, x_plus):
        x_plus[0] = math.sqrt(x[0] - 1.0)

    def down(t, x, p, dx):
        dx[0] = -1.0

    system = System("down", (State("x"),), (), (Mode("on", down),), (
        Transition("zero", "on", "on", lambda t, x, p: x[0], reset=fails),
    ))  # fmt: skip
    found = run(machine(system), [1.0], 2.0)
    assert (found[-1].status, found[-1].transition) == ("not_finite", "zero")
    assert "after transition 'zero'" in found[-1].reason


def test_a_reset_that_leaves_out_a_state_is_refused():
    def half(t, x, p, x_plus):
        x_plus[0] = x[0]

    system = System("half", BALL.states, BALL.parameters, BALL.modes, (
        Transition("impact", "flight", "flight", BALL.transitions[0].guard, reset=half),
    ))  # fmt: skip
    with pytest.raises(SystemDefinitionError, match=r"does not write x_plus\[1\] \(state v\)"):
        run(machine(system), [1.0, 0.0], 2.0)


def test_an_arc_without_end_is_given_up():
    mover, control = machine(STOP, gap=2.0), Control(1e-6, np.ones(2))
    (only,) = motion_segments(mover, 0.0, np.array([1.0, 0.0]), "free", np.inf, control, most_steps=500)
    assert only.status == "too_many_steps"
    assert 500 <= len(only.times) - 1 < 600
    assert "met no transition" in only.reason


def swings(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -x[0]


def ceases(edge, floor):
    """sin t, watched by a guard that has no value beyond an edge, and is `floor` there."""

    def guard(t, x, p):
        return floor + math.sqrt(edge - x[0])

    def back(t, x, p, x_plus):
        x_plus[0] = x[0]
        x_plus[1] = -x[1]

    modes, hit = (Mode("swing", swings),), Transition("hit", "swing", "swing", guard, reset=back)
    return System("ceases", (State("x0"), State("x1")), (), modes, (hit,))


@pytest.mark.parametrize("method", METHODS)
def test_a_guard_that_ceases_to_exist_is_no_event(method):
    edge = 0.95
    found = run(machine(ceases(edge, 0.05)), [0.0, 1.0], 5.0, method=method)
    assert [(arc.transition, arc.status) for arc in found] == [(None, "not_finite")]
    assert "The guard of transition 'hit' is not finite beyond" in found[0].reason
    assert "test_hybrid_arcs.py, line" in found[0].reason
    # The guard is a further state of the steps that approach its edge: its slope grows without bound there.
    assert found[0].times[-1] == pytest.approx(math.asin(edge), abs=1e-6)
    # The edge but for the rounding of the step that is evaluated there.
    assert found[0].states[-1][0] <= edge * (1.0 + np.finfo(float).eps)


def test_a_guard_that_ceases_to_exist_where_it_is_never_asked_acts():
    # Zero at sqrt(0.5), where it falls; without a value beyond 0.95, which is in the same step of 0.5.
    def guard(t, x, p):
        return math.sqrt(0.95 - x[0]) - math.sqrt(0.45)

    def back(t, x, p, x_plus):
        x_plus[0] = x[0] - 1e-3
        x_plus[1] = -x[1]

    hit = Transition("hit", "swing", "swing", guard, reset=back)
    system = System("acts", (State("x0"), State("x1")), (), (Mode("swing", swings),), (hit,))
    found = run(machine(system), [0.0, 1.0], 2.0, tolerance=1e-4)
    assert [(arc.transition, arc.status) for arc in found] == [("hit", "ok"), (None, "ok")]
    # Two or three steps of error 1e-4 at most.
    assert found[0].times[-1] == pytest.approx(math.asin(0.5), abs=3e-4)


def test_whether_a_guard_rises_is_told_by_the_motion_at_its_event():
    """A ball that is thrown up falls where it meets the floor: one step leads from the one to the other."""
    (impact,) = BALL.transitions
    either_way = replace(BALL, transitions=(replace(impact, direction="both"),))
    (flight, *_) = run(machine(either_way), [1e-4, 0.2], 2.0)
    assert flight.states[-2, 1] > 0.0 > flight.states[-1, 1]
    assert (flight.transition, flight.rising) == ("impact", False)


def test_a_quotient_that_is_zero_by_zero_just_where_an_event_happens_is_named_with_its_line():
    """A flow through an opening that closes: finite up to the event, and 0/0 where the opening is zero."""

    def closes(t, x, p, dx):
        dx[0] = -((max(0.0, x[0]) / x[0]) ** 2)  # 0/0

    def opening(t, x, p):
        return x[0]

    def opens(t, x, p, x_plus):
        x_plus[0] = 1.0 + x[0]

    shut = Transition("shut", "open", "open", opening, "falling", reset=opens)
    lip = machine(System("lip", (State("a"),), (), (Mode("open", closes),), (shut,)))
    first = run(lip, [0.5], 2.0, method="radau5")[0]  # whose event is at zero to the last bit
    lines, start = inspect.getsourcelines(closes)
    line = start + next(i for i, text in enumerate(lines) if "0/0" in text)
    assert (first.transition, first.status) == ("shut", "not_finite")
    assert f"test_hybrid_arcs.py, line {line}: " in first.reason


def test_a_guard_that_keeps_steps_short_by_its_jump_is_named_with_its_line():
    """A stop that is there for one way of the velocity only: the block comes to rest at its edge."""

    def slides(t, x, p, dx):
        dx[0], dx[1] = x[1], -0.3

    def stop(t, x, p):
        return 1.0 - x[0] if x[1] > 0.0 or x[0] > 0.7 else -1.0  # jumps

    def rebound(t, x, p, x_plus):
        x_plus[0], x_plus[1] = x[0], -0.6 * x[1]

    hit = Transition("hit", "on", "on", stop, "falling", reset=rebound)
    mover = machine(System("edge", (State("x"), State("v")), (), (Mode("on", slides),), (hit,)))
    last = run(mover, [0.8, 0.1], 5.0)[-1]
    lines, start = inspect.getsourcelines(stop)
    line = start + next(i for i, text in enumerate(lines) if "jumps" in text)
    assert last.status == "too_many_steps"
    assert "guard of transition 'hit' is smooth by pieces only" in last.reason
    assert f"test_hybrid_arcs.py, line {line} (a comparison)" in last.reason


def test_rates_whose_squares_overflow_end_a_motion():
    """No first step can be told of them, nor a time after the first one; both were tried for ever."""

    def rushes(t, x, p, dx):
        dx[0] = 1e160 * (1.0 + x[0])

    turn = Transition("turn", "on", "on", lambda t, x, p: 1e160 - x[0], reset=jump_back)
    mover = machine(System("rush", (State("x"),), (), (Mode("on", rushes),), (turn,)))
    for start in (0.0, 1.0):
        assert run(mover, [0.3], math.inf, t0=start)[-1].status == "step_too_small"


def jump_back(t, x, p, x_plus):
    x_plus[0] = 0.0 * x[0]
