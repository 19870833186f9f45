"""Curves of bifurcations of doubled orbits that are born on curves of doublings: folds at GPD, tori at R2.

At a generalized doubling mu = c r^2 + e r^4 holds of the doubled orbit of the amplitude r, with c = 0 at the
point itself: beside it, on the side of the curve of doublings where c has the other sign than e, the doubled
orbits fold at r^2 = -c / (2 e) (Kuznetsov 2004, section 9.3). Both coefficients are read from the first
parameter of two doubled orbits.

Beside a resonance 1:2, where the second multiplier of the doubling orbit is -(1 + d), a doubled orbit of the
amplitude r has two multipliers near one, whose product grows as exp(2 d + p r^2). Where it is one and they
are no real pair, the doubled orbit has a torus (section 9.5.3: one sign of the cubic coefficient has it, the
other has none). Both numbers are read from two doubled orbits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.locus.doubled_orbits import (
    DoubledOrbits,
    amplitude_near,
    amplitude_of_neutral,
    found_beside,
)
from contwalk.problems.problem import Seed


def folds_of_doubled_orbits(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of folds that is born at a generalized period doubling.

    Raises
    ------
    StartError
        If none is found: there is one wherever e is not zero.
    """
    found = found_beside(problem, point, _fold)
    if not found:
        raise StartError(
            "No fold of the doubled orbits beside this point was found.",
            "Continue the orbits of a doubling beside it: the curve can be begun at a fold of theirs.",
        )
    return found


def _fold(doubled: DoubledOrbits, r: float, origin: np.ndarray) -> Seed | None:
    """The fold of doubled orbits beside a doubling; r is the amplitude of the first of two.

    `origin` are the second and the first parameter at the point, shape (2,).
    """

    def squared(r: float) -> float:
        near, far = (float(doubled.of(s)[-1] - doubled.rest[-1]) for s in (r, 2.0 * r))
        c, e = (16.0 * near - far) / (12.0 * r**2), (far - 4.0 * near) / (12.0 * r**4)
        return -c / (2.0 * e) if e else 0.0

    expected = amplitude_near(squared, r)
    return None if expected is None else doubled.curve("LP", doubled.of(expected), expected, origin)


def tori_of_doubled_orbits(problem: Any, point: SpecialPoint) -> Sequence[Seed]:
    """The curve of tori that is born at a resonance 1:2 of doublings; none where none is found."""
    return found_beside(problem, point, _torus)


def _torus(doubled: DoubledOrbits, r: float, origin: np.ndarray) -> Seed | None:
    """The torus of doubled orbits beside a doubling; r is the amplitude of the first of two.

    `origin` are the second and the first parameter at the point, shape (2,).
    """
    expected = amplitude_of_neutral(lambda s: float(np.log(abs(np.prod(_pair(doubled, s))))), r)
    if expected is None:
        return None
    first, orbit = complex(_pair(doubled, expected)[0]), doubled.of(expected)
    further = [first.real / abs(first)]
    return None if first.imag == 0.0 else doubled.curve("NS", orbit, expected, origin, further)


def _pair(doubled: DoubledOrbits, amplitude: float) -> np.ndarray:
    """The two multipliers nearest to one of the doubled orbit of an amplitude, shape (2,)."""
    orbit, z = doubled.problem, doubled.of(amplitude)
    found = orbit.multipliers(z, orbit.jacobian(z)).values
    return np.asarray(found[np.argsort(np.abs(found - 1.0))[:2]])
