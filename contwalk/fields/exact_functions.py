"""Functions whose value for floats is exact, so that they may be applied to constants at once."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any


def sign(x: float) -> float:
    """-1, 0 or 1, NaN where x is."""
    return x if x != x else math.copysign(1.0, x) if x != 0.0 else 0.0


def minimum(a: Any, b: Any) -> Any:
    """The smaller number, the first of two that are equal; NaN where one is."""
    return b if b < a or b != b else a


def maximum(a: Any, b: Any) -> Any:
    """The larger number, the first of two that are equal; NaN where one is."""
    return b if b > a or b != b else a


EXACT: dict[str, Callable[..., float]] = {
    "abs": abs,
    "sign": sign,
    "floor": lambda x: float(math.floor(x)),
    "trunc": lambda x: float(math.trunc(x)),
    "min": minimum,
    "max": maximum,
}
