"""What is special between two neighbouring solutions.

Three independent tests look at a segment: the orientation of the bordered Jacobian (branch points), the
parameter's share of the tangent (folds), and the sorted stability measures (eigenvalues that cross). Which
kinds of points they tell, and by which equations these are located, the problem says (`point_types`). Sorted
measures are continuous functions along a branch, so a sign change brackets a crossing, and an interior
extremum near zero may hide two. The tests must agree on how many eigenvalues crossed; if not, the segment is
too long.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product
from operator import attrgetter

import numpy as np

from contwalk.continuation.double_crossings import knots_of
from contwalk.continuation.folds import (
    FLAT,
    at_the_turn,
    counts_at,
    doubt,
    flat_fold,
    multipliers_tell,
    only_noise,
    share_of,
    split,
    with_its_pair,
)
from contwalk.continuation.kinds import crossed, kind_of_test, kinds_of_test, pair, turning_or_pair
from contwalk.continuation.locating import (
    SAME_POINT,
    Disagreement,
    Found,
    Subsegment,
    accepted,
    around,
    first_accepted,
    locate,
    locate_multiple,
    located_along,
    on_finest_steps,
)
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.singularity import singularity
from contwalk.numerics.bracketing import narrow
from contwalk.problems.problem import Sample, Test

# How far from a point its two sides are looked at, in parts of the segment.
BESIDE = 1e-3
# How narrow a bracket says where a real eigenvalue passes zero, in parts of the segment.
NEAR_REAL = 1e-5
# A measure of an eigenvalue that is nearly critical.
NEARLY = 0.5
# Two points of one kind on a segment are this far from each other, in parts of it.
DISTINCT = 1e-3
# What an eigenvalue that is critical at a point is there, against what it is beside it.
CRITICAL = 1e-2


# A key that sorts points along the branch.
_place = attrgetter("theta")


def bifurcations(segment: Segment) -> list[Found]:
    """All bifurcations on a segment, in their order.

    Raises
    ------
    Disagreement, LostBranch
        If the segment must be shorter.
    """
    try:
        found = _in_order(segment)
    except Disagreement as disagreement:
        if disagreement.hidden is None:
            raise
        try:
            found = _in_three_parts(segment, disagreement, disagreement.hidden[0])
        except Disagreement:
            found = at_the_turn(segment, disagreement.hidden[1])
            if not found:
                raise
    _check_apart(segment, found)
    return found


def _in_order(segment: Segment) -> list[Found]:
    """All bifurcations on a segment, in their order and with counts.

    Raises
    ------
    Disagreement, LostBranch
    """
    first = _branch_points(segment, 0.0, 1.0, [])
    knots, found = knots_of(segment, first)
    for low, high in pairwise(knots):
        found += _crossings(segment, low, high, first)
    found = _counted(segment, sorted(found, key=_place), [segment.at(t).unstable for t in knots])
    return sorted([*found, *_around(segment, found)], key=_place) if found else []


def _in_three_parts(segment: Segment, hidden: Disagreement, theta: float) -> list[Found]:
    """All bifurcations on a segment, what errors of its steps hide at a place from the finest steps.

    Raises
    ------
    Disagreement, LostBranch
        As well where the finest steps hide it too, or count otherwise where they begin and end.
    """
    finer = on_finest_steps(segment, segment.at(theta), hidden.type, around(theta))
    if finer is None:
        raise hidden
    low, high = finer.sides
    if [segment.at(side).unstable for side in finer.sides] != [finer.part.a.unstable, finer.part.b.unstable]:
        raise hidden
    return _within([finer, *_parts(segment, [0.0, low, high, 1.0])])


def _around(segment: Segment, found: list[Found]) -> list[Found]:
    """What passes twice between points that are found, and beside them: the segment's ends do not tell it.

    Within what a solution is known to, the steps of a segment see a point elsewhere than where it is located.
    """
    apart, a, b = segment.beside(BESIDE), segment.a.unstable, segment.b.unstable
    places = [0.0, *(f.theta + way for f in found for way in (-apart, apart)), 1.0]
    counts = dict(zip(places, [a, *(count for f in found for count in (f.before, f.after)), b], strict=True))
    parts = _parts(segment, places)
    return _within([p for p in parts if all(segment.at(side).unstable == counts[side] for side in p.sides)])


def _parts(segment: Segment, places: list[float]) -> list[Subsegment]:
    """Parts of a segment, from every second place to the next one."""
    sides = zip(places[::2], places[1::2], strict=True)
    return [Subsegment(segment.between(*each), each) for each in sides if each[0] < each[1]]


def _within(parts: list[Subsegment]) -> list[Found]:
    """All bifurcations on parts of a segment, with counts, by their place on the whole one."""
    placed = (part.placed(f) for part in parts for f in _in_order(part.part))
    return sorted((replace(f, counted=True) for f in placed), key=_place)


def _check_apart(segment: Segment, found: list[Found]) -> None:
    """Refuse one point that two tests have found: what one of them sees lies elsewhere, and is lost.

    Folds are told apart by a part of the segment, branch points by what they are known to: one lies in two
    brackets beside each other within that. Of other kinds two may lie at one place, as where two pairs of
    eigenvalues pass at once.

    Raises
    ------
    Disagreement
    """
    for one, other in pairwise(found):
        tests = one.type.test, other.type.test
        if one.type.label != other.type.label or (one.counted and other.counted):
            continue
        apart = one.located.z - other.located.z
        again = tests == 2 * (Test.ORIENTATION,) and abs(apart[-1]) <= one.located.error + other.located.error
        near = SAME_POINT if again else DISTINCT * segment.length if Test.TURN in tests else 0.0
        if np.linalg.norm(apart / segment.weights) < near:
            raise Disagreement(other.type, f"What two tests see is one point {other.type.label}.")


def _crossings(segment: Segment, low: float, high: float, known: list[Found]) -> list[Found]:
    """Bifurcations between two positions at whose ends the counts are to be trusted."""
    jump = segment.at(high).unstable - segment.at(low).unstable
    found = _branch_points(segment, low, high, known)
    found = _with_folds(segment, low, high, found)
    between = split(segment, low, high, found)
    if between is None:
        return with_its_pair(segment, low, high, found[0])
    if not between and jump not in _reachable(segment, found):
        found += _measure_crossings(segment, low, high, found)
        if jump not in _reachable(segment, found):
            raise Disagreement(
                (turning_or_pair if jump % 2 else pair)(segment.problem),
                "The number of eigenvalues that cross does not agree with the points found.",
            )
        between = split(segment, low, high, sorted(found, key=_place))
    if between:
        return [f for part in pairwise((low, *between, high)) for f in _crossings(segment, *part, known)]
    return found


def _reachable(segment: Segment, found: list[Found]) -> set[int]:
    """Changes of the unstable count that points can bring about together."""
    return {sum(each) for each in product(*(_changes(segment, point) for point in found))}


def _changes(segment: Segment, found: Found) -> tuple[int, ...]:
    """Changes of the unstable count that one point can bring about.

    At a fold or a simple branch point one real eigenvalue passes zero, or none: a pitchfork met along the
    branch that turns there leaves the count; so does a fold whose singular direction is a pinned one.
    """
    if (many := found.located.multiplicity) > 1:
        return tuple(range(-many, many + 1))
    if found.type.test is Test.TURN and not segment.problem.meshed and len(counts_at(found.sample)) == 1:
        return (0,)
    # Of a fold that is not told apart its own eigenvalue passes with the other one.
    return (-2, -1, 0, 1, 2) if found.located.turns else found.type.changes


def _branch_points(segment: Segment, low: float, high: float, known: list[Found]) -> list[Found]:
    """The branch point between two positions whose orientations differ; known ones first."""
    p, q = segment.at(low), segment.at(high)
    if p.orientation == q.orientation:
        return []
    inside = [f for f in known if low < f.theta < high]
    if inside:
        return inside
    value, kind = singularity(segment, p, q), kind_of_test(segment.problem, Test.ORIENTATION)
    try:
        found = locate(segment, kind, low, high, lambda t: value(segment.near(t)), 0)
    except LostBranch:  # where more than two branches meet no border is regular
        if together := _together(segment, low, high):
            return together
        raise
    if found is None:
        raise Disagreement(kind, "The orientation changes, but no branch point is found.")
    if abs(q.unstable - p.unstable) > 1 and kinds_of_test(segment.problem, Test.TOGETHER):
        several = locate_multiple(segment, found.theta)
        if several is not None and several.located.multiplicity % 2:
            return [several]
    return [found]


def _together(segment: Segment, low: float, high: float) -> list[Found]:
    """The point at which an odd number of eigenvalues pass zero at once, if there is one."""
    together = kinds_of_test(segment.problem, Test.TOGETHER)
    found = _measure_crossings(segment, low, high, []) if together else []
    return [point for point in found if point.located.multiplicity > 1]


def _with_folds(segment: Segment, low: float, high: float, branch_points: list[Found]) -> list[Found]:
    """Branch points, and folds on the pieces between them; at them the tangent is known exactly."""
    if not kinds_of_test(segment.problem, Test.TURN):  # along a curve in two parameters a turn is none
        return branch_points
    turning, crossing = (kind_of_test(segment.problem, test) for test in (Test.TURN, Test.ORIENTATION))
    ends = [(low, share_of(segment.at(low)))]
    for bp in branch_points:
        tangent = crossing.tangent(segment.problem, bp.located, bp.sample)
        ends.append((bp.theta, share_of(bp.sample, tangent) if tangent is not None else 0.0))
    ends.append((high, share_of(segment.at(high))))
    found = []
    for (t0, v0), (t1, v1) in pairwise(ends):
        if v0 * v1 < 0.0 and not multipliers_tell(segment, t0, t1):
            fold = locate(segment, turning, t0, t1, lambda t: share_of(segment.at(t)), 0, (v0, v1))
            if fold is not None:
                found.append(fold)
            elif not only_noise(segment, t0, t1):
                raise Disagreement(turning, "The parameter turns, but no fold is found.")
    if found or not ends[0][1] * ends[-1][1] < 0.0:
        return branch_points + found
    return [found for bp in branch_points for found in _with_its_fold(segment, low, high, bp)]


def _with_its_fold(segment: Segment, low: float, high: float, point: Found) -> list[Found]:
    """A branch point, and the fold that lies so near to it that the parameter's share there is noise.

    A branch that turns at the branch point itself has one critical eigenvalue there; beside a fold of its own
    there are two, the other one that of the fold.
    """
    sides = _sides(segment, point)
    if not _twice_critical(point.sample, sides):
        return [point]
    turning = kind_of_test(segment.problem, Test.TURN)
    for side in sides:  # at the branch point itself the equations of the fold are singular
        fold = accepted(segment, turning, side, 0, low, high)
        if fold is not None and _turns_along(fold, side):
            return [point, fold]
    return [replace(point, located=replace(point.located, turns=True))]


def _turns_along(fold: Found, near: Sample) -> bool:
    """Whether a fold's critical vector is the tangent; that of the branch point solves its equations too."""
    vector = fold.located.critical
    if vector is None:
        return True
    along = near.tangent[: len(vector)]
    return bool(abs(along @ vector) > 0.99 * np.linalg.norm(along) * np.linalg.norm(vector))


def _sides(segment: Segment, point: Found) -> list[Sample]:
    """Solutions beside a branch point."""
    apart = segment.beside(BESIDE)
    return [segment.at(t) for t in (point.theta - apart, point.theta + apart) if 0.0 <= t <= 1.0]


def _twice_critical(there: Sample, sides: list[Sample]) -> bool:
    """Whether two eigenvalues are critical at a branch point, against what they are beside it."""

    def second(sample: Sample) -> float:
        return float(np.sort(np.abs(sample.eigenvalues - sample.critical))[1])

    return len(there.eigenvalues) > 1 and any(second(there) <= CRITICAL * second(side) for side in sides)


def _measure_crossings(segment: Segment, low: float, high: float, known: list[Found]) -> list[Found]:
    """Crossings of stability measures that folds and branch points do not explain."""
    p, q = segment.at(low), segment.at(high)
    found: list[Found] = []
    unexplained: list[tuple[float, int]] = []
    for which in range(min(p.unstable, q.unstable), max(p.unstable, q.unstable)):
        # Of a pair that was found the other one: both are neighbours in the order.
        pairs = (f.located.which for f in found if f.sample.eigenvalues[which].imag != 0.0)
        if any(own in (which - 1, which + 1) for own in pairs):
            continue
        crossing = _locate_crossing(segment, low, high, which)
        if isinstance(crossing, Found):
            found.append(crossing)
        elif not any(abs(f.theta - crossing) < doubt(p, q, which) for f in known):
            unexplained.append((crossing, which))
    if unexplained:
        found.append(_multiple(segment, unexplained) or flat_fold(segment, low, high, unexplained))
    return found


def _multiple(segment: Segment, crossings: list[tuple[float, int]]) -> Found | None:
    """The point at which several real eigenvalues pass zero together, unseen by the orientation if even."""
    near = len(crossings) > 1 and np.ptp([theta for theta, _ in crossings]) < 10.0 * NEAR_REAL
    return locate_multiple(segment, crossings[0][0]) if near else None


def _locate_crossing(segment: Segment, low: float, high: float, which: int) -> Found | float:
    """The special point at which measure `which` passes zero, or its position where other tests see it."""

    def value(theta: float) -> float:
        return float(segment.at(theta).measures[which])

    def attempt(theta: float, left: float, right: float) -> Found | float | None:
        sample = segment.at(theta)
        kind = crossed(segment.problem, sample, which)
        if kind is not None:
            still = abs(sample.share) <= FLAT
            # From farther away it may be a long way along the branch, on each of several finer steps.
            flat = kind.flat if still and abs(sample.measures[which]) < NEARLY else ()
            point = first_accepted(segment, (kind, *flat), sample, which, left, right)
            return point if point is None or _passes_at(point.sample, which) else None
        # A real eigenvalue: its place is enough, and nearer to it the corrector may be singular.
        met = abs(sample.measures[which]) <= sample.errors[which]
        return theta if met or right - left < NEAR_REAL else None

    v0, v1 = value(low), value(high)
    found: Found | float | None
    kind = crossed(segment.problem, segment.at(low if v0 > v1 else high), which)
    if kind is not None and kind.along:
        found = located_along(segment, kind, low, high, which)
    elif v0 * v1 > 0.0:  # one end is the point itself, to rounding: its sign was taken from its neighbour
        nearer = low if abs(v0) < abs(v1) else high
        found = attempt(nearer, low, high)
    else:
        found = narrow(value, low, high, v0, v1, attempt)
    if isinstance(found, Found):
        return replace(found, located=replace(found.located, which=which))
    if found is not None:
        return found
    kind = crossed(segment.problem, segment.at(high if abs(v1) < abs(v0) else low), which)
    kind = kind or turning_or_pair(segment.problem)  # a real one
    raise Disagreement(kind, f"Eigenvalues cross, but no point {kind.label} is found.")


def _passes_at(sample: Sample, which: int) -> bool:
    """Whether it may be eigenvalue `which` that is critical at a point, and not one that is beside it."""
    known = np.maximum(sample.errors, sample.spectrum_error or 0.0)
    sizes = np.abs(sample.beyond(sample.eigenvalues))
    return bool(sizes[which] - known[which] <= np.min(sizes + known))


def _counted(segment: Segment, found: list[Found], seen: list[int]) -> list[Found]:
    """Unstable counts on both sides of each point, from samples between neighbouring points.

    Between two that lie within errors of each other a sample may hide what passes at either: there it is the
    count that both can bring about, or one of these that was `seen` where the segment was split.
    """
    if not found:
        return found
    between = [0.0, *[0.5 * (f.theta + g.theta) for f, g in pairwise(found)], 1.0]
    counts = [segment.at(t).unstable for t in between]
    for k, (f, g) in enumerate(pairwise(found), start=1):
        possible = {counts[k - 1] + change for change in _changes(segment, f)}
        possible &= {counts[k + 1] - change for change in _changes(segment, g)}
        if counts[k] not in possible:
            likely = possible & set(seen) or possible
            counts[k] = likely.pop() if len(likely) == 1 else counts[k]
    return [
        f if f.counted else replace(f, before=before, after=after)
        for f, (before, after) in zip(found, pairwise(counts), strict=True)
    ]
