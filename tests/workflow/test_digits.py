"""Numbers in messages that are to be seen to differ, and periods that were typed with too few digits."""

from __future__ import annotations

import math

import pytest

from contwalk.plugin_check.digits import meant_with_pi, told_apart


@pytest.mark.parametrize("by", [0.5, 1e-3, 1e-6, 1e-9, 1e-12, 2.3e-16])
@pytest.mark.parametrize("value", [1.0, -math.e, 1e-20, 123456.0])
def test_numbers_that_differ_look_different(value: float, by: float) -> None:
    one, other = told_apart(value, value * (1.0 + by))
    assert one != other
    assert len(one) <= 24


def test_numbers_that_are_easily_told_apart_have_six_digits() -> None:
    assert told_apart(1.0 / 3.0, 0.4) == ("0.333333", "0.4")
    assert told_apart(1.0 / 3.0, 1.0 / 3.0 + 1e-9)[0] == "0.333333333"


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (6.28, "2 * math.pi"),
        (3.14159, "math.pi"),
        (1.5708, "math.pi / 2"),
        (4.18879, "4 * math.pi / 3"),
        (360.0, ""),
        (1.0, ""),
        (math.pi, ""),
    ],
)
def test_what_was_meant_is_tried(typed: float, meant: str) -> None:
    def holds(period: float) -> bool:
        return math.isclose(math.cos(12.0 * period), 1.0, rel_tol=1e-12)

    assert meant_with_pi(typed, holds) == meant
    assert meant_with_pi(typed, lambda period: False) == ""
