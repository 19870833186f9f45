"""The curve of tori of doubled orbits that is born at a resonance 1:2.

Beside the point, where the second multiplier of the doubling orbit is -(1 + d), a doubled orbit of the
amplitude r has two multipliers near one, whose product grows as exp(2 d + p r^2). Where it is one and they
are no real pair, the doubled orbit has a torus (Kuznetsov 2004, section 9.5.3: one sign of the cubic
coefficient has it, the other has none). Both numbers are read from two doubled orbits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.doubled_orbits import DoubledOrbits, amplitude_of_neutral, found_beside
from contwalk.problems.problem import Seed


def tori_of_doubled_orbits(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of tori that is born at a resonance 1:2 of doublings; none where none is found."""
    return found_beside(problem, point, _torus)


def _torus(doubled: DoubledOrbits, r: float) -> Seed | None:
    """The torus of doubled orbits beside a doubling; r is the amplitude of the first of two."""
    expected = amplitude_of_neutral(lambda s: float(np.log(abs(np.prod(_pair(doubled, s))))), r)
    if expected is None:
        return None
    first = complex(_pair(doubled, expected)[0])
    return None if first.imag == 0.0 else doubled.curve("NS", expected, [first.real / abs(first)])


def _pair(doubled: DoubledOrbits, amplitude: float) -> np.ndarray:
    """The two multipliers nearest to one of the doubled orbit of an amplitude, shape (2,)."""
    orbit, z = doubled.problem, doubled.of(amplitude)
    found = orbit.multipliers(z, orbit.jacobian(z)).values
    return np.asarray(found[np.argsort(np.abs(found - 1.0))[:2]])
