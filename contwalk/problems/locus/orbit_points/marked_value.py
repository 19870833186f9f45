"""Points of curves of orbits that no equation of their own locates: marks, ends, changes of a count."""

from __future__ import annotations

from typing import Any

from contwalk.problems.locus.orbit_points.point import OrbitLocusPoint
from contwalk.problems.problem import Located, Sample, Test


class MarkedValue(OrbitLocusPoint):
    """A parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(OrbitLocusPoint):
    """The curve ends."""

    label, test = "EP", Test.END


class CountChange(OrbitLocusPoint):
    """A multiplier beside those of the curve passes the unit circle where nothing bifurcates together.

    So it is along neutral saddles, and where the order of events or a condition is what the curve holds.
    """

    label, test, changes, told = "UZ", Test.STABILITY, (-2, -1, 1, 2), False

    def __init__(self, saddles: bool = False) -> None:
        self._saddles = saddles

    def tells(self, problem: Any, sample: Sample, which: int) -> bool:
        """Everywhere, or along neutral saddles."""
        return not (self._saddles and problem.curve.genuine(problem.further(sample.z)))

    def locate(self, problem: Any, sample: Sample, which: int) -> Located | None:
        """Where it is seen: nothing happens there."""
        return Located(sample.z, sample.error)
