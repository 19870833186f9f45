"""The interpolating polynomial of a step of order 8, with its derivative, for numba."""

from __future__ import annotations

from typing import Any

from contwalk.flow.compiled.calling import inlined


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
