"""Points that the user asks for (UZ), and the ends of branches (EP)."""

from __future__ import annotations

from contwalk.problems.equilibrium.points.point import EquilibriumPoint
from contwalk.problems.problem import Test


class MarkedValue(EquilibriumPoint):
    """The parameter, or an observable, has a value or an extremum that was asked for."""

    label, test = "UZ", Test.MARK


class EndPoint(EquilibriumPoint):
    """The branch ends."""

    label, test = "EP", Test.END
