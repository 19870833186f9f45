"""Extremes over several stretches of a motion: all turns at once, and only those looked at that may count."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from contwalk.problems.orbit.extrema import Smooth, cubics_at, extremes_of, turns


def stretch(asked, name, first, second):
    """States given as polynomials of the time; who asks for them between the samples is written down."""
    states = [np.polynomial.Polynomial(p) for p in (first, second)]
    rates = [p.deriv() for p in states]

    def at(times):
        asked.append(name)
        return np.column_stack([p(times) for p in states])

    def rate_at(times, _):
        return np.column_stack([p(times) for p in rates])

    times = np.array([0.0, 0.3, 0.6, 1.0])
    return Smooth(times, np.column_stack([p(times) for p in states]), rate_at(times, None), at, rate_at)


def test_only_turns_that_may_be_the_highest_are_looked_at():
    """4 t (1 - t) is one at 1/2, between samples; half of that is below what the other has at its samples."""
    asked = []
    both = [
        stretch(asked, "high", [0.0, 4.0, -4.0], [0.0, 1.0]),
        stretch(asked, "half", [0.0, 2.0, -2.0], [0.0, 1.0]),
    ]
    low, high = extremes_of(both, [np.arange(2), np.arange(2)])
    assert high == pytest.approx([1.0, 1.0], abs=1e-15)  # the parabola through value and rate is the state
    assert low == pytest.approx([0.0, 0.0], abs=1e-15)
    assert asked == ["high"]


def test_a_state_that_a_stretch_does_not_have_is_not_its_own():
    """What stands there instead of it turns higher than the state ever is."""
    asked = []
    both = [
        stretch(asked, "without", [1.0], [0.0, 40.0, -40.0]),
        stretch(asked, "with", [2.0], [0.0, 4.0, -4.0]),
    ]
    low, high = extremes_of(both, [np.array([0]), np.array([0, 1])])
    assert high == pytest.approx([2.0, 1.0], abs=1e-15)
    assert low == pytest.approx([1.0, 0.0], abs=1e-15)
    assert asked == ["with"]


def test_what_no_stretch_has_is_told_so():
    low, high = extremes_of([stretch([], "only", [1.0], [1.0])], [np.array([0])])
    assert (low[1], high[1]) == (np.inf, -np.inf)


@pytest.mark.parametrize("turn", [0.2, 0.45, 0.9])
@pytest.mark.parametrize("other", [-0.5, 1.4, 3.0])
@pytest.mark.parametrize("sign", [1.0, -1.0, 1e-200, -1e200])
def test_a_cubic_turns_where_its_derivative_is_zero(turn, other, sign):
    """Between 2 and 5, of one whose derivative is sign (s - turn) (s - other) in the share s of the way."""
    slope = sign * Polynomial([turn * other, -turn - other, 1.0])
    value, h = slope.integ(), 3.0
    given = [np.array([v]) for v in (2.0, 5.0, h * value(0.0), h * value(1.0), slope(0.0), slope(1.0))]
    assert turns(*given)[0] == pytest.approx(2.0 + h * turn, abs=1e-13)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_cubic_that_turns_at_an_end_but_for_rounding_turns_there(sign):
    """It falls by 0.15 sign, from rates of 3e-20 to 3e-17: at its other end it would turn beside its way."""
    rates = np.array([-3e-20 * sign]), np.array([3e-17 * sign])
    here = np.array([0.0]), np.array([1.0]), np.array([0.0])
    assert turns(*here, np.array([-0.15 * sign]), *rates) == pytest.approx([1.0], abs=1e-15)
    assert turns(*here, np.array([0.15 * sign]), *rates) == pytest.approx([0.0], abs=1e-15)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.6, 1.0])
def test_a_cubic_is_told_by_its_values_and_rates_at_both_ends(share):
    """1 - 2 t + 3 t^2 - t^3 from 2 on, over a step of three."""
    cubic = Polynomial([1.0, -2.0, 3.0, -1.0])
    slope, a, b = cubic.deriv(), 2.0, 5.0
    t, *ends = (np.array([v]) for v in (a + share * (b - a), a, b, cubic(a), cubic(b), slope(a), slope(b)))
    # The values are of the order of 60.
    assert cubics_at(t, ends)[0] == pytest.approx(cubic(t[0]), abs=1e-13)


def test_turns_are_looked_for_between_the_samples_where_a_rate_changes_its_sign():
    times = np.linspace(0.0, 5.0, 6)
    rates = np.array([[1.0, -1.0], [2.0, -2.0], [-1.0, -1.0], [-3.0, 1.0], [4.0, 2.0], [5.0, 3.0]])
    smooth = Smooth(times, np.zeros((6, 2)), rates, lambda t: t, lambda t, x: x)
    which, low, high, *_ = smooth.brackets(np.array([0, 1]))
    found = sorted(zip(which.tolist(), low.tolist(), high.tolist(), strict=True))
    assert found == [(0, 1.0, 2.0), (0, 3.0, 4.0), (1, 2.0, 3.0)]
    assert smooth.brackets(np.array([1]))[0].tolist() == [1]
