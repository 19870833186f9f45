"""The typical magnitude of the free parameter."""

from __future__ import annotations

import math

import pytest

from contwalk.continuation.metric import parameter_weight


@pytest.mark.parametrize(
    ("magnitude", "value", "expected"),
    [(5.0, -2.0, 5.0), (2.0, -5.0, 5.0), (math.nan, 0.25, 1.0), (math.inf, -3.0, 3.0)],
)
def test_without_a_range_it_is_the_larger_of_what_is_known(magnitude, value, expected):
    assert parameter_weight(magnitude, (-math.inf, math.inf), value) == expected


@pytest.mark.parametrize(
    ("limits", "value", "expected"),
    [
        ((-1.0, 3.0), 0.0, 0.04),  # zero is inside: a hundredth of the width at least
        ((-1.0, 3.0), -2.5, 2.5),
        ((1.0, 3.0), 2.5, 2.0),  # not more than the width
        ((1e-6, 1.0), 1e-4, 1e-4),  # decades on one side of zero: the same steps in each
    ],
)
def test_within_a_range_it_is_the_value_up_to_the_width(limits, value, expected):
    assert parameter_weight(math.nan, limits, value) == expected
