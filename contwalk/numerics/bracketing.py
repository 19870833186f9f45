"""Narrowing a bracket around a sign change: superlinear where smooth, never worse than bisection."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")

TINY = 1e-300
# A bracket that is this narrow is the zero.
NARROW = 1e-12

# What is told of a test function that is smaller than its error: this with its sign. Two such values tell no
# zero between them, for their product underflows; one of them beside a larger one tells it by its sign.
UNSURE = 1e-200


def narrow(
    value: Callable[[float], float],
    low: float,
    high: float,
    value_low: float,
    value_high: float,
    attempt: Callable[[float, float, float], T],
    width: float = 1e-13,
    most: int = 60,
) -> T | None:
    """Narrow a bracket until `attempt` succeeds.

    Parameters
    ----------
    value : callable
        A function of position with opposite signs at `low` and `high`, or exactly zero at one of them.
    attempt : callable
        `attempt(position, low, high)` is asked after every evaluation; the first result that is not None is
        returned.
    width : float
        Bracket width at which to give up.

    Notes
    -----
    Chandrupatla's rule (Adv. Eng. Softw. 28, 145, 1997): inverse quadratic interpolation where it is safe,
    else bisection.
    """
    a, fa, b, fb = high, value_high, low, value_low
    for end, zero in ((high, value_high == 0.0), (low, value_low == 0.0)):
        if zero and (found := attempt(end, low, high)) is not None:
            return found
    # A zero at an end has the sign that the function would have beyond it.
    fa, fb = fa or -math.copysign(TINY, fb), fb or -math.copysign(TINY, fa)
    c, fc = a, fa
    t = 0.5
    if fa != fb:
        t = min(max(fa / (fa - fb), 0.05), 0.95)  # the secant through the ends
    for _ in range(most):
        x = a + t * (b - a)
        fx = value(x)
        if (fx > 0) == (fa > 0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        found = attempt(x, min(a, b), max(a, b))
        if found is not None:
            return found
        if fx == 0.0 or abs(b - a) < width:
            return None
        t = 0.5
        if fb != fc and fa != fc and fb != fa:
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            # Products, which may be infinite: powers of floats that overflow raise.
            if phi * phi < xi and (1 - phi) * (1 - phi) < 1 - xi:
                t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        margin = max(width / abs(b - a), 1e-9) if b != a else 0.5
        t = min(max(t, margin), 1.0 - margin)
    return None


def zero_of(value: Callable[[float], float], low: float, high: float) -> float | None:
    """Where a function of the position passes zero, to rounding; None where it does not."""

    def attempt(theta: float, left: float, right: float) -> float | None:
        return theta if right - left < NARROW or value(theta) == 0.0 else None

    ends = value(low), value(high)
    if not ends[0] * ends[1] < 0.0:
        return None
    return narrow(value, low, high, *ends, attempt, width=0.0)
