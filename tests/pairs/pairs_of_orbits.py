"""Cycles with two crossings a drawn distance apart: round a circle, with exponents that are given."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from pairs_form import FREE, Case, Crossing, Draw, fold_half

from contwalk.system import Mode, Parameter, State, System

# The field of some transverse states: of them, cos and sin of the phase, and the part of the range.
Across = Callable[[Sequence[Any], Any, Any, Any], list[Any]]
Growth = Callable[[Any], Any]


def _case(
    draw: Draw,
    radial: Callable[[Any, Any], Any],
    across: Sequence[tuple[Across, int]],
    crossings: Sequence[Crossing],
    start: tuple[float, float],
    by_radius: bool = False,
) -> Case:
    """The case of r' = r radial(r^2 - 1, q), phi' = 1, and of the states across; `start` is lam and r^2 - 1.

    Growths across are functions of q, or `by_radius` of r^2 - 1.
    """
    size = 2 + sum(count for _, count in across)
    frame = draw.frame(size)

    def rates(y: list[Any], lam: Any) -> list[Any]:
        q, square = draw.part(lam), y[0] ** 2 + y[1] ** 2
        growth, radius = radial(square - 1.0, q), square**0.5
        found = [growth * y[0] - y[1], y[0] + growth * y[1]]
        at = 2
        for part, count in across:
            found += part(y[at : at + count], y[0] / radius, y[1] / radius, square - 1.0 if by_radius else q)
            at += count
        return found

    system = System(
        "pairs",
        states=tuple(State(f"x{i}", scale=float(s)) for i, s in enumerate(frame.scales)),
        parameters=(Parameter(FREE, start[0]),),
        modes=(Mode("only", frame.field(rates)),),
    )
    place = frame.outside([math.sqrt(1.0 + start[1]), *[0.0] * (size - 1)])
    return Case(
        draw.kind,
        draw.seed,
        system,
        place,
        start[0],
        draw.range,
        draw.distance,
        tuple(crossings),
        period=2.0 * math.pi,
    )


def _even(square: Any, q: Any) -> Any:
    """How the radius returns to 1 in the same way for all parameters."""
    return -0.15 * square


def _grown(draw: Draw, growth: Growth) -> Callable[[Any, Any], Any]:
    """The growth of a multiplier's logarithm in a round, uneven along it."""
    uneven = float(draw.rng.uniform(-0.5, 0.5))
    return lambda cos, q: growth(q) * (1.0 + uneven * cos) / (2.0 * math.pi)


def _scalar(draw: Draw, growth: Growth) -> tuple[Across, int]:
    """One state, with the multiplier exp(growth)."""
    grown = _grown(draw, growth)
    return (lambda u, cos, sin, q: [grown(cos, q) * u[0] - u[0] ** 3]), 1


def _doubled(draw: Draw, growth: Growth) -> tuple[Across, int]:
    """Two states in a frame that makes half a turn a round, with the multipliers -exp(growth), -exp(-pi)."""
    grown = _grown(draw, growth)

    def across(u: Sequence[Any], cos: Any, sin: Any, q: Any) -> list[Any]:
        first = 0.5 * ((1.0 + cos) * u[0] + sin * u[1])
        second = 0.5 * (sin * u[0] + (1.0 - cos) * u[1])
        a = grown(cos, q) - first * first - second * second
        return [
            a * first - 0.5 * (u[0] - first) - 0.5 * u[1],
            a * second - 0.5 * (u[1] - second) + 0.5 * u[0],
        ]

    return across, 2


def _turning(draw: Draw, growth: Growth) -> tuple[Across, int]:
    """Two states that turn by an angle a round, away from 1/1 to 1/4 of a turn."""
    grown, turn = _grown(draw, growth), float(draw.rng.choice([0.13, 0.2, 0.29, 0.4]))

    def across(u: Sequence[Any], cos: Any, sin: Any, q: Any) -> list[Any]:
        a = grown(cos, q) - u[0] ** 2 - u[1] ** 2
        return [a * u[0] - turn * u[1], turn * u[0] + a * u[1]]

    return across, 2


def _unstable(draw: Draw) -> list[tuple[Across, int]]:
    """States beside those of interest, none to two, each with a multiplier beyond 1 or within it."""
    rates = draw.rng.choice([-0.25, -0.1, 0.1, 0.2], draw.rng.integers(0, 3), replace=False)

    def across(rate: float) -> Across:
        return lambda u, cos, sin, q: [rate * u[0] - u[0] ** 3]

    return [(across(float(rate)), 1) for rate in rates]


def _dipping(made: Callable[[Draw, Growth], tuple[Across, int]], label: str) -> Callable[[Draw], Case]:
    """A multiplier, or a pair, that passes the unit circle and returns."""

    def case(draw: Draw) -> Case:
        across = [*_unstable(draw), made(draw, draw.dip())]
        return _case(draw, _even, across, draw.beside(label), (draw.start, 0.0))

    return case


def _passing(
    one: Callable[[Draw, Growth], tuple[Across, int]],
    other: Callable[[Draw, Growth], tuple[Across, int]],
    labels: tuple[str, str],
) -> Callable[[Draw], Case]:
    """Two multipliers, or pairs, that pass the unit circle, each once."""

    def case(draw: Draw) -> Case:
        first, second = draw.two()
        across = [*_unstable(draw), one(draw, first), other(draw, second)]
        return _case(draw, _even, across, draw.beside(*labels), (draw.start, 0.0))

    return case


def two_folds(draw: Draw) -> Case:
    """q = s^3 - b s with s = r^2 - 1: two folds of cycles that face each other; with b < 0 none."""
    b = fold_half(draw.distance) * (-1.0 if draw.near_miss else 1.0)
    draw.middle = min(max(draw.middle, 0.45), 0.55)  # all of it at radii that are not small
    rate = float(draw.sign) * 0.15

    def radial(square: Any, q: Any) -> Any:
        return rate * (q - square**3 + b * square)

    ends = [float(np.cbrt(-draw.middle)), float(np.cbrt(1.0 - draw.middle))]
    first = ends[int(draw.rng.integers(0, 2))] * 0.9
    begin = draw.place(first**3 - b * first)
    return _case(draw, radial, _unstable(draw), draw.beside("LP"), (begin, first))


def fold_beside_doubling(draw: Draw) -> Case:
    """Cycles q = s^2 with s = r^2 - 1, and a doubling at s = e, e^2 from their fold in q."""
    e = math.sqrt(draw.distance) * float(draw.sign)
    side, way, rate = (float(each) for each in draw.rng.choice([-1.0, 1.0], 3))
    slope = way * float(draw.rng.uniform(0.5, 2.0))

    def radial(square: Any, q: Any) -> Any:
        return 0.15 * rate * (side * q - square**2)

    across = [*_unstable(draw), _doubled(draw, lambda square: slope * (square - e))]
    first = math.sqrt(0.1) * float(draw.rng.choice([-1.0, 1.0]))
    found = Crossing("LP", draw.place(0.0)), Crossing("PD", draw.place(side * draw.distance))
    return _case(draw, radial, across, found, (draw.place(side * 0.1), first), by_radius=True)


ORBITS = {
    "cycles BP BP": _dipping(_scalar, "BP"),
    "cycles PD PD": _dipping(_doubled, "PD"),
    "cycles NS NS": _dipping(_turning, "NS"),
    "cycles PD NS": _passing(_doubled, _turning, ("PD", "NS")),
    "cycles PD PD of two multipliers": _passing(_doubled, _doubled, ("PD", "PD")),
    "cycles BP PD": _passing(_scalar, _doubled, ("BP", "PD")),
    "cycles LP LP": two_folds,
    "cycles LP PD": fold_beside_doubling,
}
DIPS = ("cycles BP BP", "cycles PD PD", "cycles NS NS", "cycles LP LP")
