"""Random sums of terms as data: text for a plugin, with the parity that a symmetry asks for.

Terms are kept as text that any arithmetic evaluates (floats, arrays, complex numbers, mpmath), so that what
contwalk traces and what checks it are made from the same lines and share nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Factor:
    """A factor that depends on one state: a power of it, or the sine or cosine of a multiple."""

    kind: str  # power, sin, cos
    state: int
    number: float  # exponent, or wave number

    @property
    def text(self) -> str:
        if self.kind == "power":
            return f"x[{self.state}]" if self.number == 1 else f"x[{self.state}]**{int(self.number)}"
        return f"{self.kind}({self.number!r}*x[{self.state}])"

    @property
    def odd(self) -> bool:
        return self.kind == "sin" or (self.kind == "power" and self.number % 2 == 1)


@dataclass(frozen=True)
class Term:
    """A coefficient, parameters and further text that multiply factors."""

    coefficient: float
    factors: tuple[Factor, ...] = ()
    more: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        return "*".join([repr(self.coefficient), *self.more, *(f.text for f in self.factors)])

    def odd_in(self, states: frozenset[int]) -> bool:
        """Whether the term changes its sign with these states."""
        return sum(f.odd for f in self.factors if f.state in states) % 2 == 1

    def moved(self, places: dict[int, int]) -> Term:
        """The term with its states renamed."""
        return replace(
            self, factors=tuple(replace(f, state=places.get(f.state, f.state)) for f in self.factors)
        )


def number(rng: np.random.Generator, low: float = 0.1, high: float = 1.5) -> float:
    """A coefficient of either sign with two decimals."""
    return round(float(rng.uniform(low, high)) * (1.0 if rng.random() < 0.5 else -1.0), 2)


def factors(rng: np.random.Generator, states: int, kind: str) -> tuple[Factor, ...]:
    """Factors of a random nonlinear term."""
    if kind == "trigonometric" and rng.random() < 0.7:
        wave = ("sin", "cos")[int(rng.integers(2))]
        found = [Factor(wave, int(rng.integers(states)), round(float(rng.uniform(0.5, 2.0)), 1))]
        if rng.random() < 0.4:
            found.append(Factor("power", int(rng.integers(states)), 1))
        return tuple(found)
    chosen = rng.integers(states, size=2 if rng.random() < 0.6 else 3)
    return tuple(Factor("power", int(i), int(np.sum(chosen == i))) for i in dict.fromkeys(chosen.tolist()))


def linear(rng: np.random.Generator, states: int, damping: float, density: float) -> list[list[Term]]:
    """A random matrix with damping on its diagonal, as terms of each equation."""
    rows: list[list[Term]] = []
    for i in range(states):
        row = [Term(-round(damping * float(rng.uniform(0.5, 1.5)), 2), (Factor("power", i, 1),))]
        row += [
            Term(number(rng), (Factor("power", j, 1),))
            for j in range(states)
            if j != i and rng.random() < density
        ]
        rows.append(row)
    return rows
