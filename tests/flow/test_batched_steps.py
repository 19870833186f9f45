"""Tangents whose Jacobians were evaluated in lanes: those of one pass, bitwise, of any number of steps."""

from __future__ import annotations

import numpy as np
import pytest
from flow_fields import compiled, forced, lorenz

from contwalk import flow
from contwalk.flow.compiled.restricted import Restricted
from contwalk.flow.explicit import batched_steps

PARAMETERS = np.array([10.0, 28.0, 8.0 / 3.0])
# More steps than are recorded at once, and numbers of stages that fill no last batch.
STEPS = (1, 2, 3, 17, 40)


@pytest.fixture(autouse=True)
def small_ones_too(monkeypatch):
    monkeypatch.setattr(batched_steps, "WORTH", 1)


def forking(t, x, p):
    return [p[0] * (x[1] - x[0]), x[0] * (p[1] - x[2]) - x[1] if x[0] < 3.0 else -x[1], x[0] * x[1] - x[2]]


def passes(field, c, steps, method, start=(1.0, 2.0, 20.0)):
    """By batches, and by one pass."""
    n, k = field.n, field.k
    times, sources = np.linspace(0.0, 0.5, steps + 1), np.append(np.full(n, -1), np.arange(k))
    given = field, c, times, np.array(start), np.eye(n, n + k), sources, method
    x, every = flow.tangents(*given, every=True)
    assert not field.forms or not any("lanes" in method for method, _ in field.forms)
    return flow.tangents(*given), (x[-1], every[-1])


@pytest.mark.parametrize("method", ["dop853", "verner98"])
@pytest.mark.parametrize("steps", STEPS)
def test_they_are_those_of_one_pass(method, steps):
    field = compiled(lorenz, 3, 3, (1, 2))
    (x, found), (end, expected) = passes(field, field.constants(PARAMETERS), steps, method)
    assert any("lanes" in method for method, _ in field.forms)
    np.testing.assert_array_equal(x, end)
    np.testing.assert_array_equal(found, expected)


def test_many_columns_go_in_blocks():
    """Of a chain of 30 states more columns than the first cache holds; one reads the time."""

    def chain(t, x, p):
        along = [x[i - 1] - 2.0 * x[i] + x[(i + 1) % 30] - p[0] * x[i] ** 3 for i in range(30)]
        along[0] = along[0] + np.sin(t)
        return along

    field = compiled(chain, 30, 1, (0,))
    start = np.cos(np.arange(30.0))
    (x, found), (end, expected) = passes(field, field.constants(np.array([0.3])), 21, "dop853", start)
    np.testing.assert_array_equal(x, end)
    np.testing.assert_array_equal(found, expected)


def test_a_field_of_which_some_states_exist():
    whole = compiled(lorenz, 3, 3, (1, 2))
    field = Restricted(whole, (0, 1), PARAMETERS[:1])
    given = field.constants(PARAMETERS[1:])
    (x, found), (end, expected) = passes(field, given, 17, "dop853", (1.0, 2.0))
    np.testing.assert_array_equal(x, end)
    np.testing.assert_array_equal(found, expected)


def test_a_field_that_branches_goes_in_one_pass():
    field = compiled(forking, 3, 2, (1,))
    assert field.batched is None
    (x, found), (end, expected) = passes(field, field.constants(PARAMETERS[:2]), 17, "dop853")
    np.testing.assert_array_equal(x, end)
    np.testing.assert_array_equal(found, expected)


def test_what_has_no_value_is_told_as_in_one_pass():
    field = compiled(lambda t, x, p: [np.sqrt(x[0]) - 5.0, x[1]], 2)
    (x, found), (end, expected) = passes(field, field.constants(np.zeros(0)), 30, "dop853", (1.0, 1.0))
    np.testing.assert_array_equal(x, end)
    np.testing.assert_array_equal(found, expected)
    assert np.isnan(x).any()


def test_calls_do_not_feel_each_other():
    """They share memory, of which nothing is left over that matters."""
    field = compiled(forced, 2)
    c, times = field.constants(np.zeros(0)), np.linspace(0.0, 1.0, 6)
    columns, undriven = np.eye(2), [-1, -1]
    first = flow.tangents(field, c, times, [1.0, 1.0], columns, undriven)
    with np.errstate(all="ignore"):
        flow.tangents(field, c, np.linspace(0.0, 1.0, 33), [np.inf, np.nan], columns, undriven)
    again = flow.tangents(field, c, times, [1.0, 1.0], columns, undriven)
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one, other)


def test_small_fields_go_in_one_pass(monkeypatch):
    """Preparing two passes would cost more than they save."""
    monkeypatch.undo()
    field = compiled(lorenz, 3, 3, (1, 2))
    passes(field, field.constants(PARAMETERS), 17, "dop853")
    assert not any("lanes" in method for method, _ in field.forms)
