"""Maps over events and their derivatives, against closed forms in fifty digits."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from exact_machines import ExactLeg, exact_map
from hybrid_systems import BALL, CHANGING, COUNTERS, DAMPER, KICKS, STOP, SWAP

from benchmarks.event_map import StepMap
from contwalk.errors import NotFinite, StartError
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.flow.hybrid.saltation import saltation
from contwalk.system import Mode, Parameter, State, System, Transition, load_system

METHODS = ("dop853", "verner98", "radau9")


def machine(system, **values):
    return hybrid_machine(system, {**system.defaults(), **values})


def mapped(mover, x0, events, *, t0=0.0, mode=None, method="dop853", tolerance=1e-13, **options):
    mode = mode or mover.system.modes[0].name
    weights = np.ones(len(mover.system.states))
    step = StepMap(mover, mode, events, weights, method=method, **options)
    return step.mapped(t0, np.array(x0), tolerance), step


def agrees(found, exact, states, rel=1e-8):
    """Everything, relative to the largest entry of each part."""
    time, state, monodromy, shift = exact
    place = np.ix_(*states) if isinstance(states, tuple) else np.ix_(states, states)
    assert found.time == pytest.approx(time, rel=1e-11)
    np.testing.assert_allclose(found.state[place[0].ravel()], state, rtol=0, atol=1e-10 * np.abs(state).max())
    np.testing.assert_allclose(found.monodromy[place], monodromy, rtol=0, atol=rel * np.abs(monodromy).max())
    rest = found.monodromy.copy()
    rest[place] = 0.0
    assert not rest.any()
    own = found.shift[place[1].ravel()]
    np.testing.assert_allclose(own, shift, rtol=0, atol=rel * max(np.abs(shift).max(), 1.0))


# -- impacts on a table that moves ---------------------------------------------------------------------------


def parabola(t, x, d):
    return [x[0] + x[1] * d - 5 * d * d, x[1] - 10 * d]


def table(e, a, omega):
    e, a, omega = (mpmath.mpf(v) for v in (e, a, omega))

    def guard(t, x):
        return x[0] - a * mpmath.sin(omega * t)

    def reset(t, x):
        u = a * omega * mpmath.cos(omega * t)
        return [x[0], u - e * (x[1] - u)]

    return guard, reset


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("events", [1, 3])
def test_impacts_on_a_table_whose_guard_and_reset_depend_on_time(method, events):
    e, a, omega = 0.8, 0.05, 7.0
    guard, reset = table(e, a, omega)
    near = [0.44, 0.75, 0.6]
    legs = [ExactLeg(parabola, guard, reset, d) for d in near[:events]]
    exact = exact_map(legs, parabola, 0.3, [1.0, 0.1])
    found, _ = mapped(machine(BALL, e=e, a=a, omega=omega), [1.0, 0.1], events, t0=0.3, method=method)
    agrees(found, exact, [0, 1])
    assert found.itinerary == ("impact",) * events


def test_an_impact_on_a_fixed_floor():
    guard, reset = table(0.5, 0.0, 1.0)
    exact = exact_map([ExactLeg(parabola, guard, reset, 0.44)], parabola, 0.0, [1.0, 0.0])
    found, _ = mapped(machine(BALL, e=0.5), [1.0, 0.0], 1)
    agrees(found, exact, [0, 1], rel=1e-12)
    # The state at the event itself stays on the floor.
    at_event = found.monodromy + np.outer(found.velocity, found.shift)
    np.testing.assert_allclose(at_event[0], 0.0, atol=1e-14)


# -- an oscillator -------------------------------------------------------------------------------------------


def circle(w):
    def flow(t, x, d):
        c, s = mpmath.cos(w * d), mpmath.sin(w * d)
        return [x[0] * c + x[1] * s / w, -x[0] * w * s + x[1] * c]

    return flow


@pytest.mark.parametrize("method", METHODS)
def test_an_oscillator_with_a_stop(method):
    w, e, gap = 1.3, 0.7, 0.4
    flow = circle(mpmath.mpf(w))
    legs = [
        ExactLeg(flow, lambda t, x: mpmath.mpf(gap) - x[0], lambda t, x: [x[0], -mpmath.mpf(e) * x[1]], near)
        for near in (1.5, 2.8)
    ]
    exact = exact_map(legs, flow, 0.0, [-1.0, 0.2])
    found, _ = mapped(machine(STOP, w=w, e=e, gap=gap), [-1.0, 0.2], 2, method=method)
    agrees(found, exact, [0, 1])


def curved(t, x, p):
    return p.radius - x[0] * x[0] - 0.5 * x[1] * x[1]


def turned(t, x, p, x_plus):
    x_plus[0] = 0.3 * x[0] + p.push * x[1] ** 2
    x_plus[1] = -0.2 * x[0] * x[1] + p.push


CURVED = System(
    "curved",
    states=STOP.states,
    parameters=(Parameter("w", 1.3), Parameter("radius", 1.0), Parameter("push", 0.2)),
    modes=STOP.modes,
    transitions=(Transition("edge", "free", "free", curved, reset=turned),),
)


def test_a_curved_guard_and_a_reset_that_depends_on_parameters():
    w, push, radius = (mpmath.mpf(v) for v in (1.3, 0.15, 0.45))
    flow = circle(w)
    leg = ExactLeg(
        flow,
        lambda t, x: radius - x[0] ** 2 - x[1] ** 2 / 2,
        lambda t, x: [mpmath.mpf(0.3) * x[0] + push * x[1] ** 2, -mpmath.mpf(0.2) * x[0] * x[1] + push],
        0.3,
    )
    x0 = [0.3, 0.8]
    exact = exact_map([leg], flow, 0.0, x0)
    found, _ = mapped(machine(CURVED, push=0.15, radius=0.45), x0, 1)
    agrees(found, exact, [0, 1])


# -- modes, names, clocks ------------------------------------------------------------------------------------


def test_a_soft_transition_changes_no_deviation():
    d = mpmath.mpf(0.1)
    turn = mpmath.sqrt(1 - d * d)

    def damped(t, x, s):
        c, k = mpmath.cos(turn * s), mpmath.sin(turn * s) / turn
        decay = mpmath.exp(-d * s)
        return [decay * (x[0] * c + (x[1] + d * x[0]) * k), decay * (x[1] * c - (x[0] + d * x[1]) * k)]

    undamped = circle(mpmath.mpf(1))
    legs = [ExactLeg(undamped, lambda t, x: x[1], lambda t, x: list(x), 3.0)]
    legs.append(ExactLeg(damped, lambda t, x: x[1], lambda t, x: list(x), 3.0))
    exact = exact_map(legs, undamped, 0.0, [-1.0, 0.1])
    mover = machine(DAMPER)
    found, _ = mapped(mover, [-1.0, 0.1], 2, mode="extending")
    agrees(found, exact, [0, 1])
    assert found.itinerary == ("turns_in", "turns_out")
    matrix, _ = saltation(mover, mover.transition("turns_in"), 0.0, np.array([1.0, 0.0]))
    np.testing.assert_array_equal(matrix, np.eye(2))


@pytest.mark.parametrize("method", METHODS)
def test_modes_with_other_states(method):
    def leak(t, x, d):
        return [x[0] * mpmath.exp(-d)]

    def fly(t, x, d):
        return [x[0] + x[1] * d - d * d, x[1] - 2 * d]

    empty = ExactLeg(leak, lambda t, x: x[0] - mpmath.mpf(0.5), lambda t, x: [mpmath.mpf(0), 4 * x[0]], 0.7)
    landed = ExactLeg(fly, lambda t, x: x[0], lambda t, x: [mpmath.mpf(1)], 2.0)
    mover = machine(CHANGING)
    exact = exact_map([empty], fly, 0.0, [1.1])
    found, _ = mapped(mover, [0.0, 1.1, 0.0], 1, mode="leaking", method=method)
    agrees(found, exact, ([0, 2], [1]))
    # From one flying state on, through the whole cycle.
    exact = exact_map([landed, empty], fly, 0.0, [0.5, 1.5])
    found, _ = mapped(mover, [0.5, 0.0, 1.5], 2, mode="flying", method=method)
    agrees(found, exact, [0, 2])
    assert (found.mode, found.itinerary) == ("flying", ("landed", "empty"))


def test_names_that_are_swapped():
    def grow(t, x, d):
        return [x[0] + d, x[1] * mpmath.exp(-d)]

    leg = [ExactLeg(grow, lambda t, x: 1 - x[0], lambda t, x: [x[1], x[0]], near) for near in (0.5, 0.8)]
    exact = exact_map(leg, grow, 0.0, [0.5, 0.25])
    found, _ = mapped(machine(SWAP), [0.5, 0.25], 2)
    agrees(found, exact, [0, 1])


def test_kicks_by_the_clock_shift_no_instant():
    found, _ = mapped(machine(KICKS), [0.0], 3)
    assert found.time == pytest.approx(2.5, rel=1e-15)
    assert found.state[0] == 3.0
    np.testing.assert_array_equal(found.monodromy, [[1.0]])
    np.testing.assert_array_equal(found.shift, [0.0])


def forced_rate(t, x, p, dx):
    dx[0] = math.cos(p.omega * t) * x[0]


def test_a_field_that_depends_on_time():
    forced = System(
        "forced",
        (State("x"),),
        (Parameter("omega", 2.0),),
        (Mode("on", forced_rate),),
        (
            Transition(
                "down", "on", "on",
                lambda t, x, p: 1.2 + 0.1 * math.sin(t) - x[0],
                reset=lambda t, x, p, x_plus: x_plus.__setitem__(0, x[0] * 0.5 + 0.1 * t),
            ),
        ),
        period=lambda p: 2.0 * math.pi / p.omega,
    )  # fmt: skip

    def flow(t, x, d):
        return [x[0] * mpmath.exp((mpmath.sin(2 * (t + d)) - mpmath.sin(2 * t)) / 2)]

    tenth = mpmath.mpf(0.1)
    leg = ExactLeg(
        flow,
        lambda t, x: mpmath.mpf(1.2) + tenth * mpmath.sin(t) - x[0],
        lambda t, x: [x[0] * mpmath.mpf(0.5) + tenth * t],
        0.3,
    )
    exact = exact_map([leg], flow, 0.1, [1.0])
    found, _ = mapped(machine(forced), [1.0], 1, t0=0.1)
    agrees(found, exact, [0])


# -- the two ways --------------------------------------------------------------------------------------------


def by_reference(step):
    step._integrator = None
    return step


@pytest.mark.parametrize("at", [True, False])
def test_the_compiled_way_and_the_reference_integrator_agree_on_a_walker(at):
    walker = machine(load_system("planar_walker"), alpha=0.09)
    before = np.array([-0.5196, 0.1474227645, 0.0, 0.0, -1.933, -2.037, 0.0])
    weights = np.array([0.5, 0.5, 1.0, 1.0, 2.0, 4.0, 10.0])
    begins = {"at": "heel_strike"} if at else {"just_after": "heel_strike"}
    x0, mode, events = before, "two_link", 3
    if not at:
        matrix, _ = saltation(walker, walker.transition("heel_strike"), 0.0, before)
        assert matrix.shape == (6, 4)
        x0 = StepMap(walker, "two_link", 1, weights, at="heel_strike").mapped(0.0, before, 1e-10).state
        mode, events = "three_link", 2
    fast = StepMap(walker, mode, events, weights, **begins)
    slow = by_reference(StepMap(walker, mode, events, weights, **begins))
    one, other = fast.mapped(0.0, x0, 1e-13), slow.mapped(0.0, x0, 1e-13)
    assert fast._integrated(fast._integrator, 0.0, x0, 1e-13)
    assert one.itinerary == other.itinerary == ("heel_strike",) * at + ("knee_strike", "heel_strike")
    assert one.time == pytest.approx(other.time, rel=1e-12)
    scale = np.abs(other.monodromy).max()
    np.testing.assert_allclose(one.monodromy, other.monodromy, rtol=0, atol=1e-10 * scale)
    np.testing.assert_allclose(one.shift, other.shift, rtol=0, atol=1e-10)
    np.testing.assert_allclose(one.velocity, other.velocity, rtol=0, atol=1e-9)
    t, x, monodromy = fast(0.0, x0, 1e-13)
    assert t == one.time
    np.testing.assert_array_equal(x, one.state)
    np.testing.assert_array_equal(monodromy, one.monodromy)


def test_transitions_at_once_are_left_to_the_reference_integrator():
    found, step = mapped(machine(COUNTERS), [0.5, 0.5, 0.0], 3)
    assert not step._integrated(step._integrator, 0.0, np.array([0.5, 0.5, 0.0]), 1e-10)
    assert found.itinerary == ("a", "b", "a")
    np.testing.assert_allclose(found.state, [1.0, 1.0, 2.0], atol=1e-14)


def test_the_map_is_the_motion():
    mover = machine(STOP, e=0.9)
    found, _ = mapped(mover, [-1.0, 0.0], 4, tolerance=1e-10)
    motion = motion_segments(mover, 0.0, np.array([-1.0, 0.0]), "free", 100.0, Control(1e-10, np.ones(2)))
    ends = [next(motion) for _ in range(4)]
    assert found.time == ends[-1].times[-1]
    np.testing.assert_array_equal(found.state, ends[-1].after)


# -- what cannot be mapped -----------------------------------------------------------------------------------


def test_a_motion_that_ends_before_is_named():
    with pytest.raises(NotFinite, match=r"after 1 of 3 events.*declare a mode"):
        mapped(machine(BALL, e=0.0), [1.0, 0.0], 3)
    with pytest.raises(NotFinite, match=r"after 0 of 1 events. No transition happens until t = 5"):
        mapped(machine(STOP, gap=2.0), [1.0, 0.0], 1, longest=5.0)


def test_a_start_past_a_guard_is_refused():
    with pytest.raises(StartError, match="'impact' is -1"):
        mapped(machine(BALL), [-1.0, 0.0], 1)


def test_a_mode_that_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="cannot begin with 'landed'"):
        StepMap(machine(CHANGING), "leaking", 1, np.ones(3), at="landed")


def test_a_graze_has_no_derivative():
    # It comes to rest at the stop: the instant of the event has an infinite derivative.
    matrix, shift = saltation(machine(STOP, gap=1.0), STOP.transition("stop"), 0.0, np.array([1.0, 0.0]))
    assert not np.isfinite(shift).all()
    assert not np.isfinite(matrix).all()
