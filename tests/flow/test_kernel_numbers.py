"""Numbers that kernels compute in between, by the definitions: run by Python, as they are written."""

from __future__ import annotations

import ctypes
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hybrid_runs import machine
from numpy.polynomial import Polynomial

from contwalk.flow.compiled.traced import field_of
from contwalk.flow.hybrid import event_records, guard_kernel, guard_taylor_kernel
from contwalk.flow.hybrid.event_integrator import EventIntegrator
from contwalk.flow.hybrid.guard_taylor import GuardTaylor
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.flow.radau import newton as radau_newton


@pytest.mark.parametrize("zero", [0.02, 0.3, 0.5, 0.77, 0.99])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_zero_of_a_cubic_that_rises_or_falls(zero, sign):
    """t + t^2 / 2 - t^3 / 4 less its value at the zero: told by values and slopes at both ends."""
    cubic = sign * (Polynomial([0.0, 1.0, 0.5, -0.25]) - Polynomial([0.0, 1.0, 0.5, -0.25])(zero))
    slope = cubic.deriv()
    found = guard_kernel._cubic_zero.py_func(cubic(0.0), slope(0.0), cubic(1.0), slope(1.0))
    assert found == pytest.approx(zero, abs=1e-14)


def test_a_rate_of_convergence_is_a_geometric_mean_down_to_rounding():
    """Corrections are in units of rounding: what is below one of them tells nothing."""
    mean = radau_newton._mean_rate.py_func
    assert mean(1e6, 1.0, 4) == pytest.approx(1e-2, rel=1e-14)  # three passes after the first
    assert mean(1e6, 1e-9, 4) == mean(1e6, 1.0, 4)
    assert mean(1e4, 1e2, 2) == pytest.approx(1e-2, rel=1e-14)
    assert mean(1e6, 1.0, 1) == mean(0.5, 0.1, 3) == 0.0


# -- how uncertain the acceleration is -----------------------------------------------------------------------


def coupled(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.k * x[0] + 3.0 * x[2] + 5.0 * t
    dx[2] = 2.0 * x[0] - 7.0 * x[1]


def record_of(call):
    """A record as NumPy sees it, which functions for numba take."""
    return np.frombuffer(call, dtype=np.dtype(type(call)))[0]


def array_at(address, length):
    return np.ctypeslib.as_array((ctypes.c_double * length).from_address(int(address))).copy()


def test_what_states_do_not_know_their_acceleration_does_not_either():
    """x' = J x + 5 t e1: the velocity is off by |J| dx + 5 dt, and the acceleration by |J| times as much.

    Second derivatives are off by 16 times what the states are of their magnitudes besides (`coarse`).
    """
    system = machine(["x", "y", "z"], {"k": 4.0}, {"only": coupled}, [])
    field, p, n = field_of(system, "only"), np.array([4.0]), 3
    taylor = GuardTaylor(field, field.constants(p), p)
    jacobian = np.array([[0.0, 1.0, 0.0], [-4.0, 0.0, 3.0], [2.0, -7.0, 0.0]])
    t, x, noise, weights = 0.5, np.array([0.3, -1.1, 0.8]), np.array([1e-3, 2e-3, 4e-3]), np.full(n, 2.0)
    taylor.at(t, x, noise, weights)
    guard_taylor_kernel._know(record_of(taylor.instant), t)
    by_time, coarse = np.array([0.0, 5.0, 0.0]), 16.0 * 4e-3 / 2.0
    f = jacobian @ x + by_time * t
    velocity_off = np.abs(jacobian) @ noise  # the time is off by its rounding only: 1e-16
    expected = [
        *velocity_off,
        *(jacobian @ f + by_time),
        *(coarse * by_time + np.abs(jacobian) @ (velocity_off + coarse * np.abs(f))),
    ]
    # What rounding adds to the field, and to these sums: some 1e-15 of terms up to 50, none below 1e-3.
    np.testing.assert_allclose(array_at(taylor.instant.motion, 3 * n), expected, rtol=1e-11)


# -- samples of a guard within a step ------------------------------------------------------------------------

PARTS = guard_kernel.PARTS


@pytest.fixture
def sampled_step(monkeypatch):
    """A step from 0 to 1 of a guard that is told in closed form, by value and rate; and what was tried of it.

    The kernel's memory is arrays in place of addresses.
    """

    def made(value, rate):
        at = event_records.GuardOnStep(value=value(0.0), rate=rate(0.0), left_at=math.inf)
        samples = np.array([number(k / PARTS) for k in range(PARTS + 1) for number in (value, rate)])
        tried = []

        def retaken(m, guard, t, end):
            tried.append(end)
            return value(end), 0.0

        monkeypatch.setattr(guard_kernel, "doubles", lambda array, length: array)
        monkeypatch.setattr(guard_kernel, "standing", lambda m, guard: at)
        monkeypatch.setattr(guard_kernel, "sided", guard_kernel.sided.py_func)
        monkeypatch.setattr(guard_kernel, "side_of", guard_kernel.side_of.py_func)
        monkeypatch.setattr(guard_kernel, "_retake", retaken)
        monkeypatch.setattr(guard_kernel, "_retaken_rate", lambda m, guard, end: rate(end))
        monkeypatch.setattr(guard_kernel, "_sample", lambda m, part: part)
        monkeypatch.setattr(guard_kernel, "measured", lambda m, g, t, x, v: (value(t), rate(t), 0.0))
        return SimpleNamespace(samples=samples, size=0), tried

    return made


@pytest.mark.parametrize("place", [0.15, 0.4, 0.5, 0.85])
@pytest.mark.parametrize("part", [0, 3, PARTS - 1])
@pytest.mark.parametrize("depth", [1e-12, -1e-12])
def test_a_parabola_is_asked_first_where_it_turns(sampled_step, part, place, depth):
    """Its rate is linear: the first trial is the turn, and is beyond zero where that is."""
    turn = (part + place) / PARTS
    m, tried = sampled_step(lambda t: (t - turn) ** 2 - depth, lambda t: 2.0 * (t - turn))
    found = guard_kernel._beyond.py_func(m, 0, 0.0, 1.0, part, 1.0)
    assert tried[0] == pytest.approx(turn, abs=4e-16)  # roundings of numbers up to 1
    assert found == (tried[0] if depth > 0.0 else guard_kernel.NONE)


@pytest.mark.parametrize(("place", "asked"), [(0.02, 0.1), (0.97, 0.9)])
def test_no_trial_is_at_the_ends_of_a_part(sampled_step, place, asked):
    """Where the turn would be in the first or in the last tenth, the tenth is asked."""
    turn = (2 + place) / PARTS
    m, tried = sampled_step(lambda t: (t - turn) ** 2 - 1e-12, lambda t: 2.0 * (t - turn))
    guard_kernel._beyond.py_func(m, 0, 0.0, 1.0, 2, 1.0)
    assert tried[0] == pytest.approx((2 + asked) / PARTS, abs=4e-16)  # roundings of numbers up to 1


@pytest.mark.parametrize("part", range(1, PARTS + 1))
@pytest.mark.parametrize("nothing", [math.nan, math.inf])
def test_a_guard_without_a_value_at_a_sample_is_not_resolved(sampled_step, part, nothing):
    def value(t):
        return nothing if t == part / PARTS else 1.0 + t

    m, _ = sampled_step(value, lambda t: 1.0)
    assert not guard_kernel._sampled.py_func(m, 0, 0.0, 1.0, value(1.0), 1.0)


def test_a_guard_with_values_at_all_samples_is_resolved(sampled_step):
    m, _ = sampled_step(lambda t: 1.0 + t, lambda t: 1.0)
    assert guard_kernel._sampled.py_func(m, 0, 0.0, 1.0, 2.0, 1.0)


# -- steps of an arc -----------------------------------------------------------------------------------------


def rooted(t, x, p, dx):
    dx[0] = p.k + np.sqrt(-x[0])


def test_an_arc_that_takes_no_step_has_none():
    """x' = k + sqrt(-x) has no field beyond zero: right there no step succeeds, far before it all do."""
    there = hybrid_machine(machine(["x"], {"k": 1.0}, {"only": rooted}, []), {"k": 1.0})
    integrator = EventIntegrator(there, np.ones(1), ["only"], marks=True)
    integrator.begin(0.0, np.array([0.0]), "only", None)
    assert integrator(1.0, 1e-9) == event_records.NOT_FINITE
    assert integrator.happened.own_steps == 0
    integrator.begin(0.0, np.array([-9.0]), "only", None)
    assert integrator(1.0, 1e-9) == event_records.TIME_UP
    steps = integrator.happened.own_steps
    assert steps == integrator.happened.steps > 0
    assert integrator.times[steps] == 1.0
