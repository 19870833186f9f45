"""The graph: sharing, folding, and that rewriting never changes a number."""

from __future__ import annotations

import math
import operator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from traced_kernels import kernel_of, program_of

from contwalk.fields.graph import Graph


def test_equal_operations_are_one_node():
    program = program_of(
        lambda x: [math.sin(x[0]) * x[1], x[1] * math.sin(x[0]), x[0] + x[1], x[1] + x[0]], 2
    )
    product, same_product, total, same_total = program.tree.nodes
    assert product == same_product
    assert total == same_total
    assert sum(key[0] == "sin" for key in program.graph.nodes) == 1


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (lambda x: x[0] + 0.0, ("input", "u", 0)),
        (lambda x: x[0] * 1.0, ("input", "u", 0)),
        (lambda x: x[0] / 1.0, ("input", "u", 0)),
        (lambda x: -(0.0 - x[0]), ("input", "u", 0)),
        (lambda x: x[0] ** 1, ("input", "u", 0)),
        (lambda x: x[0] * 0.0, ("const", 0.0, 1.0)),
        (lambda x: x[0] ** 0, ("const", 1.0, 1.0)),
        (lambda x: +x[0], ("input", "u", 0)),
    ],
)
def test_what_is_trivial_is_not_computed(function, expected):
    program = program_of(function, 1)
    assert program.graph.nodes[program.tree.nodes[0]] == expected


@pytest.mark.parametrize(
    "function",
    [
        lambda x: 0.0 * math.log(1.5 - x[0]) + x[1],
        lambda x: x[1] - math.sqrt(1.5 - x[0]) * 0.0,
        lambda x: x[1] + 0.0 * (2.0 + math.asin(x[0] / 1.5) * x[1]),
        lambda x: x[1] + 0.0 * (1.5 - x[0]) ** x[1],
    ],
)
def test_zero_times_what_has_a_domain_is_a_number_inside_of_it_only(function):
    kernel = kernel_of(function, 2)
    assert kernel(np.array([1.2, 0.7]))[0] == 0.7
    assert math.isnan(kernel(np.array([1.7, 0.7]))[0])


def test_zero_times_what_is_a_number_everywhere_is_zero():
    def function(x):
        return 0.0 * (math.sin(x[0]) + math.exp(x[1]) / (1.0 + x[0] ** 2))

    program = program_of(function, 2)
    assert program.graph.value(program.tree.nodes[0]) == 0.0


def test_zero_times_infinity_is_kept():
    program = program_of(lambda x: 0.0 * (x[0] + math.inf), 1)
    assert program.graph.value(program.tree.nodes[0]) is None


def test_constants_are_folded_where_nothing_is_lost():
    graph = Graph()
    assert graph.value(graph.add(graph.constant(0.5), graph.constant(0.25))) == 0.75
    assert graph.value(graph.div(graph.constant(3.0), graph.constant(4.0))) == 0.75
    assert graph.value(graph.call("abs", graph.constant(-2.25))) == 2.25


def test_constants_that_rounding_would_change_are_left_to_the_arithmetic_asked_for():
    graph = Graph()
    tenth, three = graph.constant(0.1), graph.constant(3.0)
    for node in (graph.mul(tenth, three), graph.add(tenth, three), graph.div(graph.one, three)):
        assert graph.value(node) is None
    assert graph.value(graph.call("sqrt", graph.constant(2.0))) is None
    assert graph.value(graph.mul(graph.constant(1e200), graph.constant(1e200))) is None


def test_signed_zeros_are_kept_apart():
    graph = Graph()
    assert math.copysign(1.0, graph.value(graph.constant(-0.0))) == -1.0
    assert graph.constant(0.0) != graph.constant(-0.0)


def test_function_outside_its_domain_is_left_to_the_evaluation():
    graph = Graph()
    assert graph.value(graph.call("log", graph.constant(-1.0))) is None
    assert graph.value(graph.div(graph.one, graph.zero)) is None


def test_numbers_of_nodes_are_an_order_of_evaluation():
    program = program_of(lambda x: (x[0] + x[1]) * math.exp(x[0]) / (x[1] - 2.0), 2)
    for number, key in enumerate(program.graph.nodes):
        if key[0] not in ("const", "input"):
            assert all(argument < number for argument in key[1:])


_OPERATIONS = [operator.add, operator.sub, operator.mul, operator.truediv]
_NUMBERS = st.floats(0.01, 100.0) | st.floats(-100.0, -0.01) | st.sampled_from([1.0, -1.0, 2.0])


@st.composite
def formulas(draw):
    """A list of steps: each combines two of the values so far, or negates one, or brings a constant in."""
    steps = []
    for size in range(3, 3 + draw(st.integers(1, 12))):
        operation = draw(st.sampled_from([*_OPERATIONS, operator.neg, None]))
        if operation is None:
            steps.append((operation, draw(_NUMBERS), 0))
        else:
            steps.append((operation, draw(st.integers(0, size - 1)), draw(st.integers(0, size - 1))))
    return steps


def evaluated(steps, x):
    values = list(x)
    for operation, i, j in steps:
        if operation is None:
            values.append(i)
        elif operation is operator.neg:
            values.append(-values[i])
        else:
            values.append(operation(values[i], values[j]))
    return values[-1]


@settings(max_examples=200, derandomize=True, deadline=None)
@given(formulas(), st.tuples(_NUMBERS, _NUMBERS, _NUMBERS))
def test_rewriting_changes_no_bit(steps, x):
    """a - (-b) becomes a + b and the like: identities of IEEE arithmetic, to the last bit."""
    try:
        expected = evaluated(steps, x)
    except ZeroDivisionError:
        return
    if math.isfinite(expected):
        kernel = kernel_of(lambda u: evaluated(steps, u), 3)
        assert kernel(list(x))[0] == expected
