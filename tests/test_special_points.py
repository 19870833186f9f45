"""What a relative accuracy asks of a point."""

import pytest

from contwalk.special_point import allowed_error


@pytest.mark.parametrize(
    ("value", "error", "allowed"),
    [
        (2.0, 1e-12, 2e-8),
        (-1e-6, 1e-12, 1e-14),
        (0.0, 1e-12, 1e-8),  # of a magnitude of one: nothing is small against zero
        (3e-19, 1e-18, 1e-8),
    ],
)
def test_a_value_that_is_zero_to_its_error_is_compared_with_the_magnitude(value, error, allowed):
    assert allowed_error(1e-8, value, error, 1.0) == pytest.approx(allowed)
