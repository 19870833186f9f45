"""Crossings that come in pairs: extrema of stability measures between two solutions that reach past zero."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from contwalk.continuation.locating import Found
from contwalk.continuation.rootfinding import narrow
from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample

# An extremum is looked at when it comes this much nearer to zero than the ends.
NEAR_ZERO = 0.5


def knots_of(segment: Segment, branch_points: list[Found]) -> list[float]:
    """Ends of the segment, and extrema of stability measures at which a sign changes unseen by the ends.

    A branch point splits the search: there a measure may touch zero without passing it.
    """
    ends = [(0.0, segment.a), *[(f.theta, f.sample) for f in branch_points], (1.0, segment.b)]
    knots = [0.0, 1.0]
    for (low, a), (high, b) in pairwise(ends):
        for which in _suspects(a, b, (high - low) * segment.length):
            extremum = _hidden_extremum(segment, which, (low, a), (high, b))
            if extremum is not None:
                knots.append(extremum)
    return sorted(set(knots))


def _suspects(a: Sample, b: Sample, length: float) -> Iterable[int]:
    """Measures with the same sign at both ends whose cubic interpolation comes near zero in between."""
    ma, mb = a.measures, b.measures
    da, db = a.rates * length, b.rates * length
    certain = (np.abs(ma) > a.errors) & (np.abs(mb) > b.errors)
    usable = certain & (ma * mb > 0) & np.isfinite(da) & np.isfinite(db)
    sign = np.sign(ma)
    # towards zero at the one end, away from it at the other: an extremum lies between
    turning = usable & (sign * da < 0) & (sign * db > 0)
    for which in np.flatnonzero(turning):
        lowest = _cubic_extremum(ma[which], mb[which], da[which], db[which], sign[which])
        if lowest < NEAR_ZERO * min(abs(ma[which]), abs(mb[which])):
            yield int(which)


def _cubic_extremum(ma: float, mb: float, da: float, db: float, sign: float) -> float:
    """Least value of sign * (cubic Hermite interpolation) on 0..1."""
    t = np.linspace(0.0, 1.0, 33)
    r = 1.0 - t
    values = ma * r * r * (1 + 2 * t) + mb * t * t * (3 - 2 * t) + da * t * r * r - db * t * t * r
    return float((sign * values).min())


def _hidden_extremum(
    segment: Segment, which: int, low: tuple[float, Sample], high: tuple[float, Sample]
) -> float | None:
    """Position at which measure `which` has the other sign than at the ends, if there is one."""
    sign = np.sign(low[1].measures[which])

    def rate(sample: Sample) -> float:
        value = float(sample.rates[which])
        return value if np.isfinite(value) else 0.0

    def attempt(theta: float, left: float, right: float) -> float | None:
        sample = segment.at(theta)
        beyond = sign * sample.measures[which] < -sample.errors[which]
        return theta if beyond else None

    ends = low[0], high[0], rate(low[1]), rate(high[1])
    return narrow(lambda t: rate(segment.at(t)), *ends, attempt, width=1e-9)
