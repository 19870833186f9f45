"""The branch point at which a branch is its parent's again, located from a step that went over to the parent.

Beside such a point solutions are known to their errors over their distance from it, and shorter steps are no
better than the one that failed. But the point itself is known well: on the way through it a branch is its own
mirror image, and nothing lies beyond.
"""

from __future__ import annotations

import numpy as np

from contwalk.continuation import outcomes
from contwalk.continuation.kinds import kind_of_test
from contwalk.continuation.locating import Found, TooLong, sample_at
from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Problem, Sample, Test

# What is less asymmetric, in units of a solution's range, may be near its parent.
NEAR = 0.1
# The point lies no farther ahead than so many times the step that went over to the parent.
AHEAD = 2.0
# Its eigenvalues are critical that are this near to it, in stability measure, or so many times what they are
# known to.
CRITICAL, KNOWN = 1e-3, 10.0


class WentOver(TooLong):
    """A step that ends on the parent of its branch."""

    def __init__(self) -> None:
        super().__init__(
            "The step ends on a solution that repeats itself, or is its own image, as those before do not."
        )


def back_at_parent(
    problem: Problem, a: Sample, length: float, settings: Settings, observer: Observer
) -> tuple[Segment, Found] | None:
    """The piece of branch from `a` to where it is its parent's, at most AHEAD steps of a length away.

    None where there is no such point, or where something else may lie before it: a fold, an eigenvalue that
    crosses, a limit, a mark.
    """
    if a.orientation == 0.0:  # a walk that begins at a branch point
        return None
    kind = kind_of_test(problem, Test.ORIENTATION)
    try:
        if not any(apart < NEAR for apart in problem.equivalence.asymmetries(a.z).values()):
            return None
        located = kind.locate(problem, a, 0)
        if located is None or not _ahead(a, located.z, length):
            return None
        settled = located.settled()
        if (
            settled is None
            or not settled.vectors.get("returned_to_parent")
            or not _ahead(a, settled.z, length)
        ):
            return None
        chord = Segment(problem, a, a.varied(z=settled.z))
        there = sample_at(chord, kind, settled, a).varied(unstable=a.unstable)
        segment = Segment(problem, a, there)
        if not _nothing_between(a, there) or marked(segment, settings.sought, observer, [1.0]):
            return None
    except (*outcomes.BREAKDOWNS, LostBranch, TooLong):
        return None
    return segment, Found(1.0, kind, settled, there, a.unstable, a.unstable, counted=True)


def _ahead(a: Sample, z: np.ndarray, length: float) -> bool:
    """Whether z, shape (N + 1,), lies ahead of a solution, and near."""
    way = z - a.z
    return bool(a.tangent @ (way / a.weights**2) > 0.0) and norm_in(way, a.weights) < AHEAD * length


def _nothing_between(a: Sample, there: Sample) -> bool:
    """Whether as many eigenvalues are unstable at a point as before it, but for the critical one, the
    parameter moves one way, and what is allowed on one side is so on the other.
    """
    if not np.array_equal(a.margins > 0.0, there.margins > 0.0):
        return False
    critical = np.abs(there.measures) <= np.maximum(CRITICAL, KNOWN * there.errors)
    least = int(np.count_nonzero((there.measures > 0.0) & ~critical))
    moves = (there.z[-1] - a.z[-1]) * a.tangent[-1] >= 0.0
    return bool(np.any(critical)) and a.unstable in (least, least + 1) and moves
