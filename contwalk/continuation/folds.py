"""Folds: when the parameter's share of the tangent tells of a turn, and what tells of one where it does not.

Along explosions of cycles the parameter hardly moves: an eigenvalue tells then, or the parameter itself. At a
fold a pair of eigenvalues may pass as well: zero-Hopf, on a line through it.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk.continuation.kinds import crossed, kind_of_test, kinds_of_test, pair
from contwalk.continuation.locating import (
    KNOWN,
    SAME_POINT,
    Disagreement,
    Found,
    accepted,
    first_accepted,
    unlocated,
)
from contwalk.continuation.segment import Segment
from contwalk.numerics.bracketing import zero_of
from contwalk.numerics.linear import EPSILON, norm_in
from contwalk.problems.problem import Located, PointType, Sample, Test

# Below this share of the parameter in the unit tangent, its sign is rounding noise.
NO_SHARE = 1e-9
# At a branch point the tangent comes from second derivatives at a point that is known to about this.
FAINT_SHARE = 1e-6
# With a smaller share of the parameter than the first a branch goes straight up; than the second, it turns.
FLAT, NEARLY_FLAT = 1e-7, 1e-3
# What is said where an eigenvalue passes zero along a branch on which the parameter stands still.
SECOND = (
    "A second real eigenvalue passes zero on a branch along which the parameter stands still: the branch "
    "turns back in a state, and no other one leaves there. The place is told as it is bracketed."
)
BESIDE_THE_FOLD = (
    "A multiplier goes from beyond 1 to beyond -1 at the fold, within what is known of it there."
)
# How far apart two points at one place are told, in parts of the segment.
APART = 1e-9


def share_of(sample: Sample, tangent: np.ndarray | None = None) -> float:
    """The parameter's share of the unit tangent, zero where it is noise.

    `tangent`, of shape (N + 1,), is that of a branch point.
    """
    if tangent is not None:
        return float(at_branch_point(tangent, sample.weights)[-1] / sample.weights[-1])
    return sample.share if abs(sample.share) > NO_SHARE else 0.0


def at_branch_point(tangent: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """A tangent at a branch point, shape (N + 1,), without a share of the parameter that is noise.

    The sign of that noise would tell of a fold beside the pitchfork.
    """
    if abs(tangent[-1] / weights[-1]) > FAINT_SHARE * np.linalg.norm(tangent / weights):
        return tangent
    return np.append(tangent[:-1], 0.0)


def multipliers_tell(segment: Segment, low: float, high: float) -> bool:
    """Whether the parameter stands still between two positions, and multipliers tell what lies there.

    Along an explosion of cycles its share of the tangent is rounding, and turns elsewhere than they say, by
    far more than it takes them to go from beyond 1 to beyond -1.
    """
    p, q = segment.at(low), segment.at(high)
    still = max(abs(share_of(p)), abs(share_of(q))) <= FLAT and not segment.vertical
    return segment.problem.meshed is not None and still and p.unstable != q.unstable


def only_noise(segment: Segment, low: float, high: float) -> bool:
    """Whether the parameter's share between two positions tells nothing but errors of the equations.

    Along an explosion of cycles the parameter stands still to these errors, while solutions move on: they
    alone turn it. At a fold of its own an eigenvalue would pass its critical value.
    """
    ends = [segment.at(theta) for theta in (low, high)]
    errors = np.nan_to_num([end.error for end in ends])
    share = max(abs(end.share) for end in ends)
    if segment.problem.meshed is None or share > float(errors.sum()) / max(segment.length, 1e-300):
        return False
    certain = [np.abs(end.measures) > end.errors for end in ends]
    return ends[0].unstable == ends[1].unstable and bool(np.all(certain[0] == certain[1]))


def flat_fold(segment: Segment, low: float, high: float, crossings: list[tuple[float, int]]) -> Found:
    """The fold at which an eigenvalue passes zero while the parameter hardly moves.

    In an explosion of cycles the parameter may turn by less than it is known to: then the fold is where the
    eigenvalue passes, and known along the branch as well as that is.
    """
    ends = [segment.at(theta) for theta in (low, high)]
    share = max(abs(end.share) for end in ends)
    kind = kind_of_test(segment.problem, Test.TURN)
    if share > FLAT:
        _refuse_jump(segment, ends, crossings[0][1])
        likely = kind if share < NEARLY_FLAT else kind_of_test(segment.problem, Test.ORIENTATION)
        raise Disagreement(
            likely, "A real eigenvalue passes zero where there is no fold and no branch point."
        )
    theta, which = crossings[0]
    sample, width = segment.at(theta), abs(float(segment.chord[-1]))
    if segment.vertical:  # every point of it solves the equations of a fold
        known = max(width, float(np.spacing(abs(sample.parameter))))
        return unlocated(theta, kind, sample, known, SECOND)
    around = min(doubt(segment.at(low), segment.at(high), which), 1.0)
    fold = first_accepted(segment, (*kind.flat, kind), sample, which, low - around, high + around)
    if fold is not None:
        return fold
    note = "A real eigenvalue passes zero, and the parameter turns by less than it is known to."
    return unlocated(theta, kind, sample, width, note)


def _refuse_jump(segment: Segment, ends: list[Sample], which: int) -> None:
    """Refuse an eigenvalue that is critical on neither side, as where a field or a reset bends.

    Where its unstable side is no real eigenvalue's, the point is of the kind of that side.

    Raises
    ------
    Disagreement
    """
    kind = crossed(segment.problem, max(ends, key=lambda end: float(end.measures[which])), which)
    if kind is None:
        return
    beside = [complex(end.eigenvalues[which]) for end in ends]
    values = " and ".join(f"{value if value.imag else value.real:.4g}" for value in beside)
    raise Disagreement(
        kind, f"An eigenvalue jumps over what is critical: it is {values} beside it, as where equations bend."
    )


def doubt(p: Sample, q: Sample, which: int) -> float:
    """How far from its point a real eigenvalue may seem to pass its critical value, in parts of the
    segment.
    """
    known = max((s.spectrum_error or 0.0) + np.nan_to_num(s.trivial_error) for s in (p, q))
    change = abs(float(p.measures[which] - q.measures[which]))
    return 1e-3 + 10.0 * known / max(change, 1e-300)


def split(segment: Segment, low: float, high: float, found: list[Found]) -> list[float] | None:
    """Where to split what lies between two positions, since more has crossed than what is found there.

    At a located point one eigenvalue vanishes, and the signs of the others are to be seen: the counts on both
    sides must agree with them. Beside a Bogdanov-Takens point a Hopf point lies as near to a fold as one
    likes, and together they change the count as a fold alone does. Nearer to the point than the other
    crossing the count does agree: that is between two places. None where no place that near does at a fold
    that is found alone.
    """
    # Of what lies between two points each is asked up to the middle.
    edges = [low, *(0.5 * (f.theta + g.theta) for f, g in pairwise(found)), high]
    alone = len(found) == 1 and found[0].type.test is Test.TURN and segment.problem.meshed is None
    for point, *sides in zip(found, edges, edges[1:], strict=False):
        for side, way in zip(sides, (-1.0, 1.0), strict=True):
            crossing = 0.0 if point.type.test is Test.TURN else way * segment.length
            possible = counts_at(point.sample, segment.problem.meshed is not None, crossing)
            around = [side]
            while segment.at(around[-1]).unstable not in possible:
                around.append(0.5 * (point.theta + around[-1]))
                if abs(around[-1] - point.theta) < APART:
                    if alone:
                        return None
                    break
            else:
                if len(around) > 1:
                    return sorted({*around[-2:]} - {low, high})
    return []


def counts_at(sample: Sample, located: bool = False, crossing: float = 0.0) -> range:
    """How many eigenvalues may be unstable beside a solution: those that vanish there may, on either side.

    Where they are `crossing`, that far behind the point or before it, what is critical is the measure, and
    rates tell how many are unstable. On steps that see nothing critical at the point nothing is told.

    At a special point that is `located` on steps the nearest one does, whatever it is there: along a canard a
    fold that is known to 1e-13 has a multiplier that is 2e-6 from one.
    """
    values = sample.eigenvalues
    sizes = np.abs(sample.beyond(values) if crossing else values - sample.critical)
    known = sample.spectrum_accuracy if located else sample.spectrum_error
    rates = sample.rates.values
    off = 1e-11 * sizes.max(initial=0.0)
    if not located and rates is not None:  # what the place is rounded to moves them
        off = EPSILON * norm_in(sample.z, sample.weights) * np.abs(rates)
    rounding = 100.0 * (np.maximum(sample.errors, known or 0.0) + off)
    vanish = sizes <= np.maximum(rounding, sizes.min(initial=np.inf) if located else 0.0)
    low, doubtful = int(np.count_nonzero((sample.measures > 0.0) & ~vanish)), int(np.count_nonzero(vanish))
    if crossing and not doubtful:
        return range(len(values) + 1)
    if crossing and rates is not None:
        moved = crossing * rates[vanish]
        moves = np.abs(moved) > rounding[vanish]
        low, doubtful = low + int(np.count_nonzero(moves & (moved > 0.0))), int(np.count_nonzero(~moves))
    return range(low, low + doubtful + 1)


def with_its_pair(segment: Segment, low: float, high: float, fold: Found) -> list[Found]:
    """A fold, and the point that a pair of eigenvalues passes right there (zero-Hopf, on a line through it).

    Nothing tells which is passed first: it is the fold, if the counts allow that.

    Raises
    ------
    Disagreement
        If there is no such pair at it.
    """
    sample = fold.sample
    critical = np.abs(sample.measures) <= 100.0 * sample.errors
    pairs = np.flatnonzero(critical & (sample.eigenvalues.imag > 0.0))
    before, after = segment.at(low).unstable, segment.at(high).unstable
    # A real one and a pair change the count by -1 and 2, say: by their sum both are known.
    both = next((c for c in ((1, 2), (1, -2), (-1, 2), (-1, -2)) if sum(c) == after - before), None)
    kind = crossed(segment.problem, sample, int(pairs[0])) if len(pairs) == 1 and both is not None else None
    point = None if kind is None else accepted(segment, kind, sample, int(pairs[0]), low, high)
    if point is None or np.linalg.norm((point.located.z - fold.located.z) / segment.weights) > SAME_POINT:
        raise Disagreement(
            pair(segment.problem),
            "The unstable directions beside a fold do not agree with the eigenvalues at it.",
        )
    assert both is not None
    between = before + both[0] if before + both[0] >= 0 else before + both[1]
    points = [fold, point] if between == before + both[0] else [point, fold]
    counts = ((before, between), (between, after))
    places = (fold.theta, fold.theta + APART) if fold.theta < 0.5 else (fold.theta - APART, fold.theta)
    return [
        replace(f, theta=theta, before=b, after=a, counted=True)
        for f, theta, (b, a) in zip(points, places, counts, strict=True)
    ]


def at_the_turn(segment: Segment, which: int) -> list[Found]:
    """The fold that the parameter's own turn tells, and the doubling that is not told apart from it.

    Multiplier `which` goes from beyond 1 to beyond -1 there, faster than anything is known: it passes both.
    """
    turning = next(iter(kinds_of_test(segment.problem, Test.TURN)), None)
    fold = None if turning is None else _turned(segment, turning)
    if fold is None:
        return []
    counted = replace(fold, before=segment.a.unstable, after=segment.b.unstable, counted=True)
    ends = (end for end in (segment.a, segment.b) if end.eigenvalues[which].real < 0.0)
    doubling = next((crossed(segment.problem, end, which) for end in ends), None)
    if doubling is None:
        return [counted]
    return [counted, replace(counted, type=doubling, kind="unlocated", note=BESIDE_THE_FOLD)]


def _turned(segment: Segment, kind: PointType) -> Found | None:
    """The fold at which the parameter turns between the ends, and by more than it is known to.

    That is so whatever multipliers tell: where deviations grow beyond 1e16 they tell nothing near one. Errors
    of the steps shift a fold, but change along the branch as solutions do: over a step by its length, in the
    metric, of what they are. Beside that a turn is lost in rounding alone.
    """
    meshed = segment.problem.meshed
    if meshed is None or segment.vertical:
        return None
    theta = zero_of(lambda theta: segment.at(theta).share, 0.0, 1.0)
    if theta is None:
        return None
    sample = segment.at(theta)
    equations, row = segment.problem.linearize(sample.z), sample.tangent / sample.weights**2
    known = equations.parameter_error(row, sample.weights, meshed.errors_at(sample.z))
    rounding = equations.parameter_error(row, sample.weights, equations.levels[0])
    rises = [abs(sample.parameter - end.parameter) for end in (segment.a, segment.b)]
    if not min(rises) > KNOWN * (rounding + segment.length * known):
        return None
    error = max(known, float(np.spacing(abs(sample.parameter))))
    return Found(theta, kind, Located(sample.z, error, problem=segment.problem), sample, turned=True)
