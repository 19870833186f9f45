"""Dense output: order, nodes, times outside."""

from __future__ import annotations

import numpy as np
import pytest
from flow_fields import compiled, forced, forced_flow

from contwalk import flow

METHODS = ("dop853", "verner98")


@pytest.fixture(scope="module")
def driven():
    field = compiled(forced, 2)
    return field, field.constants([])


def interpolation_error(driven, method, h):
    """Error within forty steps that begin on the exact solution; root mean square."""
    missed = []
    for start in np.linspace(-3.0, 3.0, 40):
        times = np.array([start, start + h])
        states = flow.along(*driven, times, forced_flow(start), method)
        at = np.linspace(*times, 31)
        missed.append(flow.dense(*driven, times, states, at, method) - forced_flow(at))
    return np.sqrt(np.mean(np.square(missed)))


@pytest.mark.parametrize(("method", "local"), [("dop853", 8), ("verner98", 10)])
def test_order(driven, method, local):
    """Polynomials of degree 7 have errors like h^8 in a step, steps of order 9 like h^10."""
    lengths = np.array([0.2, 0.25, 0.3])
    errors = [interpolation_error(driven, method, h) for h in lengths]
    assert errors[0] > 1e-13  # rounding is far below
    assert abs(np.polyfit(np.log(lengths), np.log(errors), 1)[0] - local) < 0.4


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_along_a_path(driven, method, direction):
    end = 4.0 * direction
    path = flow.adaptive(*driven, 0.0, [1.0, 1.0], end, 1e-10, [1.0, 1.0], method)
    at = np.random.default_rng(3).uniform(0.0, 1.0, 500) * end  # in no order
    found = flow.dense(*driven, path.times, path.states, at, method)
    # an interpolant of order 7 in steps for order 8 may lose one or two digits
    np.testing.assert_allclose(found, forced_flow(at), atol=2e-8)


@pytest.mark.parametrize("method", METHODS)
def test_nodes_are_met_bitwise(driven, method):
    path = flow.adaptive(*driven, 0.0, [1.0, 1.0], 4.0, 1e-10, [1.0, 1.0], method)
    assert np.array_equal(flow.dense(*driven, path.times, path.states, path.times, method), path.states)


@pytest.mark.parametrize("method", METHODS)
def test_outside_there_is_nothing(driven, method):
    times = np.array([0.0, 0.2, 0.4])
    states = flow.along(*driven, times, [1.0, 1.0], method)
    found = flow.dense(*driven, times, states, [-0.1, 0.1, 0.5], method)
    assert np.isnan(found).all(axis=1).tolist() == [True, False, True]
    assert flow.dense(*driven, times, states, [], method).shape == (0, 2)
    assert flow.dense(*driven, times[:1], states[:1], [0.0], method).tolist() == [[1.0, 1.0]]


def test_many_steps_in_small_batches(driven, monkeypatch):
    """Memory for the stages of a few steps at a time changes nothing."""
    from contwalk.flow.explicit import runge_kutta as explicit

    times = np.linspace(0.0, 4.0, 41)
    states = flow.along(*driven, times, [1.0, 1.0])
    at = np.linspace(0.0, 4.0, 333)
    whole = flow.dense(*driven, times, states, at)
    monkeypatch.setattr(explicit, "_MOST_KEPT", 200)
    assert np.array_equal(flow.dense(*driven, times, states, at), whole)
