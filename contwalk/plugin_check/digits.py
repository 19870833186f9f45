"""Numbers in messages: with as many digits as tell them apart, and periods that were typed with too few."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

FEWEST, ALL = 6, 17
# A number is meant to be a multiple of pi if it is one to this part of itself, with so large a denominator.
MEANT, LARGEST = 5e-3, 12


def told_apart(one: float, other: float) -> tuple[str, str]:
    """Two numbers with six digits, or with as many more as it takes to see that they differ."""
    for digits in range(FEWEST, ALL + 1):
        found = f"{one:.{digits}g}", f"{other:.{digits}g}"
        if found[0] != found[1]:
            break
    return found


def meant_with_pi(period: float, holds: Callable[[float], bool]) -> str:
    """How a period is written that was typed as a decimal near it; empty if it is no multiple of pi.

    Parameters
    ----------
    period : float
    holds : callable
        Whether what is to repeat itself does so after another period.
    """
    share = Fraction(period / math.pi).limit_denominator(LARGEST)
    exact = float(share) * math.pi
    if not share or exact == period or abs(exact - period) > MEANT * period or not holds(exact):
        return ""
    above = "math.pi" if share.numerator == 1 else f"{share.numerator} * math.pi"
    return above if share.denominator == 1 else f"{above} / {share.denominator}"
