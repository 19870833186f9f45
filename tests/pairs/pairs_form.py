"""What a case of two crossings is: a system, where it is walked, and what lies there in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from contwalk.system import System

# The free parameter of each case.
FREE = "lam"


@dataclass(frozen=True)
class Crossing:
    """A special point in closed form: its label, the parameter there, and what rounding leaves of that."""

    label: str
    place: float
    rounding: float = 0.0


@dataclass(frozen=True)
class Case:
    """Two crossings, or as near a miss: what is walked, and what lies there.

    `distance` is that of both crossings in parts of the range, and `crossings` is empty where none is made.
    A cycle has a `period`, an orbit with events what leads to it: arguments of `hybrid_runs.diagram`.
    """

    kind: str
    seed: int
    system: System
    state: np.ndarray
    start: float
    range: tuple[float, float]
    distance: float
    crossings: tuple[Crossing, ...]
    period: float | None = None
    options: dict[str, Any] = field(default_factory=dict)
    machine: dict[str, Any] | None = None


@dataclass
class Draw:
    """The random numbers of one case: its range, the place and the distance of both crossings.

    With `near_miss` the same function is shifted beyond zero: it comes as near and does not cross.
    """

    kind: str
    seed: int
    near_miss: bool

    def __post_init__(self) -> None:
        self.rng = np.random.default_rng([self.seed, *self.kind.encode()])
        self.distance = 10.0 ** -self.rng.uniform(1.0, 9.0)
        self.width = 10.0 ** self.rng.uniform(-2.0, 3.0)
        self.low = self.width * self.rng.uniform(-2.0, 1.0)
        self.middle = self.rng.uniform(0.2, 0.8)
        self.sign = self.rng.choice([-1.0, 1.0])

    @property
    def range(self) -> tuple[float, float]:
        """Ends of the range."""
        return self.low, self.low + self.width

    @property
    def start(self) -> float:
        """Where the walk begins: at one end or within, not between both crossings."""
        part = self.rng.choice([0.0, 1.0, 0.5 * self.middle, 0.5 * (1.0 + self.middle)])
        return self.low + float(part) * self.width

    def part(self, value: Any) -> Any:
        """Where a value of the parameter lies, in parts of the range from the middle of both crossings."""
        return (value - (self.low + self.middle * self.width)) / self.width

    def place(self, part: float) -> float:
        """The parameter at a part of the range from the middle of both crossings."""
        return self.low + (self.middle + part) * self.width

    def beside(self, one: str, other: str | None = None) -> tuple[Crossing, ...]:
        """Both crossings, half their distance from the middle; none of a near miss."""
        if self.near_miss:
            return ()
        half = 0.5 * self.distance
        return Crossing(one, self.place(-half)), Crossing(other or one, self.place(half))

    def dip(self) -> Callable[[Any], Any]:
        """A function of the part of the range that passes zero twice, a distance apart, and is flat far off.

        Its sign in between is drawn, and how fast it bends: to 1 within 0.1 to 1 of the range.
        """
        bend, sign = 10.0 ** self.rng.uniform(0.0, 2.0), float(self.sign)
        depth = (-1.0 if self.near_miss else 1.0) * 0.25 * self.distance**2
        return lambda q: sign * bend * (depth - q * q) / (1.0 + bend * q * q)

    def two(self) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
        """Two functions that pass zero, each once, half their distance before and behind the middle."""
        slopes = self.rng.uniform(0.3, 3.0, 2) * self.rng.choice([-1.0, 1.0], 2)
        half = 0.5 * self.distance
        return lambda q: float(slopes[0]) * (q + half), lambda q: float(slopes[1]) * (q - half)

    def frame(self, size: int) -> Frame:
        """States in a random frame: mixed, shifted, and of sizes of their own.

        All of it is made of few binary digits, so that both ways are exact in double precision.
        """
        lower, upper = (
            np.tril(self.rng.integers(-4, 5, (size, size)), -1) / 4.0 + np.eye(size) for _ in range(2)
        )
        mixed, apart = lower, _inverse(lower)
        if self.rng.random() < 0.5:
            mixed, apart = lower @ upper.T, _inverse(upper).T @ apart
        order = self.rng.permutation(size)
        sizes = 2.0 ** self.rng.integers(-10, 11, size)
        shift = sizes * self.rng.integers(-8, 9, size) / 8.0
        return Frame(sizes[:, None] * mixed[order], apart[:, order] / sizes, shift)


@dataclass(frozen=True)
class Frame:
    """States x = matrix y + shift of a plugin, where y are those that closed forms are written in."""

    matrix: np.ndarray
    inverse: np.ndarray
    shift: np.ndarray

    def outside(self, y: Sequence[float]) -> np.ndarray:
        """The plugin's states, shape (n,)."""
        return self.matrix @ np.asarray(y, dtype=float) + self.shift

    def inside(self, x: Any) -> list[Any]:
        """The states of the closed forms, of plain numbers or of a plugin's."""
        apart = [x[j] - float(shift) for j, shift in enumerate(self.shift)]
        return [_sum(row, apart) for row in self.inverse]

    def field(self, rates: Callable[[list[Any], Any], Sequence[Any]]) -> Callable[..., None]:
        """The field of a plugin whose closed forms have `rates` of their states and the free parameter."""

        def field(t: Any, x: Any, p: Any, dx: Any) -> None:
            within = rates(self.inside(x), p.lam)
            for i in range(len(self.shift)):
                dx[i] = _sum(self.matrix[i], within)

        return field

    @property
    def scales(self) -> np.ndarray:
        """How large each state of the plugin may be, shape (n,)."""
        return np.abs(self.matrix).sum(axis=1) + np.abs(self.shift)


def _inverse(lower: np.ndarray) -> np.ndarray:
    """The inverse of a triangular matrix with ones on its diagonal, to the last digit."""
    identity = np.eye(len(lower))
    total = power = identity
    for _ in lower:
        power = power @ (identity - lower)
        total = total + power
    return total


def _sum(row: np.ndarray, values: Sequence[Any]) -> Any:
    total: Any = 0.0
    for weight, value in zip(row, values, strict=True):
        if weight != 0.0:
            total = total + float(weight) * value
    return total


def fold_half(distance: float) -> float:
    """b of the cubic q = y^3 - b y whose two folds lie a distance apart: y^2 = b / 3, q = -+ 2 b y / 3."""
    return (0.75 * math.sqrt(3.0) * distance) ** (2.0 / 3.0)
