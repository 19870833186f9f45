"""Eigenvalues and multipliers that become critical where nothing bifurcates: they change a count."""

from __future__ import annotations

from typing import Any

from contwalk.problems.problem import Located, PointType, Sample, Test


class CountChange(PointType):
    """An eigenvalue beside those of the curve becomes critical, and nothing bifurcates together.

    So it is along neutral saddles, and where the order of events or a condition is what the curve holds.
    """

    label, test, changes, told = "UZ", Test.STABILITY, (-2, -1, 1, 2), False

    def __init__(self, saddles: bool = False) -> None:
        self._saddles = saddles

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """Everywhere, or along neutral saddles."""
        return not (self._saddles and problem.genuine(sample.z))

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """Where it is seen: nothing happens there."""
        return Located(sample.z, sample.error)

    def has(self, point: Any) -> bool:
        """None is stored."""
        return False
