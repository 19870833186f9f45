"""Cubics that values and rates at both ends tell."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from contwalk.numerics import cubic

PLACES = np.array([0.0, 0.125, 0.5, 0.8, 1.0])


def ends_of(polynomial: Polynomial) -> np.ndarray:
    """Both values, then both rates, at 0 and 1."""
    return np.concatenate([polynomial(np.array([0.0, 1.0])), polynomial.deriv()(np.array([0.0, 1.0]))])


@pytest.mark.parametrize("degree", range(4))
def test_every_cubic_is_what_its_ends_tell(degree):
    power = Polynomial.basis(degree)
    # Of a few terms of about one each.
    np.testing.assert_allclose(ends_of(power) @ cubic.weights(PLACES), power(PLACES), rtol=0, atol=1e-15)


@pytest.mark.parametrize("inside", [(0.25, 0.75), (0.5, 0.9), (0.3,), ()])
def test_it_turns_where_its_rate_is_zero(inside):
    """The other zeros of the rate are beyond the ends, one on each side."""
    beyond = (-0.5, 1.5)[: 2 - len(inside)]
    turning = Polynomial.fromroots([*inside, *beyond]).integ()
    (found,) = cubic.turns(ends_of(turning)[None])
    # The formula for both zeros has no cancelling sums; the rates at the ends round to some units of 1.
    assert sorted(found[found > 0.0]) == pytest.approx(inside, abs=1e-14)


def test_a_parabola_turns_once_and_a_straight_line_nowhere():
    parabola, line = Polynomial([1.0, -1.0, 2.0]), Polynomial([1.0, -1.0])
    found = cubic.turns(np.stack([ends_of(parabola), ends_of(line)]))
    assert found[0].max() == pytest.approx(0.25, abs=1e-14)
    assert found[0].min() == 0.0
    assert np.all(found[1] == 0.0)
