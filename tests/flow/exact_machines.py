"""Hybrid motions in closed form, in numbers of any length: maps over events, and their exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

DIGITS = 50


@dataclass(frozen=True)
class ExactLeg:
    """A mode with its closed flow `flow(t, x, duration)`, the guard that ends it, and its reset.

    `near` is a guess of the duration.
    """

    flow: Callable[[Any, Sequence[Any], Any], list[Any]]
    guard: Callable[[Any, Sequence[Any]], Any]
    reset: Callable[[Any, Sequence[Any]], list[Any]]
    near: float


def at_events(legs: Sequence[ExactLeg], t0: Any, x0: Sequence[Any]) -> tuple[Any, list[Any]]:
    """Time of the last event and the state right after it."""
    t, x = mpmath.mpf(t0), [mpmath.mpf(v) for v in x0]
    for leg in legs:
        duration = mpmath.findroot(
            lambda d, leg=leg, t=t, x=x: leg.guard(t + d, leg.flow(t, x, d)), mpmath.mpf(leg.near)
        )
        x = leg.reset(t + duration, leg.flow(t, x, duration))
        t = t + duration
    return t, x


def exact_map(
    legs: Sequence[ExactLeg], last: Callable[..., list[Any]], t0: float, x0: Sequence[float]
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Time, state, monodromy (n, n) and derivative of the time after the events.

    `last` is the flow of the mode that the last event leads into: deviations are compared at one time.
    """
    with mpmath.workdps(DIGITS):
        end, state = at_events(legs, t0, x0)

        def later(x: Sequence[Any]) -> list[Any]:
            t, after = at_events(legs, t0, x)
            return [*last(t, after, end - t), t]

        columns = []
        for k in range(len(x0)):
            start = [mpmath.mpf(v) for v in x0]
            step = mpmath.mpf(10) ** (-DIGITS // 3)
            ahead, behind = list(start), list(start)
            ahead[k] += step
            behind[k] -= step
            pairs = zip(later(ahead), later(behind), strict=True)
            columns.append([float((a - b) / (2 * step)) for a, b in pairs])
        found = np.array(columns).T
        return float(end), np.array([float(v) for v in state]), found[:-1], found[-1]
