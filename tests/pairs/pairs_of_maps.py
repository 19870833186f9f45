"""Maps by a clock with two crossings a drawn distance apart: their multipliers are given outright."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from pairs_form import FREE, Case, Crossing, Draw

from contwalk.system import Mode, Parameter, State, System, Transition

# What becomes of some states in a round: of them and of the part of the range.
Map = Callable[[Sequence[Any], Any], list[Any]]
Growth = Callable[[Any], Any]


def _case(draw: Draw, maps: Sequence[tuple[Map, int]], crossings: Sequence[Crossing]) -> Case:
    size = sum(count for _, count in maps)
    frame = draw.frame(size)

    def wait(t: Any, x: Any, p: Any, dx: Any) -> None:
        for k in range(size):
            dx[k] = 0.0
        dx[size] = 1.0

    def step(t: Any, x: Any, p: Any, after: Any) -> None:
        q = draw.part(p.lam)

        def moved(y: list[Any], lam: Any) -> list[Any]:
            found, at = [], 0
            for each, count in maps:
                found += each(y[at : at + count], q)
                at += count
            return found

        frame.field(moved)(t, x, p, after)
        for k in range(size):
            after[k] = after[k] + float(frame.shift[k])
        after[size] = 0.0

    start = draw.start
    system = System(
        "pairs",
        states=(*(State(f"x{i}", scale=float(s)) for i, s in enumerate(frame.scales)), State("c")),
        parameters=(Parameter(FREE, start),),
        modes=(Mode("wait", wait),),
        transitions=(
            Transition("tick", "wait", "wait", lambda t, x, p: 1.0 - x[size], "falling", reset=step),
        ),
    )
    place = [*frame.shift, 0.0]
    return Case(
        draw.kind,
        draw.seed,
        system,
        place,
        start,
        draw.range,
        draw.distance,
        tuple(crossings),
        machine={"mode": "wait", "until": 0.0},
    )


def _scalar(draw: Draw, growth: Growth, at: float = 1.0) -> tuple[Map, int]:
    """One state, with the multiplier at * (1 + growth)."""
    return (lambda u, q: [at * ((1.0 + growth(q)) * u[0] - u[0] ** 3)]), 1


def _flipped(draw: Draw, growth: Growth) -> tuple[Map, int]:
    """One state, with the multiplier -(1 + growth)."""
    return _scalar(draw, growth, -1.0)


def _turning(draw: Draw, growth: Growth) -> tuple[Map, int]:
    """Two states that turn by an angle, away from 1/1 to 1/4 of a turn."""
    angle = 2.0 * math.pi * float(draw.rng.choice([0.13, 0.2, 0.29, 0.4]))
    cos, sin = math.cos(angle), math.sin(angle)

    def each(u: Sequence[Any], q: Any) -> list[Any]:
        size = 1.0 + growth(q) - u[0] ** 2 - u[1] ** 2
        return [size * (cos * u[0] - sin * u[1]), size * (sin * u[0] + cos * u[1])]

    return each, 2


def _others(draw: Draw) -> list[tuple[Map, int]]:
    """States beside those of interest, one to three, each with a multiplier beyond 1 or within it."""
    chosen = draw.rng.choice([-3.0, -0.5, 0.3, 0.7, 2.0, 5.0], draw.rng.integers(1, 4), replace=False)

    def each(multiplier: float) -> Map:
        return lambda u, q: [multiplier * u[0]]

    return [(each(float(multiplier)), 1) for multiplier in chosen]


def _dipping(made: Callable[[Draw, Growth], tuple[Map, int]], label: str) -> Callable[[Draw], Case]:
    """A multiplier, or a pair, that passes the unit circle and returns."""

    def case(draw: Draw) -> Case:
        dip = draw.dip()
        return _case(draw, [*_others(draw), made(draw, lambda q: 0.5 * dip(q))], draw.beside(label))

    return case


def _passing(
    one: Callable[[Draw, Growth], tuple[Map, int]],
    other: Callable[[Draw, Growth], tuple[Map, int]],
    labels: tuple[str, str],
) -> Callable[[Draw], Case]:
    """Two multipliers, or pairs, that pass the unit circle, each once."""

    def case(draw: Draw) -> Case:
        first, second = draw.two()
        return _case(
            draw,
            [
                *_others(draw),
                one(draw, lambda q: 0.2 * first(q)),
                other(draw, lambda q: 0.2 * second(q)),
            ],
            draw.beside(*labels),
        )

    return case


def _meeting(angles: Sequence[float], label: str) -> Callable[[Draw], Case]:
    """Two multipliers, or pairs, that run into each other, and are beyond the unit circle for a while.

    Outside of that window their modulus stands still, r: they solve m^2 - 2 t m + r^2 = 0, turned by an
    angle, and one of them is 1 where t is (1 + r^2) / 2.
    """

    def case(draw: Draw) -> Case:
        dip, angle = draw.dip(), float(draw.rng.choice(angles))
        within, part = 10.0 ** draw.rng.uniform(-3.0, -1.0), draw.rng.uniform(0.05, 0.3)
        square, way = float((1.0 - within) ** 2), float(draw.sign * part)
        cos, sin = math.cos(angle), math.sin(angle)

        def moved(u: Any, v: Any, q: Any) -> tuple[Any, Any]:
            return (1.0 + square + 2.0 * way * dip(q)) * u - square * v, u

        def real(u: Sequence[Any], q: Any) -> list[Any]:
            one, other = moved(u[0], u[1], q)
            return [cos * one - u[0] ** 3, cos * other - u[1] ** 3]

        def turning(u: Sequence[Any], q: Any) -> list[Any]:
            (a, c), (b, d) = moved(u[0], u[2], q), moved(u[1], u[3], q)
            cube = u[0] ** 2 + u[1] ** 2 + u[2] ** 2 + u[3] ** 2
            found = [cos * a - sin * b, sin * a + cos * b, cos * c - sin * d, sin * c + cos * d]
            return [each - cube * own for each, own in zip(found, u, strict=True)]

        own = (real, 2) if abs(sin) < 1e-9 else (turning, 4)
        return _case(draw, [*_others(draw), own], draw.beside(label))

    return case


ANGLES = [2.0 * math.pi * part for part in (0.13, 0.2, 0.29, 0.4)]

MAPS = {
    "maps BP BP of two that meet": _meeting([0.0], "BP"),
    "maps PD PD of two that meet": _meeting([math.pi], "PD"),
    "maps NS NS of two that meet": _meeting(ANGLES, "NS"),
    "maps BP BP": _dipping(_scalar, "BP"),
    "maps PD PD": _dipping(_flipped, "PD"),
    "maps NS NS": _dipping(_turning, "NS"),
    "maps PD PD of two multipliers": _passing(_flipped, _flipped, ("PD", "PD")),
    "maps BP PD": _passing(_scalar, _flipped, ("BP", "PD")),
    "maps PD NS": _passing(_flipped, _turning, ("PD", "NS")),
    "maps NS NS of two pairs": _passing(_turning, _turning, ("NS", "NS")),
}
DIPS = (
    "maps BP BP",
    "maps PD PD",
    "maps NS NS",
    "maps BP BP of two that meet",
    "maps PD PD of two that meet",
    "maps NS NS of two that meet",
)
