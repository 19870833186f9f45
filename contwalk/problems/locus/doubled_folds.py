"""The curve of folds of doubled orbits that is born at a generalized period doubling.

There mu = c r^2 + e r^4 holds of the doubled orbit of the amplitude r, with c = 0 at the point itself: beside
it, on the side of the curve of doublings where c has the other sign than e, the doubled orbits fold at
r^2 = -c / (2 e) (Kuznetsov 2004, section 9.3). Both coefficients are read from the first parameter of two
doubled orbits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.errors import StartError
from contwalk.problems.locus.doubled_orbits import DoubledOrbits, amplitude_near, found_beside
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


def _fold(doubled: DoubledOrbits, r: float) -> Seed | None:
    """The fold of doubled orbits beside a doubling; r is the amplitude of the first of two."""

    def squared(r: float) -> float:
        near, far = (float(doubled.of(s)[-1] - doubled.free) for s in (r, 2.0 * r))
        c, e = (16.0 * near - far) / (12.0 * r**2), (far - 4.0 * near) / (12.0 * r**4)
        return -c / (2.0 * e) if e else 0.0

    expected = amplitude_near(squared, r)
    return None if expected is None else doubled.curve("LP", expected)
