"""Machines of wide ranges and of equal units: graded rates with a sum, rings, populations that vanish."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from random_recipe import Recipe
from random_terms import Factor, Term, number


def _power(*states: int) -> tuple[Factor, ...]:
    """The product of some states, each as often as it is named."""
    return tuple(Factor("power", i, states.count(i)) for i in dict.fromkeys(states))


def _start(values: np.ndarray) -> str:
    """A state to its last digit."""
    return "{state: {" + ", ".join(f"x{i}: {float(v)!r}" for i, v in enumerate(values)) + "}}"


def graded(rng: np.random.Generator, seed: int) -> Recipe:
    """Reversible reactions with rates from 1e-9 to 1e9, whose states have a sum that is conserved.

    Of each the rate backwards makes a drawn state an equilibrium at lam = 1; lam drives one of them away.
    """
    states = int(rng.integers(3, 6))
    x = np.round(rng.uniform(0.1, 1.0, states), 3)
    rows: list[list[Term]] = [[] for _ in range(states)]
    pairs = [(i, i + 1) for i in range(states - 1)]
    pairs += [(0, states - 1)] if rng.random() < 0.7 else []
    driven = int(rng.integers(len(pairs)))
    for k, (i, j) in enumerate(pairs):
        rate = float(f"{10.0 ** rng.uniform(-9.0, 9.0):.4g}")
        helped = [int(h) for h in rng.integers(0, states, int(rng.integers(0, 3)))]
        forwards, backwards = _power(i, *helped), _power(j, *helped)
        back = rate * float(x[i]) / float(x[j])
        more = ("p.lam",) if k == driven else ()
        for row, sign in ((i, -1.0), (j, 1.0)):
            rows[row] += [Term(sign * rate, forwards, more), Term(-sign * back, backwards)]
    modes = {"flow": tuple(map(tuple, rows))}
    return Recipe(seed, "graded", states, {"lam": 1.0, "mu": 0.0}, modes, _start(x), (0.2, 5.0), depth=1)


def ring(rng: np.random.Generator, seed: int) -> Recipe:
    """Three to eight equal units in a ring, each of one state or of two, coupled to their neighbours."""
    units, each = int(rng.integers(3, 9)), int(rng.integers(1, 3))
    coupling, turn = abs(number(rng, 0.05, 0.4)), round(float(rng.uniform(0.5, 2.0)), 2)
    rows: list[list[Term]] = []
    for unit in range(units):
        for own in range(each):
            i = unit * each + own
            row = [Term(1.0, _power(i), ("p.lam",)), Term(-1.0, _power(i, i, i))]
            row += [Term(-2.0 * coupling, _power(i))]
            row += [Term(coupling, _power((unit + side) % units * each + own)) for side in (-1, 1)]
            if each == 2:
                other = unit * each + 1 - own
                row += [Term(turn if own else -turn, _power(other)), Term(-1.0, _power(i, other, other))]
            rows.append(row)
    modes = {"flow": tuple(map(tuple, rows))}
    states = units * each
    values = {"lam": -0.3, "mu": coupling}
    return Recipe(seed, "ring", states, values, modes, _start(np.zeros(states)), (-0.5, 1.2), depth=1)


def population(rng: np.random.Generator, seed: int) -> Recipe:
    """Competing kinds some of which fall to 1e-20: x' = x (r + lam g - A x) + e, e a trickle from outside.

    Growths make a drawn state an equilibrium at lam = 0.
    """
    states = int(rng.integers(2, 6))
    x = np.where(
        rng.random(states) < 0.6, 10.0 ** rng.uniform(-20.0, -6.0, states), rng.uniform(0.3, 1.5, states)
    )
    x[0] = rng.uniform(0.5, 1.5)
    x = np.array([float(f"{v:.4g}") for v in x])
    shared = np.round(rng.uniform(0.1, 1.4, (states, states)), 2) + np.eye(states)
    gained = np.round(rng.uniform(-1.0, 1.0, states), 2)
    rows = []
    for i in range(states):
        trickle = float(f"{x[i] * rng.uniform(0.1, 1.0):.4g}")
        growth = float(shared[i] @ x) - trickle / float(x[i])
        row = [Term(growth, _power(i)), Term(float(gained[i]), _power(i), ("p.lam",)), Term(trickle)]
        rows.append([*row, *(Term(-float(shared[i, j]), _power(i, j)) for j in range(states))])
    modes = {"flow": tuple(map(tuple, rows))}
    return Recipe(seed, "population", states, {"lam": 0.0, "mu": 0.0}, modes, _start(x), (-1.5, 1.5), depth=1)


WIDE: dict[str, Callable[[np.random.Generator, int], Recipe]] = {
    "graded": graded,
    "ring": ring,
    "population": population,
}
