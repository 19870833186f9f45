"""Paths of explicit methods: orders, frozen grids, errors, and how they end."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from flow_fields import compiled, forced, forced_flow, lorenz, van_der_pol

from contwalk import flow

METHODS = ("dop853", "verner98")
ORDERS = {"dop853": 8, "verner98": 9}

START = [1.0, 1.0]  # of `forced`, at t = 0


@pytest.fixture(scope="module")
def oscillation():
    field = compiled(van_der_pol, 2, 1)
    return field, field.constants([1.0])


@pytest.fixture(scope="module")
def driven():
    field = compiled(forced, 2)
    return field, field.constants([])


def slope(steps, errors):
    """Of log error over log step."""
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("method", METHODS)
def test_order(driven, method):
    """Errors of forty paths: small enough for one power to lead, large enough not to be rounding."""
    steps = (8, 10, 12)
    errors = []
    for s in steps:
        missed = [
            flow.along(*driven, np.linspace(a, a + 2.0, s + 1), forced_flow(a), method)[-1]
            - forced_flow(a + 2.0)
            for a in np.linspace(-3.0, 3.0, 40)
        ]
        errors.append(np.sqrt(np.mean(np.square(missed))))
    assert 1e-13 < errors[-1] < errors[0] < 1e-9
    assert abs(slope(steps, errors) - ORDERS[method]) < 0.7


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-12])
def test_error_of_a_path_follows_the_tolerance(driven, method, tolerance):
    """Errors of some tens of steps add up, and the solution halves them or doubles them on its way."""
    path = flow.adaptive(*driven, 0.0, START, 10.0, tolerance, [1.0, 1.0], method)
    assert path.status == "ok"
    assert path.times[0] == 0.0
    assert path.times[-1] == 10.0
    assert (np.diff(path.times) > 0.0).all()
    assert np.abs(path.states - forced_flow(path.times)).max() < 20.0 * tolerance


@pytest.mark.parametrize("method", METHODS)
def test_backwards_and_back(driven, method):
    start = forced_flow(3.0)
    path = flow.adaptive(*driven, 3.0, start, -3.0, 1e-11, [1.0, 1.0], method)
    assert path.status == "ok"
    assert path.times[-1] == -3.0
    assert (np.diff(path.times) < 0.0).all()
    # the second state is unstable backwards from its maximum on: errors grow by some tens
    np.testing.assert_allclose(path.states[-1], forced_flow(-3.0), atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_the_same_steps_again_give_the_same_bits(oscillation, method):
    path = flow.adaptive(*oscillation, 0.0, [2.0, 0.0], 30.0, 1e-9, [1.0, 1.0], method)
    assert path.rejected > 0 or method == "verner98"
    assert np.array_equal(flow.along(*oscillation, path.times, [2.0, 0.0], method), path.states)
    x, _ = flow.tangents(*oscillation, path.times, [2.0, 0.0], np.eye(2), [-1, -1], method, every=True)
    assert np.array_equal(x, path.states)


@pytest.mark.parametrize("method", METHODS)
def test_errors_on_a_grid_are_those_that_control_saw(oscillation, method):
    tolerance, weights = 1e-8, [2.0, 3.0]
    path = flow.adaptive(*oscillation, 0.0, [2.0, 0.0], 30.0, tolerance, weights, method)
    errors = flow.errors_on(*oscillation, path.times, [2.0, 0.0], method, weights)
    assert errors.shape == (len(path.times) - 1,)
    assert errors.max() <= tolerance  # every step was accepted
    assert np.median(errors) > 0.02 * tolerance  # and none much too short
    double = flow.errors_on(*oscillation, path.times, [2.0, 0.0], method, [4.0, 6.0])
    np.testing.assert_allclose(double, errors / 2.0, rtol=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_more_steps_than_there_is_room_for_at_first(method):
    """Long enough that memory is set aside anew twice; nothing of it shows."""
    field = compiled(lambda t, x, p: [x[1], -x[0]], 2)
    c = field.constants([])
    path = flow.adaptive(field, c, 0.0, [1.0, 0.0], 1500.0, 1e-11, [1.0, 1.0], method)
    assert len(path.times) > 1025
    assert np.array_equal(flow.along(field, c, path.times, [1.0, 0.0], method), path.states)
    # one turn and 240 more, and a phase error of each of them
    np.testing.assert_allclose(path.states[-1], [math.cos(1500.0), -math.sin(1500.0)], atol=1e-8)


def test_the_start_is_left_alone(oscillation):
    start = np.array([2.0, 0.0])
    flow.adaptive(*oscillation, 0.0, start, 1.0, 1e-6, np.ones(2))
    flow.along(*oscillation, [0.0, 0.1], start)
    assert start.tolist() == [2.0, 0.0]


def test_evaluations_are_counted(oscillation):
    """Twelve a step, eleven a rejected one, and two to find the first step."""
    path = flow.adaptive(*oscillation, 0.0, [2.0, 0.0], 10.0, 1e-8, [1.0, 1.0])
    steps = len(path.times) - 1
    assert steps < 500
    assert path.evaluations == 2 + 12 * steps + 11 * path.rejected


def test_no_time_at_all(oscillation):
    path = flow.adaptive(*oscillation, 1.0, [2.0, 0.0], 1.0, 1e-8, [1.0, 1.0])
    assert path.status == "ok"
    assert path.times.tolist() == [1.0]
    assert path.states.tolist() == [[2.0, 0.0]]
    assert flow.along(*oscillation, [1.0], [2.0, 0.0]).tolist() == [[2.0, 0.0]]


def test_the_shortest_time(oscillation):
    end = math.nextafter(1.0, 2.0)
    path = flow.adaptive(*oscillation, 1.0, [2.0, 0.0], end, 1e-8, [1.0, 1.0])
    assert path.status == "ok"
    assert path.times.tolist() == [1.0, end]


# -- how paths end -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_a_solution_that_goes_to_infinity(method):
    """x' = x^2 from 1 ends at t = 1. The steps come so close that the next one is lost in rounding."""
    field = compiled(lambda t, x, p: [x[0] * x[0]], 1)
    path = flow.adaptive(field, field.constants([]), 0.0, [1.0], 2.0, 1e-8, [1.0], method)
    assert path.status in ("step_too_small", "not_finite")
    assert np.isfinite(path.states).all()
    assert abs(path.times[-1] - 1.0) < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_a_field_that_ends(method):
    """x' = -1 / sqrt(x) from 1: x^(3/2) = 1 - 3 t / 2 ends at t = 2 / 3, where the root does."""
    field = compiled(lambda t, x, p: [-1.0 / math.sqrt(x[0])], 1)
    c = field.constants([])
    path = flow.adaptive(field, c, 0.0, [1.0], 2.0, 1e-8, [1.0], method)
    assert path.status in ("step_too_small", "not_finite")
    assert np.isfinite(path.states).all()
    assert abs(path.times[-1] - 2.0 / 3.0) < 1e-4
    states = flow.along(field, c, [0.0, 0.3, 0.9, 1.2], [1.0], method)
    assert np.isfinite(states[:2]).all()
    assert np.isnan(states[2:]).all()
    _, x = flow.tangents(field, c, [0.0, 0.3, 0.9, 1.2], [1.0], [[1.0]], [-1], method)
    assert np.isnan(x).all()


def test_a_field_that_does_not_begin():
    field = compiled(lambda t, x, p: [1.0 / x[0]], 1)
    path = flow.adaptive(field, field.constants([]), 0.0, [0.0], 1.0, 1e-8, [1.0])
    assert path.status == "not_finite"
    assert path.times.tolist() == [0.0]


@pytest.mark.parametrize("method", METHODS)
def test_too_many_steps(oscillation, method):
    control = flow.ErrorControl(1e-8, [1.0, 1.0], max_steps=17)
    path = flow.controlled(*oscillation, 0.0, [2.0, 0.0], 100.0, control, method)
    assert path.status == "too_many_steps"
    assert len(path.times) == 18
    assert path.times[-1] < 100.0


@pytest.mark.parametrize("method", METHODS)
def test_stiffness_shows(method):
    """Relaxation with rate 2000 towards cos t needs steps of stability; with rate 1, steps of accuracy."""
    field = compiled(lambda t, x, p: [-p[0] * (x[0] - math.cos(t))], 1, 1)
    stiff, soft = (
        flow.adaptive(field, field.constants([rate]), 0.0, [1.0], 5.0, 1e-6, [1.0], method).stiff_fraction
        for rate in (2000.0, 1.0)
    )
    assert stiff > 0.5
    assert soft == 0.0


# -- threads, refusals ---------------------------------------------------------------------------------------


def test_threads_do_not_meet():
    field = compiled(lorenz, 3, 3, columns=(1,))
    starts = np.random.default_rng(2).normal(0.0, 5.0, (24, 3))
    times = np.linspace(0.0, 2.0, 201)

    def run(start):
        c = field.constants([10.0, 28.0, 8.0 / 3.0])
        path = flow.adaptive(field, c, 0.0, start, 3.0, 1e-10, [10.0] * 3, "verner98")
        driven = flow.tangents(field, c, times, start, np.eye(3, 4), [-1, -1, -1, 0])
        return path.states.tobytes() + driven[0].tobytes() + driven[1].tobytes()

    alone = [run(start) for start in starts]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(run, starts)) == alone


def test_arguments_that_do_not_fit_are_refused(oscillation):
    with pytest.raises(ValueError, match="'euler' is none of dop853, verner98"):
        flow.along(*oscillation, [0.0, 1.0], [2.0, 0.0], "euler")
    with pytest.raises(ValueError, match="start of shape"):
        flow.along(*oscillation, [0.0, 1.0], [2.0])
    with pytest.raises(ValueError, match="weights"):
        flow.adaptive(*oscillation, 0.0, [2.0, 0.0], 1.0, 1e-8, [1.0, 0.0])
    with pytest.raises(ValueError, match="tolerance"):
        flow.adaptive(*oscillation, 0.0, [2.0, 0.0], 1.0, 0.0, [1.0, 1.0])
    with pytest.raises(ValueError, match="driven by"):
        flow.tangents(*oscillation, [0.0, 1.0], [2.0, 0.0], np.eye(2), [0, -1])
    with pytest.raises(ValueError, match="constants"):
        flow.along(oscillation[0], np.empty(9), [0.0, 1.0], [2.0, 0.0])


def test_towards_a_pole_errors_below_rounding_are_not_asked_for():
    """x' = x^2 from 1: x = 1 / (1 - t), at the end 1e7 with roundings of 1e-9.

    A tolerance of 1e-13 for them refuses every step. With `far_out` there are tens of steps a decade; the
    end is as right as the time that is left, 1e-7, which the errors on the way have moved by some 1e-15.
    """
    field = compiled(lambda t, x, p: [x[0] * x[0]], 1)
    arguments = field, field.constants([]), 0.0, [1.0], 1.0 - 1e-7
    control = flow.ErrorControl(1e-13, [1.0], max_steps=3000)
    assert flow.controlled(*arguments, control, "verner98").status == "too_many_steps"
    path = flow.controlled(*arguments, control._replace(far_out=True), "verner98")
    assert (path.status, len(path.times) < 600) == ("ok", True)
    assert path.states[-1, 0] == pytest.approx(1e7, rel=1e-6)
