"""Eigenvalues that pass zero along neutral saddles: they change a count, and are no special points."""

from __future__ import annotations

from typing import Any

from contwalk.problems.locus.points.point import LocusPoint
from contwalk.problems.problem import Located, Sample, Test


class CountChange(LocusPoint):
    """An eigenvalue beside those of the curve changes its sign where these are real."""

    label, test, changes, told = "UZ", Test.STABILITY, (-2, -1, 1, 2), False

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """Along neutral saddles."""
        return not problem.kappa(sample.z) > 0.0

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """Where it is seen: nothing happens there."""
        return Located(sample.z, sample.error)

    def has(self, point: Any) -> bool:
        """None is stored."""
        return False
