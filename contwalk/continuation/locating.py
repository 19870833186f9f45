"""From a bracket to a special point: the defining system's solution, if it lies there and on the branch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation.kinds import kinds_of_test
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.errors import NotFinite
from contwalk.numerics.bracketing import NARROW, narrow, zero_of
from contwalk.numerics.linear import norm_in
from contwalk.problems.problem import Located, PointType, Sample, Test, finest

# Of two points that are one, in the metric, beside what a mesh blurs.
SAME_POINT = 1e-6
ROUNDING = 1e-13
# A branch point on a mesh is known less exactly than that, and rounding unfolds it: whether the branch passes
# is judged no nearer, up to this part of the segment.
FARTHEST = 0.1
# How far beyond what solutions are known to that is.
WELL_BEYOND = 10.0
# A located point lies on the branch if it is this near, relative to the segment, where equations are exact.
LOCATION_TOLERANCE = 1e-6
# What the ends of a segment are known to blurs as well, up to this part of the segment.
DOUBTED = 1e-2
# On the finest steps a position is looked at so far to both sides, in parts of the segment.
NEIGHBOURHOOD = 0.02
# So many times what something is known to are beyond doubt.
KNOWN = 10.0

Sides = tuple[float, float]


@dataclass(frozen=True)
class Found:
    """A located special point: where on the segment, what, and the sample there."""

    theta: float
    type: PointType
    located: Located
    sample: Sample
    before: int = 0
    after: int = 0
    kind: str | None = None
    counted: bool = False  # the counts are known already
    mark: tuple[str, float | None] | None = None  # what has which marked value there; None: an extremum
    note: str = ""  # what else is to be told of it
    turned: bool = False  # the parameter's own turn tells a fold, and multipliers do not
    entered: bool = False  # a limit is passed from beyond
    end: Outcome | None = None  # how the branch ends there, where its kind says so

    @property
    def label(self) -> str:
        """As it is stored."""
        return self.type.label


def unlocated(
    theta: float, kind: PointType, sample: Sample, width: float, note: str, before: int = 0, after: int = 0
) -> Found:
    """What is detected at a solution and cannot be located, with the parameter known to a width."""
    located: Located = Located(sample.z, width)
    return Found(theta, kind, located, sample, before, after, "unlocated", note=note)


class Disagreement(Exception):
    """The tests do not agree, or what they see, a point of this kind, cannot be located.

    `hidden` is the place 0..1 and the number of a stability measure of which finer steps may show more.
    """

    def __init__(self, kind: PointType, sentence: str, hidden: tuple[float, int] | None = None) -> None:
        super().__init__(sentence)
        self.type, self.sentence, self.hidden = kind, sentence, hidden


def locate(
    segment: Segment,
    kind: PointType,
    low: float,
    high: float,
    value: Callable[[float], float],
    which: int,
    values: tuple[float, float] | None = None,
) -> Found | None:
    """The special point bracketed by a test, by its defining system."""

    def attempt(theta: float, left: float, right: float) -> Found | None:
        return accepted(segment, kind, segment.near(theta), which, left, right)

    v0, v1 = values or (value(low), value(high))
    if v0 * v1 > 0.0:  # the borders of the test were chosen badly for so long a segment
        return attempt(0.5 * (low + high), low, high)
    return narrow(value, low, high, v0, v1, attempt)


def accepted(
    segment: Segment,
    kind: PointType,
    near: Sample,
    which: int,
    left: float,
    right: float,
    known: Callable[[Located, float], Found | None] | None = None,
) -> Found | None:
    """The solution of the defining system near a sample, if it lies in the bracket and on this branch.

    `known` is asked whether what lies at a position has been found already, before more is spent on it.
    """
    try:
        located = kind.locate(segment.problem, near, which)
        if located is None:
            return None
        theta = segment.position(located.z)
        # Where equations are exact so is the place: what lies beside the bracket is not of it.
        slack = ROUNDING / segment.length + (1e-3 * (right - left) if segment.problem.meshed else 1e-12)
        if kind.test is Test.ORIENTATION and segment.problem.meshed is not None:
            slack += _blurred(segment, DOUBTED)
        if not left - slack <= theta <= right + slack:
            return None
        # The point may be an end of the segment, to rounding: it is never placed beyond it.
        inside = min(max(theta, 0.0), 1.0)
        # Right at a branch point a sample's own tangent is noise; the ends of the segment know the way.
        near = replace(near, tangent=segment.direction(inside))
        if not _on_branch(segment, kind, located, near, theta, right - left):
            return None
        if known is not None and (found := known(located, theta)) is not None:
            return found
        settled = located.settled()
        # Finer steps may have led to another point than the one that was found on the segment's own.
        reach = segment.length + WELL_BEYOND * segment.error
        if settled is None or norm_in(settled.z - located.z, segment.weights) > reach:
            return None
        return Found(inside, kind, settled, sample_at(segment, kind, settled, near))
    except (NotFinite, np.linalg.LinAlgError):  # as if its equations had no solution there
        return None


def first_accepted(
    segment: Segment, kinds: Sequence[PointType], near: Sample, which: int, left: float, right: float
) -> Found | None:
    """The point of the first of some kinds that is `accepted`."""
    found = (accepted(segment, kind, near, which, left, right) for kind in kinds)
    return next((point for point in found if point is not None), None)


def locate_multiple(segment: Segment, theta: float) -> Found | None:
    """The point near theta at which the null space of F_u has more than one dimension."""
    span = 1e-4
    kinds = kinds_of_test(segment.problem, Test.TOGETHER)
    return first_accepted(segment, kinds, segment.at(theta), 0, theta - span, theta + span)


def _on_branch(
    segment: Segment, kind: PointType, located: Located, near: Sample, theta: float, width: float
) -> bool:
    """Whether a located point is on this branch and not on another one nearby."""
    tangent = kind.tangent(segment.problem, located, near)
    if tangent is None:
        return same_point(segment, located, theta)
    # The more branches meet there, the farther its influence reaches.
    offset = 1e-2 if kind.test is Test.TOGETHER else max(1e-3 * width, 1e-7)
    if segment.problem.meshed is not None:
        # Solutions beside it are known the less, the weaker the nonlinearity that holds them.
        known = max(SAME_POINT, WELL_BEYOND * segment.error)
        offset = max(offset, min(known / segment.length, FARTHEST))
    return passes_through(segment, located.z, tangent, theta, offset)


def _blurred(segment: Segment, most: float) -> float:
    """Part of a segment that its ends are known to, and at most so much: no place on it is known better."""
    return min(segment.error / segment.length, most)


def passes_through(segment: Segment, z: np.ndarray, tangent: np.ndarray, theta: float, offset: float) -> bool:
    """Whether the branch passes a branch point along a tangent, judged beside it: at it all is singular.

    z and the tangent have the shape (N + 1,); `theta` is the point's place on the segment, 0..1, and `offset`
    how far beside it is judged, in theta.
    """
    along = tangent / float(segment.normal @ tangent)
    for side in (-offset, offset):
        if not 0.0 <= theta + side <= 1.0:
            continue
        if segment.distance(z + side * along, theta + side) > 0.1 * offset + ROUNDING / segment.length:
            return False
    return True


def same_point(segment: Segment, located: Located, theta: float) -> bool:
    """Whether a located point is the branch's own solution at theta."""
    meshed = segment.problem.meshed
    tolerance = LOCATION_TOLERANCE if meshed is None else meshed.location_tolerance
    least = tolerance + ROUNDING / segment.length + _blurred(segment, DOUBTED)
    # As near to what is guessed of the branch there, it is so to the branch.
    guessed = np.linalg.norm((segment.guess(theta) - located.z) / segment.weights) / segment.length
    return bool(guessed < 0.1 * least) or segment.distance(located.z, theta) < least


def sample_at(segment: Segment, kind: PointType, located: Located, near: Sample) -> Sample:
    """The sample at a located point; its tangent is the branch's own even where DF does not determine it."""
    problem = segment.problem if located.problem is None else located.problem
    linearization = problem.linearize(located.z)
    tangent = kind.tangent(problem, located, near)
    if tangent is None:
        tangent = segment.tangent(linearization)
    elif segment.normal @ tangent < 0:
        tangent = -tangent
    return problem.examine(located.z, tangent, segment.weights, linearization, near.unstable)


def located_along(segment: Segment, kind: PointType, low: float, high: float, which: int) -> Found | None:
    """The point of a kind between two positions, on the finest steps that there are, if there is one.

    It is located along the branch by a function of its own: its equations are singular there.
    """
    theta = _zero(segment, kind, low, high)
    if theta is None:
        return None
    try:
        finer = on_finest_steps(segment, segment.at(theta), kind, around(theta, low=low, high=high))
    except Disagreement:
        finer = None
    whole, ends = (Subsegment(segment, (0.0, 1.0)), (low, high)) if finer is None else (finer, (0.0, 1.0))
    part = whole.part
    position = theta if finer is None else _zero(part, kind, *ends)
    if position is None:
        return None
    sample = part.at(position)
    first, last = (kind.value(part.problem, part.at(end)) for end in ends)
    slope = (last - first) / (ends[1] - ends[0])
    blur = max(_blur(kind, part, part.at(end)) for end in ends) / max(abs(slope), 1e-300) + NARROW
    known = blur * abs(float(part.chord[-1])) + sample.error * float(sample.weights[-1])
    error = max(known, float(np.spacing(abs(sample.parameter))))
    located: Located = Located(sample.z, error, problem=part.problem, which=which)
    return whole.placed(Found(position, kind, located, sample))


def _zero(segment: Segment, kind: PointType, low: float, high: float) -> float | None:
    """Where the function of a kind passes zero, to rounding."""
    return zero_of(lambda theta: kind.value(segment.problem, segment.at(theta)), low, high)


@dataclass(frozen=True)
class Subsegment:
    """What lies between two positions of a segment, on steps of its own."""

    part: Segment
    sides: Sides

    def placed(self, point: Found) -> Found:
        """A point of the part by its position on the whole segment."""
        low, high = self.sides
        return replace(point, theta=low + point.theta * (high - low))


def around(theta: float, aside: float = NEIGHBOURHOOD, low: float = 0.0, high: float = 1.0) -> Sides:
    """The positions so far aside of one, between two others."""
    return max(theta - aside, low), min(theta + aside, high)


def on_finest_steps(segment: Segment, near: Sample, kind: PointType, sides: Sides) -> Subsegment | None:
    """What is between two positions on the finest steps; a kind of point is in doubt at a sample there.

    None where the problem has none, or the branch is lost.

    Raises
    ------
    Disagreement
        If the equations have no value on them.
    """
    try:
        problem = finest(segment.problem, near.z, segment.weights)
    except NotFinite as error:
        raise Disagreement(kind, f"Two crossings may hide there: {error.sentence}") from None
    if problem is None:
        return None
    try:
        a, b = (segment.on(problem, side) for side in sides)
    except LostBranch:
        return None
    return Subsegment(Segment(problem, a, b), sides)


def _blur(kind: PointType, segment: Segment, sample: Sample) -> float:
    """What the function is not known to, by what eigenvalues are not known to away from the point.

    These are off by that of the function over its root.
    """
    off = float(sample.errors.max(initial=0.0)) if sample.spectrum_error is None else sample.spectrum_error
    size = float(np.abs(sample.eigenvalues).max(initial=1e-300))
    return KNOWN * off / size * float(np.sqrt(abs(kind.value(segment.problem, sample))))
