"""Points that the user asks for (UZ), and the ends of branches (EP)."""

from __future__ import annotations

from contwalk.problems.orbit.points.point import OrbitPoint
from contwalk.problems.problem import Test


class MarkedValue(OrbitPoint):
    """The parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(OrbitPoint):
    """The branch ends."""

    label, test = "EP", Test.END
