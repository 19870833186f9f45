"""Margins that pass zero and come back between two solutions: a distance that is least in between."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.continuation.halving import NEAR_ZERO, Placed, looked_for
from contwalk.continuation.segment import Segment
from contwalk.numerics import cubic
from contwalk.problems.problem import Sample

# Displacement along the branch, in the metric, for the rate of a margin: the root of what it is known to.
BESIDE = 1e-4


def dips(segment: Segment, rounded: float) -> Iterator[float]:
    """Places at which a margin has another sign than at both ends, by more than what is `rounded` of it.

    One that is larger than the step is long would have to change faster than anything that is watched.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    a, b = segment.a.margins, segment.b.margins
    if len(a) != len(b) or segment.problem.limited is None:
        return
    with np.errstate(invalid="ignore"):
        near = (a * b > 0.0) & (np.minimum(np.abs(a), np.abs(b)) < segment.length)
    for which in np.flatnonzero(near).tolist():
        place = next(_passing(segment, which, float(np.sign(a[which])), rounded), None)
        if place is not None:
            yield place


def _passing(segment: Segment, which: int, sign: float, rounded: float) -> Iterator[float]:
    """Places at which a margin that has a sign at both ends of a segment has the other one."""

    def place(low: Placed, high: Placed) -> float | None:
        """Where the cubic of a margin is least, if it falls at the one end and grows at the other."""
        values = [sign * float(sample.margins[which]) for _, sample in (low, high)]
        if not min(values) > 0.0:
            return None
        rates = []
        for (_, sample), falls in ((low, True), (high, False)):  # the second has its price as well
            rate = sign * (high[0] - low[0]) * segment.length * _rate(segment, sample, which)
            if not (rate < 0.0 if falls else rate > 0.0):
                return None
            rates.append(rate)
        given = np.array([[*values, *rates]])
        places = cubic.turns(given)
        least = (given @ cubic.weights(places[0]))[0]
        at = int(np.argmin(least))
        return float(places[0, at]) if least[at] < NEAR_ZERO * min(values) else None

    def passes(sample: Sample) -> bool:
        return sign * float(sample.margins[which]) < -rounded

    return looked_for(segment, (0.0, segment.a), (1.0, segment.b), place, passes)


def _rate(segment: Segment, sample: Sample, which: int) -> float:
    """Derivative of a margin by arclength; NaN where it has no value beside a solution."""
    limited = segment.problem.limited
    assert limited is not None
    beside = limited.margins(sample.z + BESIDE * sample.tangent, sample.weights)
    return float(beside[which] - sample.margins[which]) / BESIDE
