"""Points that the user asks for (UZ), and the ends of curves (EP)."""

from __future__ import annotations

from contwalk.problems.locus.points.point import LocusPoint
from contwalk.problems.problem import Test


class MarkedValue(LocusPoint):
    """A parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(LocusPoint):
    """The curve ends."""

    label, test = "EP", Test.END
