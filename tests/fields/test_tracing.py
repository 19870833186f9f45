"""What a plugin's function may do: the trace computes what the function itself computes, on every path."""

from __future__ import annotations

import functools
import math
from math import cos, exp
from math import sin as sine

import mpmath
import numpy as np
import pytest
from traced_kernels import derivative_of, kernel_of

from contwalk.fields.trace import Fork, Outputs, trace

STIFFNESS = 3.0
TABLE = (0.5, -1.0, 2.0)


def _spring(length, rest=1.0):
    return STIFFNESS * (length - rest)


def _polynomial(x, coefficients):
    total = 0.0
    for c in reversed(coefficients):
        total = total * x + c
    return total


def _closure(gain):
    def scaled(x):
        return gain * math.tanh(x)

    return scaled


_amplified = _closure(2.5)
_half = functools.partial(_polynomial, coefficients=(0.0, 0.5))


def branches(x):
    if x[0] > 1.0 and x[1] < 0.0:
        return x[0] * x[1]
    if x[0] == x[1]:
        return 7.0 * x[0]
    return x[0] - x[1] if not x[0] >= 0.5 else x[0] + math.exp(x[1])


def stepwise(x):
    if x[0] < -1.0:
        slope = -1.0
    elif x[0] <= 1.0:
        slope = x[0]
    else:
        slope = 1.0
    return slope * x[1]


def chained(x):
    return x[0] if -1.0 < x[0] <= 1.0 else x[1]


def loop(x):
    total = 0.0
    for i in range(len(x)):
        for j in range(i):
            total += math.sin(x[i] - x[j])
    return total


def counted_while(x):
    i, product = 0, 1.0
    while i < 3:
        product *= x[0] + i
        i += 1
    return product


def arrays(x):
    weights = np.array([1.0, 2.0])
    work = np.zeros(2)
    work[0] = x[0] * x[1]
    work[1:] = x[1:] ** 2
    return np.dot(weights, work) + np.sum(np.sin(x)) + (work * weights).sum()


def matrix(x):
    rotation = np.array([[np.cos(x[0]), -np.sin(x[0])], [np.sin(x[0]), np.cos(x[0])]])
    return rotation @ np.array([x[1], 1.0])


def swapped(x):
    first, second = x
    first, second = second, first
    return [first - 2.0 * second, *[v**2 for v in x]]


FUNCTIONS_OF_TWO = {
    "if and else": branches,
    "elif": stepwise,
    "chained comparison": chained,
    "conditional expression": lambda x: x[0] if x[0] > x[1] else math.cos(x[1]),
    "min and max": lambda x: min(x[0], x[1], 0.3) + max([x[0], x[1]]) * 2.0,
    "abs": lambda x: abs(x[0]) + math.fabs(x[1]) + np.abs(x[0] * x[1]),
    "where": lambda x: np.where(x[0] > 0.2, x[0] * x[1], math.sin(x[1])),
    "where of arrays": lambda x: np.where(x > 0.2, x**2, -x),
    "minimum of arrays": lambda x: np.minimum(x, 0.3) + np.maximum(x, -x),
    "loop": loop,
    "while with a known end": counted_while,
    "sum of a generator": lambda x: sum(c * v for c, v in zip(TABLE, x, strict=False)),
    "helper with a default": lambda x: _spring(x[0]) + _spring(x[1], rest=0.5),
    "helper with a global": lambda x: _polynomial(x[0], TABLE) * STIFFNESS,
    "closure": lambda x: _amplified(x[0]) - _amplified(x[1]),
    "partial": lambda x: _half(x[0]) * x[1],
    "imported names": lambda x: sine(x[0]) * cos(x[1]) + exp(-x[0]),
    "numpy names": lambda x: np.arctan2(x[0], x[1] + 3.0) + np.sqrt(x[0] ** 2 + 1.0) + np.power(2.0, x[1]),
    "arrays": arrays,
    "matrix product": matrix,
    "several results": swapped,
    "logarithm to a base": lambda x: math.log(x[0] ** 2 + 2.0, 3.0),
    "degrees": lambda x: math.radians(x[0]) + np.rad2deg(x[1]),
    "copysign": lambda x: math.copysign(x[0], x[1]),
    "remainder": lambda x: (x[0] * 5.0) % 2.0,
    "combined conditions": lambda x: np.where((x[0] > 0.2) & ~(x[1] > 0.5) | (x[0] < -1.0), x[0] ** 2, x[1]),
    "combined conditions of arrays": lambda x: np.where((x > 0.2) | (x < -1.0), x**2, 3.0 * x),
    "floor division": lambda x: (x[0] * 3.1) // 0.7 + x[1],
    "sign": lambda x: np.sign(x[0]) * x[1],
    "powers": lambda x: x[0] ** 3 + (x[1] ** 2 + 1.0) ** 0.5 + 2.0 ** x[0] + pow(x[1], 2),
    "float": lambda x: float(x[0]) * np.float64(2.0) + np.pi + 3,
    "heaviside by comparison": lambda x: (x[0] if x[0] > 0 else 0.0) ** 2,
}
POINTS = [[0.7, -0.4], [1.6, -0.9], [-1.4, 0.6], [0.1, 0.1], [0.4, 1.2], [-0.3, -2.0]]


@pytest.mark.parametrize("name", FUNCTIONS_OF_TWO)
def test_trace_computes_what_the_function_computes(name):
    function = FUNCTIONS_OF_TWO[name]
    kernel = kernel_of(function, 2)
    for point in POINTS:
        expected = np.atleast_1d(np.asarray(function(np.array(point)), dtype=float))
        # powers are products in the trace and libm's pow in Python: a few roundings
        np.testing.assert_allclose(kernel(point), expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("name", FUNCTIONS_OF_TWO)
def test_trace_is_the_same_in_any_arithmetic(name):
    kernel = kernel_of(FUNCTIONS_OF_TWO[name], 2)
    for point in POINTS:
        with mpmath.workdps(30):
            exact = [float(v) for v in kernel.exactly([mpmath.mpf(v) for v in point])]
        np.testing.assert_allclose(kernel(point), exact, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("name", FUNCTIONS_OF_TWO)
def test_derivative_is_that_of_the_path_taken(name):
    """Away from where paths meet, against 40-digit differences with a step of 1e-20."""
    kernel = kernel_of(FUNCTIONS_OF_TWO[name], 2)
    derivative = derivative_of(FUNCTIONS_OF_TWO[name], 2, (0,))
    for point in ([0.71, -0.43], [1.63, -0.91], [-1.42, 0.61], [0.42, 1.21]):
        with mpmath.workdps(40):
            h = mpmath.mpf("1e-20")
            x, y = (mpmath.mpf(v) for v in point)
            expected = [
                float((a - b) / (2 * h))
                for a, b in zip(kernel.exactly([x + h, y]), kernel.exactly([x - h, y]), strict=True)
            ]
        np.testing.assert_allclose(derivative(point), expected, rtol=1e-13, atol=1e-13)


def test_numba_function_is_traced_through_its_original():
    numba = pytest.importorskip("numba")

    @numba.njit
    def damping(v):
        return 0.2 * v + 0.1 * v**3 if v > 0.0 else 0.3 * v

    def force(x):
        return -damping(x[0]) - math.sin(x[1])

    kernel = kernel_of(force, 2)
    for point in POINTS:
        # v**3 is a product here, and may be one of another order there
        assert kernel(point)[0] == pytest.approx(force(np.array(point)), rel=1e-14)


def test_plugin_itself_is_left_as_it_is():
    before = dict(branches.__globals__)
    kernel_of(branches, 2)
    assert branches.__globals__ == before
    assert branches.__globals__["math"] is math


def test_a_comparison_is_explored_both_ways_once():
    def function(x):
        first = x[0] if x[0] > 0.0 else -x[0]
        second = x[0] * 2.0 if x[0] > 0.0 else 5.0  # the same comparison: no further path
        return first + second

    calls = []

    def counted(tracer):
        calls.append(1)
        return [function([tracer.symbol("u", 0)])]

    program = trace(counted)
    assert len(calls) == 2
    assert isinstance(program.tree, Fork)
    assert all(isinstance(leaf, Outputs) for leaf in program.leaves())


def test_comparisons_of_constants_are_no_paths():
    program = trace(lambda tracer: [tracer.symbol("u", 0) if tracer.symbol("u", 0) * 0.0 < 1.0 else 3.0])
    assert isinstance(program.tree, Outputs)


def test_where_evaluates_only_the_side_it_takes():
    """As a plugin's author expects of numpy.where around a division: no NaN from the other side."""
    kernel = kernel_of(lambda x: np.where(x[0] > 0.0, x[0] / (x[0] + 1.0), 2.0 * x[0]), 1)
    assert kernel([-1.0])[0] == -2.0


class Spring:
    """A law with constants of its own, as a method and as an object that is called."""

    def __init__(self, stiffness):
        self.stiffness = stiffness

    def force(self, x):
        return -self.stiffness * math.sin(x[0])

    def __call__(self, x):
        return self.force(x)


def test_bound_methods_are_traced():
    spring = Spring(3.0)
    assert kernel_of(spring.force, 1)([0.5])[0] == -3.0 * math.sin(0.5)


@pytest.mark.parametrize("x", [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])
def test_both_and_either_of_two_comparisons_are_what_they_say(x):
    """`np.logical_and` and `np.logical_or` in an `if`: the second is only asked where it decides."""

    def chosen(v):
        both = 2.0 if np.logical_and(v[0] > 0.0, v[1] > 0.0) else 3.0
        return both * (5.0 if np.logical_or(v[0] > 0.0, v[1] > 0.0) else 7.0)

    assert kernel_of(chosen, 2)(x) == chosen(x)


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("value", [-1.0, 1.0])
def test_comparisons_are_combined_with_what_is_known_already(known, value):
    """As NumPy does with its bools; a switch that is set in the plugin's text is one."""

    def chosen(v):
        either, both = (v[0] > 0.0) | known, (v[0] > 0.0) & known
        return (2.0 if either else 3.0) * (5.0 if both else 7.0)

    assert kernel_of(chosen, 1)((value,)) == chosen((np.bool_(value > 0.0) * 2.0 - 1.0,))


@pytest.mark.parametrize("factor", [0.0, 1.0, -1.0, 0.5, -0.5, 1.5, -1.5, 2.0, -2.0])
def test_products_and_quotients_with_constants_are_what_they_say(factor):
    """Those with one and minus one are left out of the code."""

    def scaled(v):
        return factor * v[0] + v[0] * factor, v[0] / (factor or 3.0), factor / v[0]

    assert tuple(kernel_of(scaled, 1)((0.7,))) == scaled((0.7,))
