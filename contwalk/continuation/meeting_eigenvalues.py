"""Eigenvalues that meet between two solutions, and may be critical there though flat at both ends.

Two eigenvalues that run into each other leave at a right angle: their real parts, or moduli, tell nothing
before. Their mean and the square D of their difference are smooth all the way, and the values and rates of
both at the ends give cubics of these: mean +- sqrt(D) / 2 is what the two are in between.

Source: A. P. Seyranian, A. A. Mailybaev, Multiparameter Stability Theory with Mechanical Applications, World
Scientific 2003, chapter 2.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.continuation.halving import NEAR_ZERO, Placed, looked_for
from contwalk.continuation.segment import Segment
from contwalk.numerics import cubic
from contwalk.problems.problem import Sample

# Where D bends by less than this part of what it is its root does not, to the same part.
STRAIGHT = 0.05
# Places at which cubics are asked.
PLACES = np.linspace(0.0, 1.0, 33)


def peaks(segment: Segment, low: Placed, high: Placed) -> Iterator[float]:
    """Places between two solutions with as many unstable eigenvalues, at which they are more or fewer.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    count = low[1].unstable

    def place(before: Placed, behind: Placed) -> float | None:
        if not before[1].unstable == behind[1].unstable == count:
            return None
        return _place(before[1], behind[1], (behind[0] - before[0]) * segment.length)

    return looked_for(segment, low, high, place, lambda sample: sample.unstable != count)


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
    places = np.hstack([np.tile(PLACES, (len(first), 1)), cubic.turns(cubics[1].real)])
    nearest = _nearest(*cubics, signs[first], places) / least[:, None]
    which, place = np.unravel_index(int(np.argmin(nearest)), nearest.shape)
    found = float(places[which, place])
    return found if nearest[which, place] < NEAR_ZERO and 0.0 < found < 1.0 else None


def _nearest(mean: np.ndarray, square: np.ndarray, sign: np.ndarray, places: np.ndarray) -> np.ndarray:
    """What may be left to zero of the nearer one of two eigenvalues at places, both of shape (k, p).

    `mean` and `square` have values and rates at both ends of cubics, shape (k, 4); the sign is that of both
    at the ends, shape (k,). That D is a cubic is known to its last term: it is a parabola where two meet.
    """
    weights = cubic.weights(places)
    means = np.einsum("ki,ikp->kp", mean, weights)
    squares = np.einsum("ki,ikp->kp", square, weights)
    last = np.abs(square[:, 2] + square[:, 3] - 2.0 * (square[:, 1] - square[:, 0]))[:, None]
    real = np.sqrt(0.5 * (np.abs(squares) + squares.real) + places**2 * (1.0 - places) * last)
    return sign[:, None] * means - 0.5 * real


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
