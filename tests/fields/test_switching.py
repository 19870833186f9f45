"""Choices of traced functions, and what jumps where one changes, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contwalk.fields.rebind import rebound
from contwalk.fields.switching import Switching, choices_of
from contwalk.fields.trace import trace

X, T = ("x", 0), ("t", 0)


def switching_of(function):
    copy = rebound(function)
    program = trace(lambda tracer: [copy(tracer.symbol("x", 0), tracer.symbol("t", 0))])
    return Switching(program, [X], T)


def beside(function, place, before, after):
    """Value, slope and second derivative on the piece of `before` and on that of `after`, at a place."""
    given = [{X: np.array([x]), T: np.array([0.0])} for x in (place, before, after)]
    return switching_of(function).beside(*given, {X: 1.0})[..., 0]


@pytest.mark.parametrize(
    ("function", "place", "one", "other"),
    [
        (lambda x, t: abs(x), 0.5, (-0.5, -1.0, 0.0), (0.5, 1.0, 0.0)),
        (lambda x, t: x * abs(x), 0.5, (-0.25, -1.0, -2.0), (0.25, 1.0, 2.0)),
        (lambda x, t: np.sign(x) * x, 2.0, (-2.0, -1.0, 0.0), (2.0, 1.0, 0.0)),
        (lambda x, t: max(x, 0.0) ** 2, 3.0, (0.0, 0.0, 0.0), (9.0, 6.0, 2.0)),
        (lambda x, t: min(x, x**3 + 2 * x), 1.0, (3.0, 5.0, 6.0), (1.0, 1.0, 0.0)),
        (lambda x, t: math.floor(x) + x, 0.25, (-0.75, 1.0, 0.0), (0.25, 1.0, 0.0)),
        (lambda x, t: x % 1.0, 0.25, (1.25, 1.0, 0.0), (0.25, 1.0, 0.0)),
        (lambda x, t: np.where(x > 0.0, x**2, -x), 2.0, (-2.0, -1.0, 0.0), (4.0, 4.0, 2.0)),
        (lambda x, t: 3.0 * x if x > 0.0 else 1.0, 2.0, (1.0, 0.0, 0.0), (6.0, 3.0, 0.0)),
        (
            lambda x, t: np.interp(x, [-1.0, 0.0, 1.0], [1.0, 0.0, 2.0]),
            0.5,
            (-0.5, -1.0, 0.0),
            (1.0, 2.0, 0.0),
        ),
    ],
)
def test_both_pieces_are_told_at_one_place(function, place, one, other):
    found = beside(function, place, -0.1, 0.1)
    assert np.allclose(found, [one, other], rtol=1e-15)  # a handful of roundings of numbers below ten


def test_a_choice_that_is_not_active_jumps_in_nothing():
    def field(x, t):
        return abs(x) if x > 1.0 else x

    one, other = beside(field, 0.0, -0.1, 0.1)
    assert np.array_equal(one, other)


def test_sides_are_told_at_many_places_and_are_unknown_where_a_number_is():
    switching = switching_of(lambda x, t: abs(np.log(x)) + math.floor(x))
    sides = switching.sides({X: np.array([0.5, 1.5, -1.0, 2.5]), T: 0.0})
    names = [switching.graph.nodes[node][0] for node in switching.choices]
    assert np.array_equal(sides[:, names.index("abs")], [-1.0, 1.0, np.nan, 1.0], equal_nan=True)
    assert np.array_equal(sides[:, names.index("floor")], [0.0, 1.0, -1.0, 2.0])


def test_a_smooth_function_has_no_choices():
    copy = rebound(lambda x, t: x**2 * math.sin(t) + math.hypot(x, 1.0))
    program = trace(lambda tracer: [copy(tracer.symbol("x", 0), tracer.symbol("t", 0))])
    assert choices_of(program) == ()


def test_linear_systems_stand_among_what_is_chosen_by():
    def function(x, t):
        q = np.linalg.solve(np.array([[2.0 + x * x, 1.0], [1.0, 3.0]]), np.array([x, 1.0]))
        return abs(q[0])

    def own(x):
        return float(np.linalg.solve([[2.0 + x * x, 1.0], [1.0, 3.0]], [x, 1.0])[0])

    root = 1.0 / 3.0  # 3 x - 1 = 0 by Cramer's rule
    one, other = beside(function, 0.5, root - 0.1, root + 0.1)
    assert one[0] == pytest.approx(-own(0.5), rel=1e-14)  # the same elimination in another order
    assert other[0] == pytest.approx(own(0.5), rel=1e-14)


@pytest.mark.parametrize(
    ("function", "moves"),
    [
        (lambda x, t: np.sign(math.cos(2.0 * t)), False),
        (lambda x, t: np.sign(math.cos(2.0 * t) + x), True),
        (lambda x, t: np.sign(x), True),
    ],
)
def test_an_instant_moves_where_a_state_decides(function, moves):
    switching = switching_of(function)
    assert switching.moves({X: np.array([0.0]), T: np.array([math.pi / 4])}, [0], {X: 1.0}) is moves
