"""A compiled function at many instants, for numba: calls from Python take longer than it does."""

from __future__ import annotations

from contwalk.flow.compiled.calling import call_rhs, doubles


def each(function: int, count: int, times: int, states: int, n: int, constants: int, out: int, m: int) -> int:
    """`function(t, x, c, out)` at `count` instants: states of n entries to results of m."""
    at = doubles(times, count)
    for k in range(count):
        call_rhs(function, at[k], states + 8 * k * n, constants, out + 8 * k * m)
    return 0
