"""Points at which another curve crosses (BP): the equations of the curve are singular there."""

from __future__ import annotations

from contwalk.problems.locus.points.point import LocusPoint
from contwalk.problems.problem import Test


class Crossing(LocusPoint):
    """Two curves of one kind cross; it is told between the solutions that show it, and not located."""

    label, test, changes, singular = "BP", Test.ORIENTATION, (-1, 0, 1), True
