"""Calls of explicit methods leave their memory to each other, and nothing of what they wrote there."""

from __future__ import annotations

import numpy as np
import pytest
from small_flows import field_of

from contwalk import flow
from contwalk.flow.explicit.driver_call import Call

METHODS = ("dop853", "verner98")


def pole():
    """x' = p x^2 and a state that is driven by it: x = 1 runs off to a pole at 1 / p."""
    return field_of(lambda t, x, p: [p[0] * x[0] * x[0], x[0] - x[1]], 2, 1, [0])


def everything(field, method, c):
    """A path, the same steps, their tangents and errors, and states between them."""
    path = flow.adaptive(field, c, 0.0, [1.0, 0.5], 0.5, 1e-9, [1.0, 1.0], method)
    tangents = flow.tangents(field, c, path.times, [1.0, 0.5], np.eye(2, 3), [-1, -1, 0], method)
    errors = flow.errors_on(field, c, path.times, [1.0, 0.5], method, [1.0, 1.0])
    between = flow.dense(field, c, path.times, path.states, np.linspace(0.0, 0.5, 7), method)
    found = [path.times, path.states, *tangents, errors, between]
    return [np.array(array).tobytes() for array in found]


@pytest.mark.parametrize("method", METHODS)
def test_a_call_after_one_that_met_a_pole_is_as_the_first(method):
    field = pole()
    c = field.constants([1.0])
    first = everything(field, method, c)
    with np.errstate(all="ignore"):
        beyond = flow.along(field, c, np.array([0.0, 0.9, 3.0, 1e3]), [1.0, 0.5], method)
        grid = np.array([0.0, 0.9, 3.0, 1e3])
        flow.tangents(field, c, grid, [1.0, 0.5], np.full((2, 3), 1e300), [-1, -1, 0], method)
    assert not np.isfinite(beyond).all()
    assert everything(field, method, c) == first


def test_a_call_takes_the_memory_of_one_that_is_over():
    field = pole()
    c = field.constants([1.0])
    first = Call(field, c, "dop853", [1.0, 0.5])
    second = Call(field, c, "dop853", [1.0, 0.5])
    assert first.vectors is not second.vectors
    first.over()
    assert Call(field, c, "dop853", [1.0, 0.5]).vectors is first.vectors
