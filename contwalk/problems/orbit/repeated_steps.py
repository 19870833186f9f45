"""Steps that repeat themselves over a closure.

An orbit that was born at a period doubling meets itself half a period later at its birth, and one that lost a
symmetry meets its image. On steps that are the same in both halves the equations keep that symmetry to
rounding, and the pitchfork at which the orbit was born, or falls back onto its parent, stays one. On other
steps their errors unfold it, and a walk would turn off onto the wrong branch.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from contwalk.numerics.distinct import distinct

# Times of a later part are rounded at the size of the closure: much nearer ones could become one there, a
# step without length.
APART = 1e-12


def repeating(steps: Sequence[np.ndarray], parts: int) -> tuple[np.ndarray, ...]:
    """Steps that are alike in all parts of the closure, nowhere longer than those given.

    Parameters
    ----------
    steps : sequence of ndarray
        Times in 0..1 of each segment's steps, its ends included.
    parts : int
    """
    times = distinct(np.concatenate(steps))
    density = 1.0 / np.diff(times)
    bounds = np.array([own[0] for own in steps] + [1.0])
    ends = distinct(np.round(np.concatenate([bounds * parts % 1.0, [0.0, 1.0]]), 12)) / parts
    part = _even(times, density, ends, parts)
    part = np.append(part, ends[-1])
    whole = np.concatenate([part[:-1] + p / parts for p in range(parts)])
    result = []
    for begin, end in pairwise(bounds):
        inside = whole[(whole > begin + 0.5 * APART) & (whole < end - 0.5 * APART)]
        result.append(np.concatenate([[begin], inside, [end]]))
    return tuple(result)


def _apart(times: np.ndarray) -> np.ndarray:
    """Times without those that are hardly later than the one before, or earlier than the last."""
    inside = times[1:-1][(np.diff(times)[:-1] > APART) & (times[-1] - times[1:-1] > APART)]
    return np.append(times[:1], inside)


def _even(times: np.ndarray, density: np.ndarray, ends: np.ndarray, parts: int) -> np.ndarray:
    """Times of the first part but for its end, as dense as the densest of all parts between any two `ends`.

    The ends are those of all parts' segments, as seen from the starts of the parts.
    """
    places = np.concatenate([times - p / parts for p in range(parts)])
    knots = distinct(np.concatenate([ends, places[(places > 0.0) & (places < ends[-1])]]))
    middle = 0.5 * (knots[1:] + knots[:-1])
    every = [
        density[np.minimum(np.maximum(times.searchsorted(middle + p / parts) - 1, 0), len(density) - 1)]
        for p in range(parts)
    ]
    counts = np.maximum.reduce(every) * (knots[1:] - knots[:-1])
    found = []
    for a, b in pairwise(knots.searchsorted(ends).tolist()):
        count = np.concatenate([[0.0], np.cumsum(counts[a:b])])
        number = max(int(np.ceil(count[-1] - 1e-9)), 1)
        own = np.interp(np.arange(number) * count[-1] / number, count, knots[a : b + 1])
        found.append(_apart(np.append(own, knots[b])))
    return np.concatenate(found)
