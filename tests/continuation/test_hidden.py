"""What may lie hidden between two samples of a test function: its least value, told by values and rates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_up import line

from contwalk.continuation.double_crossings import Measure
from contwalk.continuation.indicator import extremum
from contwalk.continuation.segment import Segment
from contwalk.numerics.cubic import dip
from contwalk.problems.sample import Rates, Sample


def test_a_parabola_that_dips_is_least_where_it_turns():
    """(t - 1/4)^2 - 1/100 falls from 0.0525 and grows to 0.5525; a cubic has it exactly."""
    assert dip([0.0525, 0.5525], [-0.5, 1.5]) == pytest.approx(0.25, abs=1e-15)
    # Shifted up by 0.08 it stays more than half as far from zero as it is at its nearer end.
    assert dip([0.1325, 0.6325], [-0.5, 1.5]) is None


def test_where_there_may_be_a_corner_the_tangents_tell_how_near_it_is():
    """2 |t - 1/2| + 1/10, cut off by a cubic at 0.6: at the corner it is 0.1."""
    assert dip([1.1, 1.1], [-2.0, 2.0]) is None
    assert dip([1.1, 1.1], [-2.0, 2.0], corner=True) == pytest.approx(0.5, abs=1e-15)


def _told(lam: float, measure: float, rate: float, asked: list[str], name: str) -> Sample:
    def told(which: int) -> float:
        asked.append(name)
        return rate

    sample = line(lambda z: [-1.0]).sample((0.0, lam), (0.0, 1.0))
    measures = {"eigenvalues": np.array([measure + 0j]), "measures": np.array([measure])}
    return replace(sample, **measures, errors=np.zeros(1), rates=Rates(1, told))


def _extremum(measures, rates, asked):
    """What is told between two made-up ends of a segment that is one long."""
    problem = line(lambda z: [-1.0])
    ends = (_told(*each, asked, name) for *each, name in zip((0.0, 1.0), measures, rates, "ab", strict=True))
    segment = Segment(problem, *ends)
    return extremum(Measure(segment, 0), (0.0, segment.a), (1.0, segment.b))


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
    assert _extremum([sign * m for m in ends], [sign * r for r in rates], asked) is None
    assert asked == expected


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("ends", [(1.0, 0.9), (0.9, 1.0)])
def test_what_turns_near_zero_is_suspected_from_either_end(sign, ends):
    assert _extremum([sign * m for m in ends], [sign * r for r in (-4.0, 4.0)], []) is not None
