"""Margins that pass zero and come back between two solutions: a distance that is least in between."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample

# Displacement along the branch, in the metric, for the rate of a margin: the root of what it is known to.
BESIDE = 1e-4
# A dip is looked at when it comes this much nearer to zero than the ends; a half is 16 times as well known.
NEAR_ZERO, HALVINGS = 0.5, 6


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
        place = _dip(segment, which, (0.0, segment.a), (1.0, segment.b), rounded)
        if place is not None:
            yield place


def _dip(
    segment: Segment,
    which: int,
    low: tuple[float, Sample],
    high: tuple[float, Sample],
    rounded: float,
    halvings: int = HALVINGS,
) -> float | None:
    """Where between two solutions a margin of one sign at both has the other one."""
    (begin, a), (end, b) = low, high
    ma, mb = float(a.margins[which]), float(b.margins[which])
    if halvings == 0 or not ma * mb > 0.0:
        return None
    length, sign = (end - begin) * segment.length, np.sign(ma)
    da = length * _rate(segment, a, which)
    if not sign * da < 0.0:
        return None
    db = length * _rate(segment, b, which)
    if not sign * db > 0.0:
        return None
    place = _lowest(sign * ma, sign * mb, sign * da, sign * db)
    if place is None:
        return None
    theta = begin + place * (end - begin)
    middle = theta, segment.at(theta)
    found = float(middle[1].margins[which])
    if found * sign < -rounded:
        return theta
    first = _dip(segment, which, low, middle, rounded, halvings - 1)
    return _dip(segment, which, middle, high, rounded, halvings - 1) if first is None else first


def _rate(segment: Segment, sample: Sample, which: int) -> float:
    """Derivative of a margin by arclength; NaN where it has no value beside a solution."""
    limited = segment.problem.limited
    assert limited is not None
    beside = limited.margins(sample.z + BESIDE * sample.tangent, sample.weights)
    return float(beside[which] - sample.margins[which]) / BESIDE


def _lowest(fa: float, fb: float, da: float, db: float) -> float | None:
    """Where on 0..1 the cubic with these values and rates is least, if it is near zero there."""
    a, b, c = 3.0 * (da + db - 2.0 * (fb - fa)), 2.0 * (3.0 * (fb - fa) - 2.0 * da - db), da
    inside = max(b * b - 4.0 * a * c, 0.0)  # positive: the cubic falls at the one end and grows at the other
    t = 2.0 * c / (-b - np.sqrt(inside)) if b > 0.0 else (-b + np.sqrt(inside)) / (2.0 * a)
    if not 0.0 < t < 1.0:
        return None
    r = 1.0 - t
    least = fa * r * r * (1 + 2 * t) + fb * t * t * (3 - 2 * t) + da * t * r * r - db * t * t * r
    return float(t) if least < NEAR_ZERO * min(fa, fb) else None
