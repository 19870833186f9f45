"""Exceptions of a plugin on one of its paths, and results that are no numbers."""

from __future__ import annotations

import inspect
import math

import mpmath
import numpy as np
import pytest
from traced_kernels import derivative_of, kernel_of, program_of

from contwalk.errors import PluginError
from contwalk.fields.blame import first_not_finite
from contwalk.fields.kernel import Kernel


def level(x):
    if x[0] < 0.0:
        raise ValueError("the tank is empty")
    return math.sqrt(x[0]) * 2.0


def line_of(function, text):
    source, first = inspect.getsourcelines(function)
    return first + next(k for k, line in enumerate(source) if text in line)


def test_raising_path_raises_only_where_it_is_taken():
    kernel = kernel_of(level, 1)
    assert kernel([4.0])[0] == 4.0
    with pytest.raises(PluginError) as caught:
        kernel([-1.0])
    assert f"{__file__}, line {line_of(level, 'raise')}" in caught.value.sentence
    assert "ValueError: the tank is empty" in caught.value.sentence


def test_raising_path_raises_in_derivatives_and_in_extended_precision():
    derivative = derivative_of(level, 1, (0,))
    assert derivative([4.0])[0] == 0.5
    with pytest.raises(PluginError, match="the tank is empty"):
        derivative([-1.0])
    with mpmath.workdps(30), pytest.raises(PluginError, match="the tank is empty"):
        derivative.exactly([mpmath.mpf(-1)])


NOT_NUMBERS = {
    "logarithm of a negative number": (lambda x: math.log(x[0]), [-1.0]),
    "logarithm of zero": (lambda x: math.log(x[0]), [0.0]),
    "square root of a negative number": (lambda x: math.sqrt(x[0]), [-1.0]),
    "arc sine beyond one": (lambda x: math.asin(x[0]), [1.5]),
    "division by zero": (lambda x: 1.0 / x[0], [0.0]),
    "zero over zero": (lambda x: x[0] / x[0], [0.0]),
    "zero to a negative power": (lambda x: x[0] ** -2, [0.0]),
    "root of a negative number": (lambda x: x[0] ** 0.5, [-1.0]),
    "overflow of exp": (lambda x: math.exp(x[0]), [1e4]),
    "overflow of a product": (lambda x: x[0] * x[0] * x[0], [1e200]),
    "NaN in": (lambda x: x[0] + 1.0, [math.nan]),
}


@pytest.mark.parametrize("name", NOT_NUMBERS)
def test_not_finite_never_raises(name):
    function, point = NOT_NUMBERS[name]
    assert not np.isfinite(kernel_of(function, 1)(point)[0])


def test_result_has_its_shape_even_where_it_does_not_exist():
    program = program_of(lambda x: [math.log(x[0]), x[0], 1.0, 2.0], 1)
    found = Kernel(program, ("u",), (2, 2))([-1.0])
    assert found.shape == (2, 2)
    assert np.all(np.isnan(found))


def field_with_a_logarithm(t, x, p, dx):
    dx[0] = x[1]
    height = math.log(x[0] - p.floor)
    dx[1] = -p.g * height


def field_with_an_overflow(t, x, p, dx):
    square = x[0] * x[0]
    dx[0] = square
    dx[1] = math.exp(square)


def field_that_is_fine(t, x, p, dx):
    dx[0] = x[1] if x[0] > p.floor else -x[1]
    dx[1] = np.where(x[0] > 0, math.cos(x[0]), 1.0) * p.g


@pytest.mark.parametrize(
    ("field", "state", "text", "what"),
    [
        (field_with_a_logarithm, [0.5, 0.0], "math.log", "log of -0.5"),
        (field_with_an_overflow, [1e3, 0.0], "math.exp", "exp of 1e+06"),
        (field_with_an_overflow, [1e200, 0.0], "square = ", "mul of 1e+200, 1e+200 is inf"),
    ],
)
def test_blame_finds_the_line(field, state, text, what):
    found = first_not_finite(field, 0.0, state, {"floor": 1.0, "g": 9.81})
    assert found == f"{__file__}, line {line_of(field, text)}: {what}"


def test_blame_finds_nothing_where_all_is_finite():
    assert first_not_finite(field_that_is_fine, 0.0, [0.5, 0.1], {"floor": 1.0, "g": 9.81}) is None
