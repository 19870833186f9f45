"""Whether a walk has come back to where it began."""

from __future__ import annotations

from contwalk.continuation.locating import Found, passes_through
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.problems.problem import Sample, Test

# How near a solution is to the beginning, in parts of a step; the same beside a branch point.
NEAR, BESIDE = 1e-5, 1e-2
# Located branch points are at one value of the parameter, in the metric, if they differ by less.
FOUND_AGAIN = 1e-6
# What tells points at which another branch crosses.
CROSSINGS = (Test.ORIENTATION, Test.TOGETHER)


def place_of_closure(segment: Segment, found: list[Found], origin: Sample) -> float | None:
    """Where an accepted step, with what is special on it, passes a walk's beginning the same way round.

    It is a place on the segment, 0..1, or None where the step does not.
    """
    if segment.problem.meshed is not None:
        back = _comes_back(segment, origin)
        return _finds_again(segment, found, origin) if back is None else back
    z = segment.problem.equivalence.nearest_turn(origin.z, segment.a.z)
    theta = segment.position(z)
    same_way = origin.tangent / origin.weights**2 @ segment.b.tangent > 0.0
    if not (0.0 < theta <= 1.0 and same_way):
        return None
    try:
        if origin.orientation == 0.0:
            passed = passes_through(segment, z, origin.tangent, theta, BESIDE)
        else:
            passed = segment.distance(z, theta) < NEAR
    except LostBranch:
        return None
    return float(theta) if passed else None


def _comes_back(segment: Segment, origin: Sample) -> float | None:
    """Where a segment of orbits, which begin anywhere on themselves, passes a given one."""
    a, b, value = segment.a.parameter, segment.b.parameter, origin.parameter
    if (a - value) * (b - value) > 0.0 or a == b or (b - a) * origin.tangent[-1] < 0.0:
        return None
    try:
        low, high, theta = 0.0, 1.0, (value - a) / (b - a)
        for _ in range(40):
            there = segment.at(theta)
            if abs(there.parameter - value) <= 1e-11 * segment.weights[-1]:
                break
            low, high = (theta, high) if (there.parameter - value) * (b - a) < 0.0 else (low, theta)
            slope = there.tangent[-1] / float(segment.normal @ there.tangent)
            theta += (value - there.parameter) / slope if slope else 0.0
            theta = theta if low < theta < high else 0.5 * (low + high)
        return float(theta) if segment.problem.equivalence.same(origin, there) else None
    except LostBranch:
        return None


def _finds_again(segment: Segment, found: list[Found], origin: Sample) -> float | None:
    """The place of a branch point located on the way that is the orbit which the walk began with.

    A branch that leaves a pitchfork has the parameter's extremum there: when it comes back, the parameter
    touches the value that it began with and does not cross it.
    """
    near = FOUND_AGAIN * origin.weights[-1]
    places = (
        each.theta
        for each in found
        if each.kind != "unlocated"
        and each.type.test in CROSSINGS
        and abs(each.sample.parameter - origin.parameter) <= near
        and (each.located.problem or segment.problem).equivalence.same(origin, each.sample)
    )
    return next(places, None)
