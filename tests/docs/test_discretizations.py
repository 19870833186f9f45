"""The page on discretisations: the family of methods that it adds steps, and finds an orbit."""

from __future__ import annotations

import math
from types import ModuleType

import numpy as np
import pytest
from code_blocks import blocks
from small_flows import field_of
from small_systems import small_system

import contwalk as cw
from contwalk import flow
from contwalk.flow import integrate
from contwalk.problems.orbit.discretization import STAGES, Discretization

PAGE = "docs/howto/discretizations.md"
METHOD = "classical4"


def lorenz(t, x, p):
    return [p[0] * (x[1] - x[0]), x[0] * (p[1] - x[2]) - x[1], x[0] * x[1] - p[2] * x[2]]


def forced(t, x, p):
    """From 1 at t = 0 the states go like exp(sin t) and 1 / (1 + t^2)."""
    return [x[0] * math.cos(t), -2.0 * t * x[1] * x[1]]


def forced_flow(t):
    return np.stack([np.exp(np.sin(t)), 1.0 / (1.0 + np.square(t))], axis=-1)


@pytest.fixture
def family(monkeypatch):
    """The module of the page, added as it says."""
    (text,) = blocks(PAGE, "python")
    module = ModuleType("contwalk.flow.classical")
    exec(compile(text, PAGE, "exec"), module.__dict__)
    monkeypatch.setattr(integrate, "FAMILIES", (*integrate.FAMILIES, module))
    monkeypatch.setitem(STAGES, METHOD, 11)
    return module


def test_steps_of_a_path_taken_again_are_the_same_bit_by_bit(family):
    field = field_of(lorenz, 3, 3, columns=(1, 0))
    c, start = field.constants([10.0, 28.0, 8.0 / 3.0]), np.array([1.0, 2.0, 20.0])
    path = flow.adaptive(field, c, 0.0, start, 1.0, 1e-7, [10.0] * 3, METHOD)
    assert path.status == "ok"
    assert np.array_equal(flow.along(field, c, path.times, start, METHOD), path.states)
    half = len(path.times) // 2
    times = np.concatenate([path.times[: half + 1], path.times[half:]])
    states, ends = flow.along_with_tangents(
        field, c, times, path.states[[0, half]], np.eye(3, 4), [-1, -1, -1, 0], METHOD
    )
    assert np.array_equal(states, np.concatenate([path.states[: half + 1], path.states[half:]]))
    again = flow.tangents(
        field, c, path.times[half:], path.states[half], np.eye(3, 4), [-1, -1, -1, 0], METHOD
    )
    assert np.array_equal(again[1], ends[1])


def test_derivatives_are_those_of_coarse_steps(family):
    field = field_of(lorenz, 3, 3, columns=(1, 0))
    values, start = np.array([10.0, 28.0, 8.0 / 3.0]), np.array([1.0, 2.0, 20.0])
    c, times = field.constants(values), np.linspace(0.0, 0.4, 5)
    _, found = flow.tangents(field, c, times, start, np.eye(3, 4), [-1, -1, -1, 0], METHOD)

    def end(column, s):
        if column < 3:
            return flow.along(field, c, times, start + s * np.eye(3)[column], METHOD)[-1]
        return flow.along(field, field.constants(values + s * np.eye(3)[1]), times, start, METHOD)[-1]

    h = 1e-3
    expected = np.column_stack(
        [(8.0 * (end(i, h) - end(i, -h)) - (end(i, 2 * h) - end(i, -2 * h))) / (12.0 * h) for i in range(4)]
    )
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())


def test_the_order_is_four_and_errors_are_told(family):
    field = field_of(forced, 2, 0)
    c, errors = field.constants([]), []
    for count in (20, 40):
        times = np.linspace(0.0, 2.0, count + 1)
        states = flow.along(field, c, times, [1.0, 1.0], METHOD)
        errors.append(np.abs(states[-1] - forced_flow(times)[-1]).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.4)
    told = flow.errors_on(field, c, [0.0, 0.125], [1.0, 1.0], METHOD, [1.0, 1.0])
    after = flow.along(field, c, [0.0, 0.125], [1.0, 1.0], METHOD)[-1]
    error = float(np.linalg.norm(after - forced_flow(np.array([0.125]))[0]) / np.sqrt(2.0))
    assert told[0] == pytest.approx(error, rel=0.3)  # the next order
    at = np.linspace(0.0, 2.0, 77)
    times = np.linspace(0.0, 2.0, 41)
    states = flow.along(field, c, times, [1.0, 1.0], METHOD)
    assert np.abs(flow.dense(field, c, times, states, at, METHOD) - forced_flow(at)).max() < 3.0 * errors[1]


def circle(t, x, p, dx):
    """Radius sqrt(p.size), period 2 pi, multiplier exp(-4 pi size)."""
    rest = p.size - x[0] ** 2 - x[1] ** 2
    dx[0] = rest * x[0] - x[1]
    dx[1] = rest * x[1] + x[0]


def test_an_orbit_is_followed_with_it(family):
    system = small_system(circle, "xy", {"size": 0.1})
    wanted = Discretization(accuracy=1e-6, method=METHOD)
    orbit = cw.PeriodicOrbit(system, {"size": 0.1}, free="size", discretization=wanted)
    branch = cw.continue_branch(orbit, [math.sqrt(0.1), 0.0], (0.05, 0.15), period=2.0 * math.pi)
    assert branch.outcome.reason == "bound"
    np.testing.assert_allclose(branch["period"], 2.0 * math.pi, rtol=1e-4)
    np.testing.assert_allclose(branch["max:x"], np.sqrt(branch["size"]), rtol=1e-4)
    found = branch.points["spectrum"][:, 0].real
    np.testing.assert_allclose(found, np.exp(-4.0 * math.pi * branch["size"]), rtol=1e-3)


def test_without_the_entry_the_method_is_refused():
    field = field_of(forced, 2, 0)
    with pytest.raises(ValueError, match="'classical4' is none of dop853"):
        flow.adaptive(field, field.constants([]), 0.0, [1.0, 1.0], 1.0, 1e-8, [1.0, 1.0], METHOD)
