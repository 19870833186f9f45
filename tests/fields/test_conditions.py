"""Conditions in every arithmetic: generated Python, machine code, and mpmath numbers give what NumPy gives.

Where NumPy's answer would rest on a comparison with NaN, all three give NaN instead: `sqrt(-1) < 1` is no
fact about the state. Where it does not, since the other side of `&` or `|` decides, all three give NumPy's.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from traced_kernels import derivative_of, kernel_of, program_of

from contwalk.flow.compiled.field import Field

POINTS = (-2.0, -1.0, -0.5, 0.0, 0.25, 1.0, 1.5, 4.0, 2000.0)

# Functions whose value NumPy decides without a comparison with NaN, or by one that changes nothing.
DECIDED = {
    "or, undefined second": lambda x: np.where((x[0] < 0) | (np.sqrt(x[0]) < 1), 1.0, 2.0),
    "or, undefined first": lambda x: np.where((np.sqrt(x[0]) < 1) | (x[0] < 0), 1.0, 2.0),
    "and, undefined second": lambda x: np.where((x[0] >= 0) & (np.sqrt(x[0]) < 1), 1.0, 2.0),
    "and, undefined first": lambda x: np.where((np.sqrt(x[0]) < 1) & (x[0] >= 0), 1.0, 2.0),
    "not of and": lambda x: np.where(~((np.log(x[0]) > 0) & (x[0] > 0)), x[0], 3.0),
    "not inside": lambda x: np.where((x[0] <= 0) | ~(np.log(x[0]) > 0), x[0] ** 2, 3.0),
    "nested": lambda x: np.where(
        (x[0] <= 0) | ((np.log(x[0]) > 0) & ((x[0] > 2.0) | (np.sqrt(x[0] - 1.0) < 0.5))), 1.0, x[0]
    ),
    "a choice in a condition": lambda x: np.where(np.where(x[0] > 0, np.sqrt(x[0]), -x[0]) < 1.0, 1.0, x[0]),
    "equal": lambda x: np.where((x[0] == 1.0) | (x[0] == 0.25), 5.0, x[0]),
    "not equal": lambda x: np.where(x[0] != 1.0, 5.0, x[0]),
    "a condition as a number": lambda x: (x[0] > 0.0) * x[0] + 2.0 * (x[0] < -0.75),
    "a sum of conditions": lambda x: sum([(x[0] > k) for k in range(3)], 0.0),
    "the difference of conditions": lambda x: (x[0] > 0.0) * 1.0 - (x[0] < 0.0),
    "equal conditions": lambda x: np.where((x[0] > 0) == (x[0] > 1.0), 1.0, 2.0),
    "a number as a condition": lambda x: np.where(x[0] * (x[0] > 0.0), 1.0, 2.0),
    "logical functions": lambda x: np.where(
        np.logical_or(np.logical_and(x[0] > 0, x[0] < 1), np.logical_not(x[0] < 3)), 1.0, 2.0
    ),
}

# Values that depend on what a comparison with NaN would say, and where they do.
OPEN = {
    "less": (lambda x: np.where(np.sqrt(x[0]) < 1.0, 1.0, 2.0), -1.0),
    "not less": (lambda x: np.where(~(np.sqrt(x[0]) < 1.0), 1.0, 2.0), -1.0),
    "less or equal": (lambda x: np.where(np.log(x[0]) <= 1.0, 1.0, 2.0), -1.0),
    "equal": (lambda x: np.where(np.sqrt(x[0]) == 1.0, 1.0, 2.0), -1.0),
    "and": (lambda x: np.where((np.sqrt(x[0]) < 1.0) & (x[0] < 0), 1.0, 2.0), -1.0),
    "or": (lambda x: np.where((np.sqrt(x[0]) < 1.0) | (x[0] > 0), 1.0, 2.0), -1.0),
    "both": (lambda x: np.where((np.sqrt(x[0]) < 1.0) | (np.log(x[0]) < 1.0), 1.0, 2.0), -1.0),
    "division by zero": (lambda x: np.where(1.0 / x[0] > 1.0, 1.0, 2.0), 0.0),
    "overflow": (lambda x: np.where(np.exp(x[0]) > 1.0, 1.0, 2.0), 2000.0),
    "the state is NaN": (lambda x: np.where(x[0] > 1.0, 1.0, 2.0), math.nan),
    "if, the state is NaN": (lambda x: 1.0 if x[0] > 1.0 else 2.0, math.nan),
    "if": (lambda x: 1.0 if np.sqrt(x[0]) < 1.0 else 2.0, -1.0),
    "smaller of two": (lambda x: min(x[0], 1.0), math.nan),
    "larger of two": (lambda x: max(1.0, x[0]), math.nan),
}


def compiled(function):
    field = Field(program_of(function, 1), [("u", 0)], {}, outputs=1)
    return lambda x: float(field(0.0, [x], field.constants([]))[0])


def exact(function):
    kernel = kernel_of(function, 1)
    return lambda x: float(kernel.exactly([mpmath.mpf(x)])[0])


def python(function):
    kernel = kernel_of(function, 1)
    return lambda x: float(kernel([x])[0])


ARITHMETICS = {"generated Python": python, "machine code": compiled}


@pytest.mark.parametrize("name", DECIDED)
@pytest.mark.parametrize("arithmetic", [*ARITHMETICS, "mpmath"])
def test_conditions_decide_as_numpys_do(name, arithmetic):
    function = DECIDED[name]
    own = (ARITHMETICS | {"mpmath": exact})[arithmetic](function)
    for x in POINTS:
        with np.errstate(all="ignore"):
            expected = float(function(np.array([x])))
        assert own(x) == expected, x


@pytest.mark.parametrize("name", OPEN)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_what_rests_on_a_comparison_with_nan_is_nan(name, arithmetic):
    function, x = OPEN[name]
    own = ARITHMETICS[arithmetic](function)
    assert math.isnan(own(x))
    assert math.isfinite(own(0.5))


@pytest.mark.parametrize("name", ["less", "not less", "and", "or", "both", "if", "equal"])
def test_what_rests_on_a_comparison_with_nan_is_nan_in_extended_precision(name):
    function, x = OPEN[name]
    try:
        value = exact(function)(x)
    except ArithmeticError:  # `if` has no outcome
        assert name == "if"
        return
    assert math.isnan(value)


def test_derivatives_of_a_choice_are_those_of_the_side_that_is_taken():
    slope = derivative_of(
        lambda x: np.where((np.sqrt(x[0]) < 1) | (x[0] < 0), x[0] ** 2, 7.0 * x[0]), 1, (0,)
    )
    assert slope([-3.0])[0] == -6.0
    assert slope([0.25])[0] == 0.5
    assert slope([4.0])[0] == 7.0


def test_truth_of_a_number_is_that_it_is_not_zero():
    kernel = kernel_of(lambda x: 1.0 if x[0] else 2.0, 1)
    assert [kernel([v])[0] for v in (0.0, -0.0, 3.0, -1e-300)] == [2.0, 2.0, 1.0, 1.0]
