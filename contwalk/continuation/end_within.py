"""A step beyond the end of its branch: the part of it up to the end."""

from __future__ import annotations

from contwalk.continuation.segment import Segment
from contwalk.numerics.bracketing import zero_of

# What is left of a step before the end, in parts of it: less is the end itself.
LEAST = 1e-9


def up_to_end(segment: Segment) -> Segment | None:
    """The part of a segment before the first place at which a branch ends on it.

    None where it ends right at the beginning, or nobody knows where.
    """
    first, last = (segment.problem.diagnosis.end_functions(there) for there in (segment.a, segment.b))
    passed = [which for which in range(len(first)) if first[which] < 0.0 < last[which]]
    found = [theta for which in passed if (theta := _zero(segment, which)) is not None]
    theta = min(found, default=0.0)
    return segment.until(theta) if theta > LEAST else None


def _zero(segment: Segment, which: int) -> float | None:
    """Where on a segment an end function passes zero."""
    return zero_of(lambda t: segment.problem.diagnosis.end_functions(segment.at(t))[which], 0.0, 1.0)
