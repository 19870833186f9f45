"""Margins of limits between two solutions: what passes zero and cannot be located, and what jumps over it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import MadeUp

from contwalk.continuation.limits import _located
from contwalk.continuation.locating import Disagreement
from contwalk.problems.hybrid.limits import Limit


@dataclass
class Margined(MadeUp):
    """x = 0 for every lam, with a margin that is told, and no equations that locate where it is zero."""

    margin: object = None
    limited = SimpleNamespace(limits=(Limit("GR", "interior", "wall", 0, "dip"),))

    def examine(self, z, *rest):
        return replace(super().examine(z, *rest), margins=np.array([self.margin(float(z[-1]))]))


def problem_of(margin):
    return Margined(lambda z: [-z[0]], lambda z: [[-1.0, 0.0]], margin=margin)


def looked_for(margin, a=0.0, b=1.0):
    segment = problem_of(margin).segment((0.0, a), (0.0, b))
    return _located(segment, 0, float(segment.a.margins[0]), float(segment.b.margins[0]), [])


@pytest.mark.parametrize("place", [0.2, 0.5003, 0.9])
@pytest.mark.parametrize("jump", [0.005, 0.5])
@pytest.mark.parametrize("size", [0.4, 5.0])
def test_a_margin_that_jumps_over_zero_passes_no_limit(place, size, jump):
    assert looked_for(lambda lam: size * (place - lam + (jump if lam < place else -jump))) is None


def test_a_margin_that_passes_zero_and_cannot_be_located_is_no_silent_loss():
    with pytest.raises(Disagreement, match="'wall' passes its limit, but cannot be located"):
        looked_for(lambda lam: 0.3 - lam)
