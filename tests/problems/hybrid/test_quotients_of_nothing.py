"""A flow through two gaps that close at once: the quotient of their widths is 0/0 there, and said to be.

As of the pressure in a two-mass model of the vocal folds, P (1 - (a_2 / a_1)^2): the gap x_2 closes first for
small rates s, at last with x_1.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hybrid_runs import branch_of, machine

from contwalk.fields.blame import first_vanishing
from contwalk.system import Transition


def gaps():
    def narrows(t, x, p, dx):
        dx[0] = -p.s - 0.1 * (x[1] / x[0]) ** 2  # both gaps
        dx[1] = -1.0

    def half(t, x, p, dx):
        dx[0] = -p.s
        dx[1] = -1.0

    def opens(t, x, p, y):
        y[0] = 1.0
        y[1] = 0.8

    second = Transition("second", "open", "half", lambda t, x, p: x[1], "falling")
    first = Transition("first", "half", "open", lambda t, x, p: x[0], "falling", opens)
    return machine(["x1", "x2"], {"s": 1.15}, {"open": narrows, "half": half}, [second, first])


def test_a_branch_that_ends_where_a_quotient_is_nothing_by_nothing_tells_its_line():
    branch = branch_of(gaps(), "s", (1.1, 2.0), [1.0, 0.8], direction="up", max_step=1.0)
    outcome = branch.outcome
    assert outcome.reason == "not_finite"
    line = narrows_line()
    assert f"test_quotients_of_nothing.py, line {line}: a quotient comes to 0/0 there" in outcome.message
    assert "field of mode 'open'" in outcome.message


def narrows_line() -> int:
    with open(__file__) as text:
        return next(k for k, line in enumerate(text, 1) if line.rstrip().endswith("# both gaps"))


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda x: x[1] / x[0], "a quotient comes to 0/0 there (1.0e-09/1.0e-06)"),
        (lambda x: (1.0 + x[1]) / x[0], "the denominator of a quotient comes to zero there"),
        (lambda x: x[1] * math.log(x[0]), "what a logarithm is of comes to zero there"),
        (lambda x: math.sqrt(x[0]), "what a square root is of comes to zero there"),
        (lambda x: x[0] ** 0.3, "what a power is of comes to zero there"),
        (lambda x: x[0] / (1.0 + x[1]), ""),
        (lambda x: x[0] ** 2.5 * x[1], ""),
    ],
)
def test_what_vanishes_where_a_motion_breaks_off(function, words):
    def field(t, x, p, dx):
        dx[0] = function(x)

    places = [(0.0, [x, x**1.5]) for x in np.geomspace(1.0, 1e-6, 20)]
    found = first_vanishing(field, places, {})
    assert words in found if words else found is None
