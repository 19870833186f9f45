"""What a function of values and rates at two solutions foretells between them, looked for by halves."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample

# An extremum is looked at when it comes this much nearer to zero than the ends.
NEAR_ZERO = 0.5
# How often a part is halved: a cubic of values and rates at its ends is 16 times as good each time.
HALVINGS = 6

# A solution and its position on a segment.
Placed = tuple[float, Sample]


def looked_for(
    segment: Segment,
    low: Placed,
    high: Placed,
    place: Callable[[Placed, Placed], float | None],
    found: Callable[[Sample], bool],
    halvings: int = HALVINGS,
) -> Iterator[float]:
    """Positions between two solutions at which something is `found`.

    Parameters
    ----------
    place : callable
        Where between two solutions it may be, in parts of what lies between them; None where it cannot be.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    share = place(low, high) if halvings else None
    if share is None:
        return
    theta = low[0] + share * (high[0] - low[0])
    middle = theta, segment.at(theta)
    if found(middle[1]):
        yield theta
        return
    yield from looked_for(segment, low, middle, place, found, halvings - 1)
    yield from looked_for(segment, middle, high, place, found, halvings - 1)
