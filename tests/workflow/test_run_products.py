"""Products of numbers and parameters in a run file."""

from __future__ import annotations

import math

import pytest
from pydantic_core import PydanticCustomError

from contwalk.workflow.run_file.products import as_products, product

PARAMETERS = {"m1": 0.5, "l1": 4.0, "M": 8.0, "zero": 0.0, "e1": 3.0}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        (3, 3.0),
        (-0.5, -0.5),
        ("2", 2.0),
        ("2*pi", 2.0 * math.pi),
        ("-pi / 2", -math.pi / 2.0),
        ("+1e-3*m1", 0.5e-3),
        ("0.4*m1*l1/M", 0.4 * 0.5 * 4.0 / 8.0),
        ("m1/l1/M", 0.5 / 4.0 / 8.0),
        (".5*e1", 1.5),
        ("2.*e1", 6.0),
    ],
)
def test_a_product_has_its_value(text, value):
    assert product(text).value(PARAMETERS) == pytest.approx(value, rel=1e-15)


def test_a_product_knows_its_parameters():
    assert product("0.4*m1*l1/M*pi").names == ("m1", "l1", "M")
    assert product(2).names == ()


def test_division_by_zero_is_not_a_number():
    assert math.isnan(product("1/zero").value(PARAMETERS))


@pytest.mark.parametrize(
    "text", ["", "*2", "2*", "2**3", "2 pi", "a+b", "(2)", "2*-3", "sin(x)", "1e999", "--2"]
)
def test_anything_else_is_refused(text):
    with pytest.raises(PydanticCustomError):
        product(text)


@pytest.mark.parametrize("value", [True, None, [1], {"a": 1}, math.inf])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(PydanticCustomError):
        product(value)


def test_an_interval_has_two_ends():
    low, high = as_products([0, "2*pi"])
    assert (low.value({}), high.value({})) == (0.0, 2.0 * math.pi)
    for wrong in ([1], [1, 2, 3], "0, 1", 3):
        with pytest.raises(PydanticCustomError):
            as_products(wrong)
