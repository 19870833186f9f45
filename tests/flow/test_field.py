"""Fields: constants, sparsity, time, and refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flow_fields import compiled, program_of

from contwalk.flow import Field


def swinging(t, x, p):
    """A driven pendulum with an idle third state."""
    stiffness = math.exp(p[0]) / p[1]
    return [x[1], -stiffness * math.sin(x[0]) + p[2] * math.cos(p[3] * t), 0.0]


PARAMETERS = [0.3, 2.0, 0.7, 1.5]


def test_value_and_jacobian_with_time_and_columns():
    field = compiled(swinging, 3, 4, columns=(2, 0))
    c = field.constants(PARAMETERS)
    t, x = 0.4, [0.5, -0.2, 9.0]
    stiffness, drive = math.exp(0.3) / 2.0, math.cos(1.5 * 0.4)
    assert field(t, x, c).tolist() == [-0.2, -stiffness * math.sin(0.5) + 0.7 * drive, 0.0]
    expected = np.zeros((3, 5))
    expected[0, 1] = 1.0
    expected[1, 0], expected[1, 3], expected[1, 4] = (
        -stiffness * math.cos(0.5),
        drive,
        -stiffness * math.sin(0.5),
    )
    # one or two roundings in a different order
    np.testing.assert_allclose(field.jacobian(t, x, c), expected, rtol=4e-16, atol=0.0)


def test_only_entries_that_can_be_nonzero_are_kept():
    field = compiled(swinging, 3, 4, columns=(2, 0))
    assert field.row_ptr.tolist() == [0, 1, 4, 4]
    assert field.col.tolist() == [1, 0, 3, 4]


def test_what_parameters_alone_decide_is_computed_once():
    field = compiled(swinging, 3, 4)
    constants = field.constants(PARAMETERS)
    assert sorted(constants) == sorted([math.exp(0.3) / 2.0, 0.7, 1.5])


def test_undefined_constants_make_the_field_nan_only_where_they_are_used():
    def field_with_choice(t, x, p):
        return [np.where(x[0] > 0.0, x[0] / p[0], x[0])]

    field = compiled(field_with_choice, 1, 1)
    c = field.constants([0.0])
    assert field(0.0, [-2.0], c) == [-2.0]
    assert np.isnan(field(0.0, [2.0], c)).all()


def test_a_choice_by_parameters():
    def field_with_fork(t, x, p):
        return [x[0] * p[0]] if p[0] > p[1] else [x[0] - p[1]]

    field = compiled(field_with_fork, 1, 2, columns=(0, 1))
    assert field(0.0, [3.0], field.constants([2.0, 1.0])) == [6.0]
    assert field(0.0, [3.0], field.constants([1.0, 2.0])) == [1.0]
    assert field.jacobian(0.0, [3.0], field.constants([2.0, 1.0])).tolist() == [[2.0, 3.0, 0.0]]
    assert field.jacobian(0.0, [3.0], field.constants([1.0, 2.0])).tolist() == [[1.0, 0.0, -1.0]]


def test_where_one_rate_does_not_exist_none_does():
    field = compiled(lambda t, x, p: [x[1], 1.0 / x[0]], 2)
    c = field.constants([])
    assert np.isnan(field(0.0, [0.0, 1.0], c)).all()
    assert np.isnan(field.jacobian(0.0, [0.0, 1.0], c)).all()


def test_arguments_that_do_not_fit_are_refused():
    field = compiled(swinging, 3, 4)
    with pytest.raises(ValueError, match="4 parameters"):
        field.constants([1.0])
    with pytest.raises(ValueError, match="3 states"):
        field(0.0, [1.0], field.constants(PARAMETERS))


def test_inputs_that_nobody_declared_are_refused():
    program = program_of(swinging, 3, 4)
    states = [("x", i) for i in range(3)]
    with pytest.raises(ValueError, match=r"\('t', 0\)"):
        Field(program, states, {"p": 4})
    with pytest.raises(ValueError, match=r"\('p', 3\)"):
        Field(program, states, {"p": 3}, time=("t", 0))
    with pytest.raises(ValueError, match="3 outputs where 2 are wanted"):
        Field(program, states[:2], {"p": 4}, time=("t", 0))
    with pytest.raises(ValueError, match="no parameter"):
        Field(program, states, {"p": 4}, [("x", 0)], ("t", 0))
