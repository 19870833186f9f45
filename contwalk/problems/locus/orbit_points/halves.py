"""Points of curves along which symmetric orbits lose a symmetry: as those of doublings, of half the orbit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from contwalk.branch import SpecialPoint
from contwalk.problems.locus.orbit_points.resonances import R2OnDoublings, SecondMultiplier
from contwalk.problems.locus.orbit_points.two_at_once import TwoAtOnce
from contwalk.problems.locus.valued_curves import SymmetryBreakings
from contwalk.problems.problem import Sample, Seed


class TwoOfHalves(TwoAtOnce):
    """A multiplier of half the orbit passes the unit circle beside the one that is minus one."""

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A multiplier as the other curve holds it."""
        return isinstance(problem.curve, SymmetryBreakings) and super().tells(problem, sample, which)


class R2OfHalves(R2OnDoublings):
    """A second multiplier of half the orbit is minus one; what leaves is not doubled, so has no tori."""

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """A real negative multiplier."""
        return isinstance(problem.curve, SymmetryBreakings) and super().tells(problem, sample, which)

    def seeds(self, problem: Any, point: SpecialPoint) -> Sequence[Seed]:
        """The curve of tori, and of the neutral saddles that they become."""
        return SecondMultiplier.seeds(self, problem, point)
