"""What may lie hidden between two samples of a test function: its least value, told by values and rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_up import line

from contwalk.continuation.double_crossings import HERMITE, _corner, _suspects
from contwalk.problems.sample import Rates, Sample


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_least_value_between_two_samples_of_a_parabola(sign):
    """(t - 1/4)^2 - 1/100 and its negative: a cubic has them exactly, and a sample where they are least."""
    ends = 0.0525, 0.5525, -0.5, 1.5
    found = sign * (np.array([sign * number for number in ends]) @ HERMITE)
    assert found.min() == pytest.approx(-0.01, abs=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_value_at_a_corner(sign):
    """|t - 1/4| - 1/10: the tangents at both ends meet there."""
    ends = 0.15, 0.65, -1.0, 1.0
    assert _corner(*(sign * number for number in ends), sign) == pytest.approx(-0.1, abs=1e-15)


def _told(measure: float, rate: float, asked: list[str], name: str) -> Sample:
    def told(which: int) -> float:
        asked.append(name)
        return rate

    sample = line(lambda z: [-1.0]).sample((0.0, 0.0), (0.0, 1.0))
    measures = {"eigenvalues": np.array([measure + 0j]), "measures": np.array([measure])}
    return replace(sample, **measures, errors=np.zeros(1), rates=Rates(1, told))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("ends", "rates", "expected"),
    [
        ((2.0, 1.0), (-1.0, -0.9), ["b"]),  # goes towards zero, and goes on
        ((1.0, 2.0), (1.0, 1.1), ["a"]),  # comes from there
        ((2.0, 1.0), (-1.0, float("nan")), ["b"]),
    ],
)
def test_one_rate_is_enough_where_a_measure_goes_one_way(sign, ends, rates, expected):
    asked = list[str]()
    a, b = (_told(sign * m, sign * r, asked, n) for m, r, n in zip(ends, rates, "ab", strict=True))
    assert list(_suspects(a, b, 1.0)) == []
    assert asked == expected


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("ends", [(1.0, 0.9), (0.9, 1.0)])
def test_what_turns_near_zero_is_suspected_from_either_end(sign, ends):
    a, b = (_told(sign * m, sign * r, [], "") for m, r in zip(ends, (-4.0, 4.0), strict=True))
    assert list(_suspects(a, b, 1.0)) == [0]
