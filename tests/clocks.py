"""A clock with two events whose order depends on a parameter, in closed form.

theta runs from 0 to 1. `first` happens at 0.4, `second` at b + k v; before, between and after them v' =
-v + f has four values of f. For `second` at 0.4 + d the motion of v is piecewise exponential, v has one
periodic motion, and b = 0.4 + d - k v there: so every orbit, of both orders, is known by d.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hybrid_runs import machine

from contwalk.system import System, Transition

FIRST = 0.4


@dataclass(frozen=True)
class Clock:
    """`pushes`: f before both events, between them after `first`, after `second`, and after both."""

    pushes: tuple[float, float, float, float]
    k: float = 0.0

    def system(self, *watched: Transition, **rest: Any) -> System:
        """The plugin."""

        def field(f: float) -> Callable[..., None]:
            def rate(t: Any, x: Any, p: Any, dx: Any) -> None:
                dx[0] = 1.0
                dx[1] = f - x[1]

            return rate

        def again(t: Any, x: Any, p: Any, after: Any) -> None:
            after[0] = 0.0 * x[0]
            after[1] = x[1]

        def first(t: Any, x: Any, p: Any) -> Any:
            return FIRST - x[0]

        def second(t: Any, x: Any, p: Any) -> Any:
            return p.b + self.k * x[1] - x[0]

        names = ("neither", "after_first", "after_second", "both")
        return machine(
            ["theta", "v"],
            {"b": 0.6},
            {name: field(f) for name, f in zip(names, self.pushes, strict=True)},
            [
                Transition("first", "neither", "after_first", first),
                Transition("second", "neither", "after_second", second),
                Transition("second_later", "after_first", "both", second),
                Transition("first_later", "after_second", "both", first),
                Transition("again", "both", "neither", lambda t, x, p: 1.0 - x[0], reset=again),
                *watched,
            ],
            **rest,
        )

    def pieces(self, d: float) -> list[tuple[float, float]]:
        """Durations and pushes, from theta = 0 on."""
        before, one, other, both = self.pushes
        middle = one if d >= 0.0 else other
        low, high = sorted((FIRST, FIRST + d))
        return [(low, before), (high - low, middle), (1.0 - high, both)]

    def at_zero(self, d: float) -> float:
        """v where theta is 0."""
        factor, offset = 1.0, 0.0
        for lasting, push in self.pieces(d):
            kept = math.exp(-lasting)
            factor, offset = factor * kept, offset * kept + push * (1.0 - kept)
        return offset / (1.0 - factor)

    def at(self, d: float, theta: float) -> float:
        """v at an angle."""
        v, left = self.at_zero(d), theta
        for lasting, push in self.pieces(d):
            part = min(lasting, left)
            v, left = push + (v - push) * math.exp(-part), left - part
        return v

    def parameter(self, d: float) -> float:
        """b."""
        return FIRST + d - self.k * self.at(d, FIRST + d)

    def slope(self, d: float, h: float = 1e-3) -> float:
        """db/dd, by differences of sixth order on one side of zero (h of its sign there)."""
        values = [self.parameter(d + j * h) for j in range(7)]
        weights = (-147.0, 360.0, -450.0, 400.0, -225.0, 72.0, -10.0)
        return sum(w * v for w, v in zip(weights, values, strict=True)) / (60.0 * h)
