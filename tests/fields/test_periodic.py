"""What is the same a period later, by its form: told only where it is so."""

from __future__ import annotations

import math

import pytest
from traced_kernels import program_of

from contwalk.fields.periodic import repeats
from contwalk.fields.trace import roots

TURN = 2.0 * math.pi


def told(function, period=TURN):
    program = program_of(function, 2)
    return repeats(program.graph, roots(program.tree), program.graph.input("u", 0), period)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: [math.sin(x[0]) * x[1], math.cos(3.0 * x[0] - x[1])],
        lambda x: [math.tan(x[0] / 2.0), math.exp(math.sin(x[1] - x[0]))],
        lambda x: [(x[0] + x[1]) - x[0]],
        lambda x: [x[1] if math.sin(x[0]) < x[1] else -x[1]],
        lambda x: [x[1] ** 2],  # reads no angle at all
    ],
)
def test_told_where_it_is_seen(function):
    assert told(function)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: [math.sin(x[0]), x[0]],
        lambda x: [math.sin(x[0] / 2.0)],  # has twice the period
        lambda x: [math.sin(x[0] * x[1])],
        lambda x: [math.cos(x[0] ** 2)],
        lambda x: [x[1] if x[0] < x[1] else -x[1]],
        lambda x: [math.tan(x[0] / 3.0)],
        lambda x: [math.sin(1.0 / x[0])],
    ],
)
def test_not_told_where_it_is_not(function):
    assert not told(function)


def test_a_period_typed_with_few_digits_is_none():
    assert not told(lambda x: [math.sin(x[0])], 6.2831853)
