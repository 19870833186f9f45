"""What may lie hidden between two samples of a test function: its least value, told by values and rates."""

from __future__ import annotations

import pytest

from contwalk.continuation.double_crossings import _corner, _cubic_extremum


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_least_value_between_two_samples_of_a_parabola(sign):
    """(t - 1/4)^2 - 1/100 and its negative: a cubic has them exactly, and a sample where they are least."""
    ends = 0.0525, 0.5525, -0.5, 1.5
    found = _cubic_extremum(*(sign * number for number in ends), sign)
    assert found == pytest.approx(-0.01, abs=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_value_at_a_corner(sign):
    """|t - 1/4| - 1/10: the tangents at both ends meet there."""
    ends = 0.15, 0.65, -1.0, 1.0
    assert _corner(*(sign * number for number in ends), sign) == pytest.approx(-0.1, abs=1e-15)
