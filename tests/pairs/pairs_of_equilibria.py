"""Equilibria with two crossings a drawn distance apart."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pairs_form import FREE, Case, Crossing, Draw, fold_half

from contwalk.system import Mode, Observable, Parameter, State, System

Rates = Callable[[list[Any], Any], Sequence[Any]]


def _case(
    draw: Draw,
    rates: Rates,
    y: Sequence[float],
    crossings: Sequence[Crossing],
    start: float,
    observed: Callable[[list[Any]], Any] | None = None,
) -> Case:
    """The case of rates of the closed form's states, and of an equilibrium at the start.

    `observed` is the observable `value`, of the closed form's states.
    """
    frame = draw.frame(len(y))
    observables: tuple[Observable, ...] = ()
    if observed is not None:
        observables = (Observable("value", lambda t, x, p: observed(frame.inside(x[0]))),)
    system = System(
        "pairs",
        states=tuple(State(f"x{i}", scale=float(s)) for i, s in enumerate(frame.scales)),
        parameters=(Parameter(FREE, start),),
        modes=(Mode("only", frame.field(rates)),),
        observables=observables,
    )
    place = frame.outside(y)
    return Case(draw.kind, draw.seed, system, place, start, draw.range, draw.distance, tuple(crossings))


def _others(draw: Draw) -> list[float]:
    """Rates of stable states beside those of interest, none to three."""
    return [-float(rate) for rate in draw.rng.uniform(0.3, 3.0, draw.rng.integers(0, 4))]


def _still(draw: Draw, own: Callable[[list[Any], Any], list[Any]], size: int, crossings: Any) -> Case:
    """An equilibrium at zero for all parameters, with other states that are fed by those of interest."""
    others = _others(draw)
    fed = draw.rng.uniform(-1.0, 1.0, len(others))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        rest = [r * v + float(f) * y[0] for r, v, f in zip(others, y[size:], fed, strict=True)]
        return [*own(y, draw.part(lam)), *rest]

    return _case(draw, rates, [0.0] * (size + len(others)), crossings, draw.start)


def two_branch_points(draw: Draw) -> Case:
    """One real eigenvalue dips beyond zero and returns."""
    dip = draw.dip()
    return _still(draw, lambda y, q: [dip(q) * y[0] - y[0] ** 3], 1, draw.beside("BP"))


def two_hopf_points(draw: Draw) -> Case:
    """The real part of one pair dips beyond zero and returns."""
    dip, speed = draw.dip(), float(draw.rng.uniform(0.5, 3.0))

    def own(y: list[Any], q: Any) -> list[Any]:
        growth = dip(q) - y[0] ** 2 - y[1] ** 2
        return [growth * y[0] - speed * y[1], speed * y[0] + growth * y[1]]

    return _still(draw, own, 2, draw.beside("HB"))


def two_real_eigenvalues(draw: Draw) -> Case:
    """Two real eigenvalues pass zero, each once, both the same way or one up and one down."""
    first, second = draw.two()
    return _still(
        draw,
        lambda y, q: [first(q) * y[0] - y[0] ** 3, second(q) * y[1] - y[1] ** 3],
        2,
        draw.beside("BP"),
    )


def two_pairs(draw: Draw) -> Case:
    """Two pairs pass the imaginary axis, each once."""
    first, second = draw.two()
    speeds = [float(s) for s in draw.rng.uniform(0.5, 3.0, 2)]

    def own(y: list[Any], q: Any) -> list[Any]:
        rates: list[Any] = []
        for growth, speed, (a, b) in zip((first, second), speeds, (y[:2], y[2:4]), strict=True):
            g = growth(q) - a * a - b * b
            rates += [g * a - speed * b, speed * a + g * b]
        return rates

    return _still(draw, own, 4, draw.beside("HB"))


def branch_point_and_hopf(draw: Draw) -> Case:
    """A real eigenvalue and a pair pass, each once."""
    first, second = draw.two()
    speed = float(draw.rng.uniform(0.5, 3.0))

    def own(y: list[Any], q: Any) -> list[Any]:
        g = second(q) - y[1] ** 2 - y[2] ** 2
        return [first(q) * y[0] - y[0] ** 3, g * y[1] - speed * y[2], speed * y[1] + g * y[2]]

    return _still(draw, own, 3, draw.beside("BP", "HB"))


def flutter(draw: Draw) -> Case:
    """Two pairs run into each other: Hopf points at both edges of a window, flat outside of it.

    Of s^2 + d s = m, with m an eigenvalue of [[-1, -mu], [mu, -1 - e]]: (Im m)^2 = -d^2 Re m, which is
    e^2 = 4 (mu^2 - d^2) + d^4 for e beside its middle -d^2.
    """
    damping = float(10.0 ** draw.rng.uniform(-2.0, -0.5))
    stretch = float(draw.rng.uniform(1.0, 8.0))  # what the range is of the stiffness
    half = 0.5 * draw.distance * stretch
    square = damping**2 - 0.25 * damping**4 + (-1.0 if draw.near_miss else 1.0) * 0.25 * half**2
    # A miss stays one where mu is rounded.
    mu = math.sqrt(max(square, 0.0)) * (1.0 - (4.0 * np.finfo(float).eps if draw.near_miss else 0.0))

    def own(y: list[Any], q: Any) -> list[Any]:
        a, b, va, vb = y
        stiff = 1.0 - damping**2 + stretch * q
        return [
            va,
            vb,
            -damping * va - a - mu * b - a**3,
            -damping * vb - stiff * b + mu * a - b**3,
        ]

    def rates(y: list[Any], lam: Any) -> list[Any]:
        return own(y, draw.part(lam))

    # Where the second mode has no stiffness it is no matter of two crossings: the middle lies to the right.
    draw.middle = max(draw.middle, 0.0) if draw.middle * stretch < 0.8 else 0.8 / stretch
    # Of e that is the difference of two squares, each rounded.
    rounded = 16.0 * np.finfo(float).eps * damping**2 / (half * stretch) * draw.width
    found = [replace(c, rounding=float(rounded)) for c in draw.beside("HB")]
    return _case(draw, rates, [0.0] * 4, found, draw.start)


def two_folds(draw: Draw) -> Case:
    """q = y^3 - b y: two folds that face each other; with b < 0 none."""
    b = fold_half(draw.distance) * (-1.0 if draw.near_miss else 1.0)
    others, rate = _others(draw), float(draw.sign * draw.rng.uniform(0.5, 2.0))
    fed = draw.rng.uniform(-1.0, 1.0, len(others))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        own = rate * (draw.part(lam) - y[0] ** 3 + b * y[0])
        return [own, *(r * (v - float(f) * y[0]) for r, v, f in zip(others, y[1:], fed, strict=True))]

    first = float(np.cbrt(-draw.middle)) if draw.rng.random() < 0.5 else float(np.cbrt(1.0 - draw.middle))
    begin = draw.place(first**3 - b * first)
    begin = min(max(begin, draw.range[0]), draw.range[1])
    return _case(draw, rates, [first, *(float(f) * first for f in fed)], draw.beside("LP"), begin)


def fold_beside_branch_point(draw: Draw) -> Case:
    """(y - e) (q - y^2): along the parabola a fold at 0 and a branch point at e, e^2 from it in q."""
    e = math.sqrt(draw.distance) * float(draw.sign)
    others, rate = _others(draw), float(draw.rng.choice([-1.0, 1.0]))
    side = float(draw.rng.choice([-1.0, 1.0]))  # to which side the parabola is open
    fed = draw.rng.uniform(-1.0, 1.0, len(others))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        own = rate * (y[0] - e) * (side * draw.part(lam) - y[0] ** 2)
        return [own, *(r * (v - float(f) * y[0]) for r, v, f in zip(others, y[1:], fed, strict=True))]

    first = math.sqrt(0.1) * float(draw.rng.choice([-1.0, 1.0]))
    y = [first, *(float(f) * first for f in fed)]
    found = Crossing("LP", draw.place(0.0)), Crossing("BP", draw.place(side * draw.distance))
    return _case(draw, rates, y, found, draw.place(side * 0.1))


def two_marked_values(draw: Draw) -> Case:
    """An observable comes to a value that is marked, and leaves it again to the same side."""
    dip, others = draw.dip(), _others(draw)
    size = float(2.0 ** draw.rng.integers(-10, 11))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        return [1.0 + dip(draw.part(lam)) - y[0], *(r * v for r, v in zip(others, y[1:], strict=True))]

    start = draw.start
    y = [1.0 + float(dip(draw.part(start))), *[0.0] * len(others)]
    found = _case(draw, rates, y, draw.beside("UZ"), start, observed=lambda y: size * y[0])
    return replace(found, options={"marks": {"value": [size]}})


def fold_beside_hopf(draw: Draw) -> Case:
    """A parabola q = y^2, along which a pair passes at y = e, e^2 from its fold in q."""
    e = math.sqrt(draw.distance) * float(draw.sign)
    side, way = (float(each) for each in draw.rng.choice([-1.0, 1.0], 2))
    rate, speed, slope = (float(each) for each in draw.rng.uniform(0.5, 2.0, 3))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        g = way * slope * (y[0] - e) - y[1] ** 2 - y[2] ** 2
        return [
            rate * (side * draw.part(lam) - y[0] ** 2),
            g * y[1] - speed * y[2],
            speed * y[1] + g * y[2],
        ]

    first = math.sqrt(0.1) * float(draw.rng.choice([-1.0, 1.0]))
    found = Crossing("LP", draw.place(0.0)), Crossing("HB", draw.place(side * draw.distance))
    return _case(draw, rates, [first, 0.0, 0.0], found, draw.place(side * 0.1))


def fold_beside_two_hopf_points(draw: Draw) -> Case:
    """Along a parabola q = y^2 a pair passes at c - h, and back at c + h; c is h to 100 h."""
    half = 0.5 * draw.distance
    centre = half * float(draw.sign * 10.0 ** draw.rng.uniform(0.1, 2.0))
    side, way = (float(each) for each in draw.rng.choice([-1.0, 1.0], 2))
    rate, speed, slope = (float(each) for each in draw.rng.uniform(0.5, 2.0, 3))

    def rates(y: list[Any], lam: Any) -> list[Any]:
        apart = y[0] - centre
        g = way * slope * (half * half - apart * apart) - y[1] ** 2 - y[2] ** 2
        return [
            rate * (side * draw.part(lam) - y[0] ** 2),
            g * y[1] - speed * y[2],
            speed * y[1] + g * y[2],
        ]

    first = math.sqrt(0.1) * float(draw.rng.choice([-1.0, 1.0]))
    places = [("LP", 0.0), ("HB", centre - half), ("HB", centre + half)]
    found = [Crossing(label, draw.place(side * place * place)) for label, place in places]
    return _case(draw, rates, [first, 0.0, 0.0], found, draw.place(side * 0.1))


def branch_point_beside_two_hopf_points(draw: Draw) -> Case:
    """A real eigenvalue passes zero; beside it, within 100 times their distance, a pair passes twice."""
    dip, speed = draw.dip(), float(draw.rng.uniform(0.5, 2.0))
    slope = float(draw.rng.uniform(0.3, 3.0) * draw.rng.choice([-1.0, 1.0]))
    farther = min(10.0 ** draw.rng.uniform(0.1, 2.0), 0.3 / draw.distance)
    aside = 0.5 * draw.distance * float(draw.rng.choice([-1.0, 1.0]) * farther)

    def own(y: list[Any], q: Any) -> list[Any]:
        g = dip(q) - y[1] ** 2 - y[2] ** 2
        turning = [g * y[1] - speed * y[2], speed * y[1] + g * y[2]]
        return [slope * (q - aside) * y[0] - y[0] ** 3, *turning]

    return _still(draw, own, 3, (*draw.beside("HB"), Crossing("BP", draw.place(aside))))


EQUILIBRIA = {
    "BP BP": two_branch_points,
    "HB HB": two_hopf_points,
    "BP BP of two eigenvalues": two_real_eigenvalues,
    "HB HB of two pairs": two_pairs,
    "BP HB": branch_point_and_hopf,
    "HB HB of flutter": flutter,
    "LP LP": two_folds,
    "LP BP": fold_beside_branch_point,
    "LP HB": fold_beside_hopf,
    "LP HB HB": fold_beside_two_hopf_points,
    "BP HB HB": branch_point_beside_two_hopf_points,
    "UZ UZ": two_marked_values,
}
# Those that may as well come as near and not cross.
DIPS = ("BP BP", "HB HB", "HB HB of flutter", "LP LP", "UZ UZ")
