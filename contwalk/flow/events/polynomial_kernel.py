"""The polynomial of a step of order 8 with its derivative, and the sign of a value just after an instant."""

from __future__ import annotations

from typing import Any

from contwalk.flow.compiled.calling import inlined


@inlined
def side_of(value: float, rate: float) -> float:
    """The sign just after an instant."""
    at = value if value != 0.0 else rate
    return 1.0 if at > 0.0 else -1.0


@inlined
def draw(n: int, rows: Any, y: Any, h: float, share: float, x: Any, f: Any) -> None:
    """State and velocity at a share of a step of length h from y, written into `x` and `f`.

    `rows`, 7 n numbers, are the polynomial's coefficients.
    """
    for i in range(n):
        value, slope = 0.0, 0.0
        for row in range(7):
            value += rows[(6 - row) * n + i]
            if row % 2 == 0:
                slope = slope * share + value
                value *= share
            else:
                slope = slope * (1.0 - share) - value
                value *= 1.0 - share
        x[i], f[i] = y[i] + value, slope / h
