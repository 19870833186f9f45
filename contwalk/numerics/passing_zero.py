"""Whether a function that is known at some places passes zero between them, comes near it, or has a pole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np

from contwalk.numerics.bracketing import UNSURE

# An extremum between places is looked for this often, each time in two thirds of where it lies.
NARROWER = 12
# An extremum is looked for where it may come this near to zero, against the values beside it.
NEAR_ZERO = 0.1
# The same where values are those beside solutions.
DOUBTFUL = 0.3
# A bracket of a change of sign is narrowed until both values are so many times the first ones, as at a pole,
# or one is below this part of the first one of its side; at the most so often, each time to such parts:
# halves would meet a pole in the middle, where there is no value.
NARROWINGS, GROWN, SHRUNK = 30, 100.0, 0.5
SHARES = (0.47, 0.55)

# Values by their places, which stand in their order.
Known = Mapping[float, float]


def is_pole(
    value: Callable[[float], float], places: tuple[float, float], values: tuple[float, float]
) -> bool:
    """Whether a function changes its sign between two places because it has a pole there.

    The nearer to a pole, the larger it is; the nearer to a zero, the smaller. Where it has no value between
    two places, as right beside a pole, what it becomes on the way there tells.
    """
    (low, high), beside = places, list(values)
    for _ in range(NARROWINGS):
        if min(map(abs, beside)) > GROWN * max(map(abs, values)):
            return True
        tried = ((middle, value(middle)) for middle in (low + share * (high - low) for share in SHARES))
        middle, inside = next(((m, v) for m, v in tried if np.isfinite(v)), (low, float("nan")))
        if not np.isfinite(inside):
            aside = 0.5 * SHARES[0] * (high - low)
            ends = zip((value(low + aside), value(high - aside)), beside, values, strict=True)
            return all(max(abs(np.nan_to_num(v)), abs(known)) > abs(first) for v, known, first in ends)
        side = 0 if inside * beside[0] > 0.0 else 1
        if not abs(inside) > SHRUNK * abs(values[side]):
            return False
        beside[side] = inside
        low, high = (middle, high) if side == 0 else (low, middle)
    return False


def may_pass(known: Known) -> bool:
    """Whether values leave room for a zero between them, or beside one that comes near it."""
    values = list(known.values())
    alike = not np.any(np.isfinite(values)) or all(_alike(a, b) for a, b in pairwise(values))
    return not alike or bool(nearest_to_zero(known, DOUBTFUL))


def _alike(a: float, b: float) -> bool:
    """Whether two values leave no room for a zero between them: of one sign, or both smaller than errors."""
    return a * b > 0.0 or max(abs(a), abs(b)) <= UNSURE


def nearest_to_zero(known: Known, near: float = NEAR_ZERO) -> list[tuple[float, float, float]]:
    """Places, with those on both sides, beside which a function may pass zero twice: the parabola through
    three values comes near it.
    """
    places = list(known)
    triples = zip(places, places[1:], places[2:], strict=False)
    return [(a, b, c) for a, b, c in triples if _reaches(known[a], known[b], known[c], near)]


def _reaches(low: float, middle: float, high: float, near: float) -> bool:
    """Whether the parabola through three values of one sign has its extremum between them, near zero."""
    if not (low * middle > 0.0 and middle * high > 0.0):
        return False
    low, middle, high = abs(low), abs(middle), abs(high)
    slope, bend = 0.5 * (high - low), high - 2.0 * middle + low
    if not abs(slope) < bend:
        return False
    return middle - 0.5 * slope**2 / bend < near * min(low, high)


def extremum(
    value: Callable[[float], float], places: tuple[float, float, float], middle: float
) -> tuple[float, float]:
    """Where between two places a function comes nearest to zero, or beyond zero, and what it is there.

    `middle` is what it is at the place between them.
    """
    (low, theta, high), sign = places, 1.0 if middle > 0.0 else -1.0
    best = theta, middle
    for _ in range(NARROWER):
        thirds = [low + (high - low) / 3.0, high - (high - low) / 3.0]
        left, right = ((third, value(third)) for third in thirds)
        nearer = min(left, right, key=lambda found: sign * found[1])
        if sign * nearer[1] < sign * best[1]:
            best = nearer
        if not sign * nearer[1] > 0.0:
            break
        low, high = (low, thirds[1]) if nearer is left else (thirds[0], high)
    return best
