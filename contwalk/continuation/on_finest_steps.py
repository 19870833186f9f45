"""A part of a segment on the finest steps, where errors of coarser ones may hide crossings or make them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from contwalk.continuation.kinds import crossed, kind_of_test
from contwalk.continuation.locating import Disagreement, Found
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.errors import NotFinite
from contwalk.problems.problem import Test, finest

# How far to both sides of a position it reaches, in parts of the segment.
NEIGHBOURHOOD = 0.02


@dataclass(frozen=True)
class Subsegment:
    """What lies between two positions of a segment, on steps of its own."""

    part: Segment
    sides: tuple[float, float]

    def placed(self, point: Found) -> Found:
        """A point of the part by its position on the whole segment."""
        low, high = self.sides
        return replace(point, theta=low + point.theta * (high - low))


def on_finest_steps(segment: Segment, theta: float, which: int) -> Subsegment | None:
    """What is around a position, on the finest steps; None where the problem has none, or the branch is lost.

    Parameters
    ----------
    which : int
        The stability measure that is in doubt there.

    Raises
    ------
    Disagreement
        If the equations have no value on them.
    """
    sample = segment.at(theta)
    try:
        problem = finest(segment.problem, sample.z, segment.weights)
    except NotFinite as error:
        kind = crossed(segment.problem, sample, which) or kind_of_test(segment.problem, Test.ORIENTATION)
        raise Disagreement(kind, f"Two crossings may hide there: {error.sentence}") from None
    if problem is None:
        return None
    sides = max(theta - NEIGHBOURHOOD, 0.0), min(theta + NEIGHBOURHOOD, 1.0)
    try:
        a, b = (segment.on(problem, side) for side in sides)
    except LostBranch:
        return None
    return Subsegment(Segment(problem, a, b), sides)
