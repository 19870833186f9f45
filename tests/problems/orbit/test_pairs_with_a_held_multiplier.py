"""A second multiplier that meets the one that a curve holds: rounding makes a complex pair of both."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from contwalk.problems.locus.orbit_points.resonances import R1OnFolds, R2OnDoublings
from contwalk.problems.locus.orbit_points.two_at_once import TwoAtOnce

CURVE = SimpleNamespace(genuine=lambda z: True)


@pytest.mark.parametrize(("kind", "tori", "held"), [(R2OnDoublings, "PDNS", -1.0), (R1OnFolds, "LPNS", 1.0)])
def test_one_of_a_pair_is_told_as_the_resonance_that_it_is_and_not_as_a_torus(kind, tori, held) -> None:
    """On a laser's doublings -1 was split by 7e-4 i, and PDNS told, which was not found."""
    value = held * (1.0 - 2.5e-7) - 7.1e-4j
    lone = SimpleNamespace(eigenvalues=[value, 0.1], z=None)
    pair = SimpleNamespace(eigenvalues=[value, value.conjugate(), 0.1], z=None)
    told = [each.tells(CURVE, lone, 0) for each in (kind(), TwoAtOnce(tori, "NS"))]
    assert told == [True, False]
    assert [each.tells(CURVE, pair, 0) for each in (kind(), TwoAtOnce(tori, "NS"))] == [False, True]
