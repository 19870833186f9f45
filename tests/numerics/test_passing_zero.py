"""Zeros and poles of functions that have no value right beside them."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from contwalk.numerics.passing_zero import is_pole

HOLE = 0.02


def holed(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda x: function(x) if abs(x - 0.4) > HOLE else math.nan


@pytest.mark.parametrize(
    ("function", "pole"),
    [(lambda x: 1.0 / (x - 0.4), True), (lambda x: x - 0.4, False), (lambda x: (x - 0.4) ** 3, False)],
)
def test_a_hole_in_the_middle_hides_neither(function: Callable[[float], float], pole: bool):
    for value in (function, holed(function)):
        assert is_pole(value, (0.0, 1.0), (value(0.0), value(1.0))) is pole
