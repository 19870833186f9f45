"""Derivatives of every function a plugin may use, against 60-digit differences of mpmath's own functions."""

from __future__ import annotations

import itertools
import math

import mpmath
import pytest
from function_samples import SAMPLES
from traced_kernels import derivative_of, kernel_of

from contwalk.fields.functions import FUNCTIONS

# mpmath.diff at 60 working digits raises its own precision; its third derivatives keep more than 40 digits.
WORKING, EXACT = 60, mpmath.mpf("1e-40")
# Third derivatives in floats: a dozen roundings of terms that cancel by no more than a factor of a thousand.
FLOATS = 1e-12

CASES = [
    pytest.param(name, orders, id=f"{name}-{''.join(map(str, orders)) or 'value'}")
    for name, sample in SAMPLES.items()
    for order in range(4)
    for orders in itertools.combinations_with_replacement(range(len(sample.points[0])), order)
]


def test_every_function_of_the_table_has_samples():
    assert set(SAMPLES) == set(FUNCTIONS)


def truth(name: str, point: tuple[float, ...], orders: tuple[int, ...]) -> mpmath.mpf:
    counts = tuple(orders.count(i) for i in range(len(point)))
    with mpmath.workdps(WORKING):
        values = tuple(mpmath.mpf(v) for v in point)
        if not orders:
            return SAMPLES[name].truth(*values)
        return mpmath.diff(SAMPLES[name].truth, values, counts)


@pytest.mark.parametrize(("name", "orders"), CASES)
def test_derivative_in_extended_precision(name, orders):
    sample = SAMPLES[name]
    kernel = derivative_of(sample.of_array(), len(sample.points[0]), orders)
    for point in sample.points:
        expected = truth(name, point, orders)
        with mpmath.workdps(WORKING):
            found = kernel.exactly([mpmath.mpf(v) for v in point])[0]
            assert abs(found - expected) <= EXACT * max(1, abs(expected))


@pytest.mark.parametrize(("name", "orders"), CASES)
def test_derivative_in_floats(name, orders):
    sample = SAMPLES[name]
    kernel = derivative_of(sample.of_array(), len(sample.points[0]), orders)
    for point in sample.points:
        expected = float(truth(name, point, orders))
        assert kernel(list(point))[0] == pytest.approx(expected, rel=FLOATS, abs=FLOATS)


COMPOSED = {
    "quotient": lambda x: (x[0] + 0.3 * x[1]) / (1.0 + x[0] * x[1]),
    "pendulum": lambda x: -9.81 / (x[1] + 2.0) * math.sin(x[0]) + 0.1 * x[0] ** 3,
    "scaled twice": lambda x: 0.3 * (0.1 * x[0]) + 0.7 * (0.3 * (x[1] * x[0])),
    "fractional power": lambda x: (x[0] ** 2 + x[1] ** 2) ** (1.0 / 3.0),
    "nested": lambda x: math.exp(math.sin(x[0]) * math.cos(x[1])) - math.log(2.0 + x[0] * x[1]),
}


@pytest.mark.parametrize("orders", [(0,), (1,), (0, 1), (0, 0), (0, 0, 1), (1, 1, 1)])
@pytest.mark.parametrize("name", COMPOSED)
def test_chain_rule_is_exact_beyond_floats(name, orders):
    """The derivative belongs to the very function that is evaluated, to all digits."""
    value = kernel_of(COMPOSED[name], 2)
    kernel = derivative_of(COMPOSED[name], 2, orders)
    with mpmath.workdps(WORKING):
        point = (mpmath.mpf(0.37), mpmath.mpf(0.91))
        counts = tuple(orders.count(i) for i in range(2))
        expected = mpmath.diff(lambda a, b: value.exactly([a, b])[0], point, counts)
        assert abs(kernel.exactly(list(point))[0] - expected) <= EXACT * max(1, abs(expected))


@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 5, 16, -1, -2, -3])
def test_whole_powers_have_derivatives_at_negative_numbers(exponent):
    kernel = derivative_of(lambda x: x[0] ** exponent, 1, (0,))
    # one rounding for each factor of a product of at most 16
    assert kernel([-1.7])[0] == pytest.approx(exponent * (-1.7) ** (exponent - 1), rel=1e-14)


def test_whole_powers_have_derivatives_at_zero():
    assert derivative_of(lambda x: x[0] ** 2, 1, (0, 0))([0.0])[0] == 2.0
    assert derivative_of(lambda x: x[0] ** 3, 1, (0, 0, 0))([0.0])[0] == 6.0
    assert derivative_of(lambda x: x[0] ** 3, 1, (0, 0))([0.0])[0] == 0.0
