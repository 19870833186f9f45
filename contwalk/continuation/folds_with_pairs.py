"""A fold at which a pair of eigenvalues passes as well: zero-Hopf, on a line through it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk.continuation.kinds import crossed, pair
from contwalk.continuation.locating import SAME_POINT, Disagreement, Found, accepted
from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample, Test

# How far apart two points at one place are told, in parts of the segment.
APART = 1e-9


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
    rounding = 100.0 * np.maximum(sample.errors, known or 0.0) + 1e-9 * sizes.max(initial=0.0)
    vanish = sizes <= np.maximum(rounding, sizes.min(initial=np.inf) if located else 0.0)
    low, doubtful = int(np.count_nonzero((sample.measures > 0.0) & ~vanish)), int(np.count_nonzero(vanish))
    if crossing and not doubtful:
        return range(len(values) + 1)
    if crossing and not sample.rates.dear:
        moved = crossing * np.array([sample.rates[int(k)] for k in np.flatnonzero(vanish)])
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
