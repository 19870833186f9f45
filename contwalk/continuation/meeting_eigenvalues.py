"""Eigenvalues that meet between two solutions, and may be critical there though flat at both ends.

Two eigenvalues that run into each other leave at a right angle: their real parts, or moduli, tell nothing
before. Their mean and the square D of their difference are smooth all the way, and the values and rates of
both at the ends give cubics of these: mean +- sqrt(D) / 2 is what the two are in between.

Source: A. P. Seyranian, A. A. Mailybaev, Multiparameter Stability Theory with Mechanical Applications, World
Scientific 2003, section 2.8.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.continuation.segment import Segment
from contwalk.problems.problem import Sample

# A peak is looked at when it comes this much nearer to zero than the ends.
NEAR_ZERO = 0.5
# Where D bends by less than this part of what it is its root does not, to the same part.
STRAIGHT = 0.05
# Places at which cubics are asked, and how often a part is halved: each time they are 16 times as good.
PLACES, HALVINGS = np.linspace(0.0, 1.0, 33), 6


def peaks(
    segment: Segment, low: tuple[float, Sample], high: tuple[float, Sample], halvings: int = HALVINGS
) -> Iterator[float]:
    """Places between two solutions with as many unstable eigenvalues, at which they are more or fewer.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    (begin, a), (end, b) = low, high
    if a.unstable != b.unstable or halvings == 0:
        return
    place = _place(a, b, (end - begin) * segment.length)
    if place is None:
        return
    theta = begin + place * (end - begin)
    middle = theta, segment.at(theta)
    if middle[1].unstable != a.unstable:
        yield theta
        return
    yield from peaks(segment, low, middle, halvings - 1)
    yield from peaks(segment, middle, high, halvings - 1)


def _place(a: Sample, b: Sample, length: float) -> float | None:
    """Where between two solutions a length apart two eigenvalues come nearest to critical, in parts of it.

    None where no two that meet do come nearer than at the ends, or where no rates of all are known.
    """
    rates = a.rates.of_values, b.rates.of_values
    if rates[0] is None or rates[1] is None or a.still or b.still:
        return None
    if not 2 <= len(a.eigenvalues) == len(b.eigenvalues):
        return None
    va, vb = (length * np.nan_to_num(each, posinf=0.0, neginf=0.0) for each in (rates[0], rates[1]))
    order = _same(a.eigenvalues, b.eigenvalues, va, vb)
    values, moved = (a.eigenvalues, b.eigenvalues[order]), (va, vb[order])
    first, second = np.triu_indices(len(order), 1)
    apart = [each[first] - each[second] for each in values]
    squares = [each * each for each in apart]
    bends = [2.0 * each * (own[first] - own[second]) for each, own in zip(apart, moved, strict=True)]
    # Where D is nearly straight between the ends no two meet.
    chord = squares[1] - squares[0]
    off = np.maximum(np.abs(bends[0] - chord), np.abs(bends[1] - chord))
    meet = off > STRAIGHT * np.minimum(np.abs(squares[0]), np.abs(squares[1]))
    if not meet.any():
        return None
    measures = np.array([a.measures, b.measures[order]])
    certain = np.abs(measures) > np.array([a.errors, b.errors[order]])
    signs = np.where(certain.all(axis=0) & (measures[0] * measures[1] > 0.0), np.sign(measures[0]), 0.0)
    kept = meet & (signs[first] * signs[second] > 0.0)
    first, second = first[kept], second[kept]
    if not len(first):
        return None
    least = np.abs(measures[:, np.stack([first, second])]).min(axis=(0, 1))
    sums = [0.5 * (each[first] + each[second]).real for each in (*values, *moved)]
    cubics = np.stack(sums, axis=1), np.stack([each[kept] for each in (*squares, *bends)], axis=1)
    places = np.hstack([np.tile(PLACES, (len(first), 1)), _turns(cubics[1])])
    nearest = _nearest(*cubics, signs[first], places) / least[:, None]
    which, place = np.unravel_index(int(np.argmin(nearest)), nearest.shape)
    found = float(places[which, place])
    return found if nearest[which, place] < NEAR_ZERO and 0.0 < found < 1.0 else None


def _nearest(mean: np.ndarray, square: np.ndarray, sign: np.ndarray, places: np.ndarray) -> np.ndarray:
    """What may be left to zero of the nearer one of two eigenvalues at places, both of shape (k, p).

    `mean` and `square` have values and rates at both ends of cubics, shape (k, 4); the sign is that of both
    at the ends, shape (k,). That D is a cubic is known to its last term: it is a parabola where two meet.
    """
    weights = _hermite(places)
    means = np.einsum("ki,ikp->kp", mean, weights)
    squares = np.einsum("ki,ikp->kp", square, weights)
    last = np.abs(square[:, 2] + square[:, 3] - 2.0 * (square[:, 1] - square[:, 0]))[:, None]
    real = np.sqrt(0.5 * (np.abs(squares) + squares.real) + places**2 * (1.0 - places) * last)
    return sign[:, None] * means - 0.5 * real


def _turns(square: np.ndarray) -> np.ndarray:
    """Where the real part of D turns on 0..1, shape (k, 2); 0 where it does not. As in `_nearest`."""
    fa, fb, da, db = square.real.T
    a, b, c = 3.0 * (da + db - 2.0 * (fb - fa)), 2.0 * (3.0 * (fb - fa) - 2.0 * da - db), da
    with np.errstate(all="ignore"):
        root = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        found = np.stack([root / a, c / root], axis=1)
    return np.where((found > 0.0) & (found < 1.0), found, 0.0)


def _same(a: np.ndarray, b: np.ndarray, va: np.ndarray, vb: np.ndarray) -> np.ndarray:
    """Which eigenvalue at the end each one at the beginning becomes, by values and rates, shape (n,)."""
    miss = np.abs(b - a[:, None] - 0.5 * (va[:, None] + vb))
    found = np.argmin(miss, axis=1)
    if len(np.unique(found)) == len(a):
        return found
    for _ in a:  # the surest first
        i, j = np.unravel_index(int(np.argmin(miss)), miss.shape)
        found[i] = j
        miss[i], miss[:, j] = np.inf, np.inf
    return found


def _hermite(t: np.ndarray) -> np.ndarray:
    """What values and rates at both ends make at places of shape (k, p), shape (4, k, p)."""
    r = 1.0 - t
    return np.stack([r * r * (1.0 + 2.0 * t), t * t * (3.0 - 2.0 * t), t * r * r, -t * t * r])
