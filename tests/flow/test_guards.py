"""Guards without their field: rates along a given velocity, slopes, and code that modes share."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

from contwalk.fields.derivative import directional
from contwalk.fields.llvm import code_of
from contwalk.fields.machine_code import function, module
from contwalk.fields.rebind import rebound
from contwalk.fields.trace import trace
from contwalk.flow.compiled.traced import PARAMETER, STATE, TIME, arguments, field_of, rates
from contwalk.flow.events.guard import Guard
from contwalk.flow.hybrid.guard_status import BEYOND, CLEAR, ENTERING, LEAVING, RESTING, guard_statuses
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.system import Mode, Parameter, State, System, Transition

EPSILON = np.finfo(float).eps
P = np.array([0.7, 0.3, 0.1, 3.0])
X, T = np.array([0.4, -1.3, 0.2]), 0.6


def driven(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * math.sin(x[0]) + p.stiff * x[2] * math.cos(t)
    dx[2] = -x[2] * x[1]


def resting(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.pull * p.times - p.g  # zero, but for rounding


def plane(t, x, p):
    return x[0] - p.k


def bent(t, x, p):
    if x[0] * p.k > t - 2.0:
        return math.sin(x[0] * x[1]) + p.k * t * t
    return x[0]


def chosen(t, x, p):
    return np.where(x[1] < 0.0, x[0] ** 2 * p.g, x[0]) - math.exp(-t)


def of_mode(t, x, p):
    return x[0] - p.k * p.stiff


GUARDS = (plane, bent, chosen, lambda t, x, p: t - p.k, lambda t, x, p: x[2] * x[1] * x[0])
SYSTEM = System(
    "watched",
    states=(State("q"), State("v"), State("z")),
    parameters=(Parameter("k", 0.7), Parameter("g", 0.3), Parameter("pull", 0.1), Parameter("times", 3.0)),
    modes=(
        Mode("soft", driven, constants={"stiff": 1.0}),
        Mode("hard", driven, constants={"stiff": 4.0}),
        Mode("plain", driven, states=("q", "v"), constants={"stiff": 0.0}),
        Mode("rest", resting, states=("q", "v")),
    ),
    transitions=(
        Transition("plane", "soft", "hard", plane),
        Transition("plane", "hard", "soft", plane),
        Transition("plane", "plain", "soft", plane),
        Transition("stiffer", "soft", "hard", of_mode),
        Transition("stiffer", "hard", "soft", of_mode),
        Transition("bent", "soft", "hard", bent),
        Transition("chosen", "soft", "hard", chosen, "both"),
        Transition("floor", "rest", "soft", lambda t, x, p: x[0]),
    ),
)


def machine():
    values = dict(zip(SYSTEM.parameter_names, P.tolist(), strict=True))
    return hybrid_machine(SYSTEM, values)


def traced_with_the_field(watched, mode, t, x):
    """h and dh/dt of one program of guard and field."""
    copies = rebound(watched), rebound(SYSTEM.mode(mode).field)

    def both(tracer):
        value = copies[0](*arguments(tracer, SYSTEM, mode))
        return [value, *rates(tracer, SYSTEM, copies[1], mode)]

    program = trace(both)
    graph, states = program.graph, SYSTEM.states_of(mode)
    inputs = [graph.input(STATE, i) for i in states]

    def change(outputs):
        moving = {graph.input(TIME, 0): graph.one, **dict(zip(inputs, outputs[1:], strict=True))}
        return [outputs[0], *directional(graph, outputs[:1], moving)]

    places = {node: ("x", k) for k, node in enumerate(inputs)} | {graph.input(TIME, 0): ("t", 0)}
    places |= {graph.input(PARAMETER, k): ("c", k) for k in range(len(P))}
    text = module([function("whole", program.transformed(change), ("x", "c"), places, time=True)])

    call = code_of(text, ("whole",)).function("whole", None, ctypes.c_double, *[ctypes.c_void_p] * 3)
    out = np.empty(2)
    call(t, x.ctypes.data, P.ctypes.data, out.ctypes.data)
    return out


@pytest.mark.parametrize("watched", GUARDS)
@pytest.mark.parametrize("t", [T, 4.0])
def test_the_rate_along_a_given_velocity_is_that_of_guard_and_field_in_one_program(watched, t):
    guard, field = Guard(SYSTEM, "g", watched, mode="soft"), field_of(SYSTEM, "soft")
    f = field.along(np.array([t]), X[None], field.constants(P))
    value, rate, noise = guard.along(np.array([t]), X[None], P, f)[0]
    known = traced_with_the_field(watched, "soft", t, X)
    assert value == known[0]
    assert rate == pytest.approx(known[1], rel=8.0 * EPSILON, abs=8.0 * EPSILON)
    assert 0.0 < noise < 1e-13
    assert guard(t, X, P).tolist() == [value, rate, noise]  # it asks its field where it is told nothing


def test_the_velocity_is_an_input():
    guard = Guard(SYSTEM, "g", lambda t, x, p: x[0] * x[1] + t * p.k, mode="soft")
    velocity = np.array([[2.0, 3.0, math.nan]])
    assert guard.along(np.array([T]), X[None], P, velocity)[0, 1] == pytest.approx(
        2.0 * -1.3 + 3.0 * 0.4 + 0.7
    )
    with pytest.raises(ValueError, match="velocities"):
        guard.along(np.array([T]), X[None], P, velocity[:, :2])


def test_slopes_and_how_fast_they_change():
    guard = Guard(SYSTEM, "g", lambda t, x, p: t * x[0] ** 2 + p.k * x[1] * x[2], mode="soft")
    (q, v, z), f = X, np.array([2.0, 3.0, -1.0])
    found = guard.slopes(T, X, P, f)
    assert found.value == pytest.approx(T * q * q + 0.7 * v * z, rel=1e-15)
    np.testing.assert_allclose(found.gradient, [q * q, 2 * T * q, 0.7 * z, 0.7 * v], rtol=1e-15)
    change = [2 * q * f[0], 2 * q + 2 * T * f[0], 0.7 * f[2], 0.7 * f[1]]
    np.testing.assert_allclose(found.change, change, rtol=1e-15)
    assert 0.0 < found.rounding < 1e-14


def test_modes_share_the_code_of_a_guard():
    code = machine().code
    soft, hard, plain = (code.mode(name).guards for name in ("soft", "hard", "plain"))
    # What differs is not read: the machine code is the same although states and constants differ.
    assert soft[0].address == hard[0].address
    assert soft[0].slopes_address == hard[0].slopes_address
    assert plain[0].address == soft[0].address
    # Constants that are read are part of the code.
    assert soft[1].address != hard[1].address
    for guards, stiff in ((soft, 1.0), (hard, 4.0)):
        assert guards[1](T, X, P)[0] == pytest.approx(0.4 - 0.7 * stiff)


def test_modes_of_the_same_states_and_constants_trace_a_guard_once():
    modes = [Mode(name, driven, constants={"stiff": 1.0}) for name in ("left", "right")]
    ways = [Transition("over", a, b, plane) for a, b in (("left", "right"), ("right", "left"))]
    twins = System("twins", SYSTEM.states, SYSTEM.parameters, tuple(modes), tuple(ways))
    code = hybrid_machine(twins, dict(zip(twins.parameter_names, P.tolist(), strict=True))).code
    assert code.mode("left").guards[0].code is code.mode("right").guards[0].code


@pytest.mark.parametrize("mode", ["soft", "plain", "rest"])
def test_rounding_and_time_derivative_of_a_field(mode):

    field = field_of(SYSTEM, mode)
    n, x = field.n, X[: field.n].copy()
    out = np.empty(2 * n)
    call = field._variation.function("variation", None, ctypes.c_double, *[ctypes.c_void_p] * 3)
    call(T, x.ctypes.data, P.ctypes.data, out.ctypes.data)
    by_time = {"soft": [0.0, -0.2 * math.sin(T), 0.0], "plain": [0.0, 0.0], "rest": [0.0, 0.0]}[mode]
    np.testing.assert_allclose(out[n:], by_time, rtol=1e-15)
    assert out[0] == 0.0  # a copy is not rounded
    # The product of the parameters is rounded although the difference is nearly zero.
    assert out[1] >= (0.3 if mode == "rest" else abs(field(T, x, field.constants(P))[1]))


def test_guards_beside_the_states_have_their_rates_and_slopes():
    flow = machine().mode("soft")
    resolving = flow.code.resolving
    c, n = resolving.constants(P), flow.field.n
    x = np.concatenate([X, np.zeros(len(flow.guards))])
    f, found = flow.field(T, X, flow.c), resolving(T, x, c)
    np.testing.assert_array_equal(found[:n], f)
    rates_of = [guard.along(np.array([T]), X[None], P, f[None])[0, 1] for guard in flow.guards]
    np.testing.assert_array_equal(found[n:], rates_of)
    slopes = resolving.jacobian(T, x, c)
    np.testing.assert_array_equal(slopes[:n, :n], flow.field.jacobian(T, X, flow.c))
    assert not slopes[:, n:].any()
    for j in range(n):
        step = np.zeros(len(x))
        step[j] = 1e-6
        difference = (resolving(T, x + step, c) - resolving(T, x - step, c)) / 2e-6
        np.testing.assert_allclose(slopes[:, j], difference, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize(
    ("x", "kind", "side"),
    [
        ([0.0, 0.0], RESTING, 0),
        ([1e-18, 0.0], RESTING, 0),
        ([1e-18, 1e-3], LEAVING, 1),
        ([1e-18, -1e-3], ENTERING, -1),
        ([1e-3, -1.0], CLEAR, 1),
        ([-1e-3, 1.0], BEYOND, -1),
    ],
)
def test_what_rests_by_forces_that_cancel_is_told_from_what_leaves(x, kind, side):
    """The acceleration is 3 x 0.1 - 0.3, of which rounding leaves 5.6e-17."""
    flow = machine().mode("rest")
    state = np.array(x)
    (found,) = guard_statuses(flow, 0.0, state, np.full(2, 1e-17), np.ones(2))
    assert (found.kind, found.side) == (kind, side)
    assert found.rate == x[1]
