"""Brackets around a sign change are narrowed: every bracket holds the root, and few evaluations find it."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from contwalk.numerics.bracketing import narrow


class Asked:
    """A function that remembers where it was asked, and accepts a position near enough to its root."""

    def __init__(self, function, root, near=1e-12):
        self.function, self.root, self.near = function, root, near
        self.places: list[float] = []
        self.brackets: list[tuple[float, float]] = []

    def value(self, x):
        self.places.append(x)
        return self.function(x)

    def attempt(self, x, low, high):
        self.brackets.append((low, high))
        assert low <= x <= high
        return x if abs(x - self.root) <= self.near else None

    def narrowed(self, low, high, **rest):
        return narrow(self.value, low, high, self.function(low), self.function(high), self.attempt, **rest)


FUNCTIONS = {
    "line": (lambda x: 3.0 * x - 1.0, 1.0 / 3.0),
    "falling": (lambda x: math.cos(2.0 * x) - 0.2, 0.5 * math.acos(0.2)),
    "steep": (lambda x: math.tanh(50.0 * (x - 0.7)), 0.7),
    "flat": (lambda x: (x - 0.6) ** 9, 0.6),
    "kink": (lambda x: x - 0.4 if x < 0.4 else 20.0 * (x - 0.4), 0.4),
    "jump": (lambda x: -1e-3 if x < 0.55 else 5.0, 0.55),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_bracket_holds_the_root_and_it_is_found(name):
    function, root = FUNCTIONS[name]
    asked = Asked(function, root)
    assert asked.narrowed(0.0, 1.0) == pytest.approx(root, abs=1e-12)
    # The root itself is known to half an ulp.
    assert all(low - 1e-16 <= root <= high + 1e-16 for low, high in asked.brackets)
    widths = [high - low for low, high in asked.brackets]
    assert all(after <= before for before, after in pairwise(widths))


@pytest.mark.parametrize(("name", "most"), [("line", 2), ("falling", 7), ("steep", 14)])
def test_smooth_roots_cost_far_less_than_bisection(name, most):
    """Bisection takes 40 evaluations to 1e-12."""
    function, root = FUNCTIONS[name]
    asked = Asked(function, root)
    asked.narrowed(0.0, 1.0)
    assert len(asked.places) <= most


def test_a_position_is_asked_once_and_the_first_answer_is_taken():
    places = []

    def attempt(x, low, high):
        places.append(x)
        return f"at {len(places)}" if len(places) == 3 else None

    assert narrow(lambda x: x**3 - 0.2, 0.0, 1.0, -0.2, 0.8, attempt) == "at 3"
    assert len(set(places)) == 3


def test_it_gives_up_where_the_bracket_is_as_narrow_as_asked():
    asked = Asked(lambda x: -1.0 if x < 0.3 else 1.0, root=math.inf)
    assert asked.narrowed(0.0, 1.0, width=1e-6) is None
    low, high = asked.brackets[-1]
    assert high - low < 1e-6
    assert low <= 0.3 <= high
    assert len(asked.places) <= 25  # 20 halvings


def test_it_gives_up_after_as_many_evaluations_as_asked():
    asked = Asked(lambda x: -1.0 if x < 0.3 else 1.0, root=math.inf)
    assert asked.narrowed(0.0, 1.0, most=5) is None
    assert len(asked.places) == 5


def test_an_exact_zero_that_is_refused_ends_the_search():
    asked = Asked(lambda x: 2.0 * x - 1.0, root=math.inf)
    assert asked.narrowed(0.0, 1.0) is None
    assert asked.places == [0.5]


def test_the_order_of_the_ends_does_not_matter():
    asked = Asked(lambda x: x**3 - 0.2, 0.2 ** (1.0 / 3.0))
    assert asked.narrowed(1.0, 0.0) == pytest.approx(0.2 ** (1.0 / 3.0), abs=1e-12)


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_root_at_an_end_is_tried_there_first(end):
    asked = Asked(lambda x: x - end, end)
    assert asked.narrowed(0.0, 1.0) == end
    assert asked.places == []


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_beside_a_root_at_an_end_every_bracket_holds_it(end):
    """Where nothing is accepted right at the end, as where equations are singular there."""
    asked = Asked(lambda x: x - end, end, near=-1.0)
    assert asked.narrowed(0.0, 1.0) is None
    assert all(low <= end <= high for low, high in asked.brackets)
