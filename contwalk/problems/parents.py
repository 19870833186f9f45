"""Has a step gone over to the branch that its own one left?

Where a branch leaves another one at a period doubling or at a loss of symmetry, and comes back to it, both
may be stable, on the same side of everything, and nearly parallel in the metric: no test tells them apart.
But the parent has a symmetry, in space or time, that solutions of the branch have not. On its way through the
parent a branch is as asymmetric as before, the other way round; on the parent it is symmetric to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from contwalk.errors import NotFinite

# What is less asymmetric than the first, in units of the solution's own range, may be so by errors. That less
# than the second part of an asymmetry is left after a step is no chance.
APPARENT, GAINED = 3e-5, 1e-2
# The same beside a branch point, along a way that is known to break the symmetry: of what it breaks, what is
# found may keep the second part. A way breaks one for certain where it does so by several times what the
# branch point misses to have it, and what is found has none by many times that.
BROKEN, KEPT, BEYOND, FAR = 1e-9, 0.5, 3.0, 30.0
# No asymmetry is larger, in the same units.
LARGEST = 30.0
# What is this asymmetric is so for certain; where both ends of a step are not, to the second, it lies along a
# parent, and does not pass it.
LOST, ALONG = 1e-3, 1e-6


@dataclass
class SymmetriesLost:
    """Symmetries that solutions of a walk have been found without, by name.

    A walk that has them again at both ends of a step has slid onto its parent in steps none of which gained
    much.
    """

    names: set[str] = field(default_factory=set)

    def regained(
        self, before: Callable[[], Mapping[str, float]], after: Callable[[], Mapping[str, float]]
    ) -> bool:
        """Whether both ends of a step have a symmetry that was lost on the way to it.

        Each gives how far it is from having a symmetry, as for `gained_symmetry`.
        """
        try:
            there = after()
            again = {name for name in self.names if there.get(name, 1.0) < ALONG}
            self.names |= {name for name, apart in there.items() if apart > LOST}
            return bool(again) and any(apart < ALONG for name, apart in before().items() if name in again)
        except NotFinite:
            return False


def gained_symmetry(
    before: Callable[[], Mapping[str, float]], after: Callable[[], Mapping[str, float]]
) -> bool:
    """Whether the second of two neighbouring solutions has a symmetry that the first is far from.

    Each gives how far it is from having a symmetry, in units of its range, by the symmetry's name.
    """
    try:
        near = {name: apart for name, apart in after().items() if apart < GAINED * LARGEST}
        if not near:  # as nearly always: the first need not be looked at
            return False
        first = before()
    except NotFinite:
        return False
    return any(apart > APPARENT and near.get(name, apart) < GAINED * apart for name, apart in first.items())


def kept_symmetry(
    point: Callable[[], Mapping[str, float]],
    guess: Callable[[], Mapping[str, float]],
    after: Callable[[], Mapping[str, float]],
) -> bool:
    """Whether a solution beside a branch point is the parent's, or is not told from that: it has a symmetry
    that the way there breaks, or the way is as short as what the point itself is known to.

    Each gives how far it is from having a symmetry, as for `gained_symmetry`.
    """
    try:
        expected, found = guess(), after()
        broken = {name: apart for name, apart in expected.items() if apart > BROKEN}
        if any(found.get(name, apart) < KEPT * apart for name, apart in broken.items()):
            return True
        # What the point itself is far from is no symmetry that is lost at it.
        known = {name: apart for name, apart in point().items() if apart < LOST} if broken else {}
        if any(found.get(name, 0.0) >= FAR * max(apart, BROKEN) for name, apart in known.items()):
            return False
        return any(apart < BEYOND * known.get(name, 0.0) for name, apart in broken.items())
    except NotFinite:
        return False
