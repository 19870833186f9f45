"""A residual that is plainly no rounding is told so without typical magnitudes, and no other one is."""

from __future__ import annotations

import numpy as np
import pytest

from contwalk.numerics.linear import EPSILON
from contwalk.problems.linearization import Linearization

RNG = np.random.default_rng(5)


def linear(
    residual: np.ndarray, magnitudes: np.ndarray, asked: list[int]
) -> tuple[Linearization, np.ndarray]:
    """Three equations of four unknowns at a place, with their rounding levels and what is known without."""
    jacobian = RNG.normal(size=(3, 4)) * 10.0 ** RNG.integers(-6, 6, size=(3, 1))
    own = EPSILON * (np.abs(jacobian) @ np.full(4, 0.5))

    def levels() -> tuple[np.ndarray, np.ndarray]:
        asked.append(1)
        return own + EPSILON * (np.abs(jacobian) @ magnitudes), magnitudes

    found = Linearization(residual * own, jacobian, levels)
    found.evaluation = lambda: own
    return found


@pytest.mark.parametrize("exponent", np.arange(-2.0, 9.0, 0.5))
def test_the_answer_is_that_of_the_excess(exponent):
    for _ in range(20):
        asked: list[int] = []
        magnitudes = 10.0 ** RNG.uniform(-4.0, 2.0, size=4)
        lin = linear(RNG.normal(size=3) * 10.0**exponent, magnitudes, asked)
        weights = magnitudes * 10.0 ** RNG.uniform(-2.9, 2.0, size=4)
        assert lin.exceeds(2.0, weights) == (lin.excess > 2.0)


def test_far_from_a_solution_no_magnitudes_are_asked_for():
    asked: list[int] = []
    assert linear(np.full(3, 1e9), np.ones(4), asked).exceeds(2.0, np.ones(4))
    assert not asked


def test_what_is_no_number_exceeds():
    assert linear(np.array([np.nan, 0.0, 0.0]), np.ones(4), []).exceeds(2.0, np.ones(4))
