"""Eigenvalues that meet between two solutions, and may be critical there though flat at both ends.

Two eigenvalues that run into each other leave at a right angle: their real parts, or moduli, tell nothing
before. Their mean and the square D of their difference are smooth all the way, and the values and rates of
both at the ends give cubics of these: mean +- sqrt(D) / 2 is what the two are in between.

Source: A. P. Seyranian, A. A. Mailybaev, Multiparameter Stability Theory with Mechanical Applications, World
Scientific 2003, chapter 2.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from contwalk.continuation.segment import Placed, Segment
from contwalk.numerics import cubic
from contwalk.problems.problem import Sample

# Where D bends by less than this part of what it is its root does not, to the same part.
STRAIGHT = 0.05
# How often a part is halved: a cubic of values and rates at its ends is 16 times as good each time.
HALVINGS = 6
# Places at which cubics are asked.
PLACES = np.linspace(0.0, 1.0, 33)
# Numbers of the first and of the second of each pair of so many.
_pairs = cache(np.triu_indices)


def peaks(segment: Segment, low: Placed, high: Placed, halvings: int = HALVINGS) -> Iterator[float]:
    """Places between two solutions with as many unstable eigenvalues, at which they are more or fewer.

    Raises
    ------
    LostBranch
        If a solution there cannot be computed.
    """
    count = low[1].unstable
    if not halvings or high[1].unstable != count:
        return
    share = _place(low[1], high[1], (high[0] - low[0]) * segment.length)
    if share is None:
        return
    theta = low[0] + share * (high[0] - low[0])
    middle = theta, segment.at(theta)
    if middle[1].unstable != count:
        yield theta
        return
    yield from peaks(segment, low, middle, halvings - 1)
    yield from peaks(segment, middle, high, halvings - 1)


class _End(NamedTuple):
    """Eigenvalues at an end of a step, what they change by over it, measures, errors: each of shape (k,)."""

    values: np.ndarray
    moved: np.ndarray
    measures: np.ndarray
    errors: np.ndarray


@np.errstate(invalid="ignore", over="ignore")  # multipliers may be infinite
def _place(a: Sample, b: Sample, length: float) -> float | None:
    """Where between two solutions a length apart two eigenvalues come nearest to critical, in parts of it.

    None where no two that meet do come nearer than at the ends, or where no rates are known.
    """
    ends = _followed(a, b, length)
    if ends is None:
        return None
    order = _same(ends[0].values, ends[1].values, ends[0].moved, ends[1].moved)
    ends = ends[0], _End(*(each[order] for each in ends[1]))
    first, second = _pairs(len(order), 1)
    apart = [end.values[first] - end.values[second] for end in ends]
    squares = [each * each for each in apart]
    bends = [2.0 * d * (end.moved[first] - end.moved[second]) for d, end in zip(apart, ends, strict=True)]
    # Where D is nearly straight between the ends no two meet.
    chord = squares[1] - squares[0]
    off = np.maximum(np.abs(bends[0] - chord), np.abs(bends[1] - chord))
    meet = off > STRAIGHT * np.minimum(np.abs(squares[0]), np.abs(squares[1]))
    if not meet.any():
        return None
    measures = np.array([end.measures for end in ends])
    certain = np.abs(measures) > np.array([end.errors for end in ends])
    signs = np.where(certain.all(axis=0) & (measures[0] * measures[1] > 0.0), np.sign(measures[0]), 0.0)
    kept = meet & (signs[first] * signs[second] > 0.0)
    first, second = first[kept], second[kept]
    if not len(first):
        return None
    least = np.abs(measures[:, np.stack([first, second])]).min(axis=(0, 1))
    sums = [0.5 * (end.values[first] + end.values[second]) for end in ends]
    sums += [0.5 * (end.moved[first] + end.moved[second]) for end in ends]
    cubics = np.stack(sums, axis=1), np.stack([each[kept] for each in (*squares, *bends)], axis=1)
    places = np.hstack([np.tile(PLACES, (len(first), 1)), cubic.turns(cubics[1].real)])
    nearest = _nearest(*cubics, signs[first], places, a) / least[:, None]
    which, place = np.unravel_index(int(np.argmin(nearest)), nearest.shape)
    found = float(places[which, place])
    return found if nearest[which, place] < cubic.NEAR_ZERO and 0.0 < found < 1.0 else None


def _followed(a: Sample, b: Sample, length: float) -> tuple[_End, _End] | None:
    """All eigenvalues at both ends; where rates have their price those that meet, as one end tells."""
    if a.still or b.still or not 2 <= len(a.eigenvalues) == len(b.eigenvalues):
        return None
    if a.rates.values is not None:
        every = np.arange(len(a.eigenvalues))
        ends = _end(a, every, length), _end(b, every, length)
    else:
        # That end's rates are those that extrema are looked for by.
        turned = float(np.abs(b.measures).min()) < float(np.abs(a.measures).min())
        near, far, way = (b, a, -1.0) if turned else (a, b, 1.0)
        there = _end(near, np.flatnonzero(near.measures == near.beyond(near.eigenvalues)), length)
        if there is None or not len(which := _meeting(there, way, far.eigenvalues)):
            return None
        own = _End(*(each[which] for each in there))
        others = _same(own.values, far.eigenvalues, np.zeros(len(which)), np.zeros(1))
        ends = own, _end(far, others, length)
        ends = ends[::-1] if turned else ends
    return None if ends[0] is None or ends[1] is None else (ends[0], ends[1])


def _end(sample: Sample, which: np.ndarray, length: float) -> _End | None:
    """Eigenvalues of some numbers, shape (k,), at an end of a step; None where no rates are known."""
    rates = sample.rates.of_values(which)
    if rates is None:
        return None
    moved = np.where(np.isfinite(rates), length * rates, 0.0)
    return _End(sample.eigenvalues[which], moved, sample.measures[which], sample.errors[which])


def _meeting(end: _End, way: float, far: np.ndarray) -> np.ndarray:
    """Which eigenvalues may run into others within the step, as values and rates at one of its ends tell.

    The way into the step is 1 from its beginning, -1 from its end; those at the other have the shape (m,).

    D of two that do not meet goes on as it begins; of two that do, they may be critical if D lets them.
    """
    first, second = _pairs(len(end.values), 1)
    there = far[_same(end.values, far, np.zeros(len(end.values)), np.zeros(1))]
    apart, closing, beyond = (each[first] - each[second] for each in (end.values, end.moved, there))
    sizes, off = (np.abs(apart) ** 2, np.abs(beyond) ** 2), beyond**2 - apart**2 - 2.0 * way * apart * closing
    reach = np.sqrt(sum(sizes) + np.abs(off)) + np.abs(end.values - there)[first]
    near = np.abs(end.measures)[[first, second]].min(axis=0, initial=np.inf) < reach
    meet = near & (np.abs(off) > STRAIGHT * np.minimum(*sizes))
    return np.unique([first[meet], second[meet]])


def _nearest(
    mean: np.ndarray, square: np.ndarray, sign: np.ndarray, places: np.ndarray, sample: Sample
) -> np.ndarray:
    """What may be left to critical of the nearer one of two eigenvalues at places, both of shape (k, p).

    `mean` and `square` have values and rates at both ends of cubics, shape (k, 4); the sign is that of both
    at the ends, shape (k,). That D is a cubic is known to its last term: it is a parabola where two meet.
    """
    weights = cubic.weights(places)
    means = np.einsum("ki,ikp->kp", mean, weights)
    # The way in which an eigenvalue becomes critical, from their mean on.
    ahead = np.ones(1) if sample.critical == 0.0 else means / np.maximum(np.abs(means), 1e-300)
    squares = np.einsum("ki,ikp->kp", square, weights) / ahead**2
    last = np.abs(square[:, 2] + square[:, 3] - 2.0 * (square[:, 1] - square[:, 0]))[:, None]
    along = np.sqrt(0.5 * (np.abs(squares) + squares.real) + places**2 * (1.0 - places) * last)
    across = np.sqrt(0.5 * np.abs(np.abs(squares) - squares.real)) * np.where(squares.imag < 0.0, -1.0, 1.0)
    half = 0.5 * ahead * (along + 1j * across)
    return np.minimum(*(sign[:, None] * sample.beyond(means + each) for each in (half, -half)))


def _same(a: np.ndarray, b: np.ndarray, va: np.ndarray, vb: np.ndarray) -> np.ndarray:
    """Which eigenvalue at the end each one at the beginning becomes, by values and rates, shape (k,)."""
    miss = np.abs(b - a[:, None] - 0.5 * (va[:, None] + vb))
    found = np.argmin(miss, axis=1)
    if len(set(found.tolist())) == len(a):
        return found
    for _ in a:  # the surest first
        i, j = np.unravel_index(int(np.argmin(miss)), miss.shape)
        found[i] = j
        miss[i], miss[:, j] = np.inf, np.inf
    return found
