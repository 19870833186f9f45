"""Points of curves of orbits that no equation of their own locates: marks and ends."""

from __future__ import annotations

from contwalk.problems.locus.orbit_points.point import OrbitLocusPoint
from contwalk.problems.problem import Test


class MarkedValue(OrbitLocusPoint):
    """A parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(OrbitLocusPoint):
    """The curve ends."""

    label, test = "EP", Test.END
