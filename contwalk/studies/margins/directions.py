"""Directions of pushes: of one state, given, or drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from contwalk.studies.margins.solution import Instant, Solution


def state_direction(names: Sequence[str], name: str) -> np.ndarray:
    """A push of one state by 1, shape (n,)."""
    return given_direction(names, {name: 1.0})


def given_direction(names: Sequence[str], shares: Mapping[str, float]) -> np.ndarray:
    """A push of each state by its share, shape (n,)."""
    return np.array([float(shares.get(name, 0.0)) for name in names])


def drawn_directions(
    count: int, seed: int, solution: Solution, names: Sequence[str], instant: Instant
) -> dict[str, np.ndarray]:
    """Directions evenly distributed over the states that exist and are not neutral, by their names.

    Each has length 1 where states are measured in their magnitudes. It follows from the seed and its number
    alone: Philox, keyed by NumPy's SeedSequence, draws n normal numbers.
    """
    free = np.array([k in instant.exists and name not in solution.neutral for k, name in enumerate(names)])
    found = {}
    for number in range(count):
        key = np.random.SeedSequence(seed, spawn_key=(number,))
        drawn = np.where(free, np.random.Generator(np.random.Philox(key)).standard_normal(len(names)), 0.0)
        length = float(np.sqrt((drawn**2).sum()))
        found[f"random{number + 1}"] = drawn * solution.magnitudes / (length or 1.0)
    return found


def existing(vector: np.ndarray, instant: Instant) -> np.ndarray:
    """A push, shape (n,), without the states that do not exist at an instant."""
    there = np.zeros(len(vector))
    there[list(instant.exists)] = vector[list(instant.exists)]
    return there


def unit_of(vector: np.ndarray, magnitudes: np.ndarray) -> float | None:
    """The size at which a push, shape (n,), moves a state by its own magnitude, and none by more."""
    largest = float(np.max(np.abs(vector) / magnitudes, initial=0.0))
    return 1.0 / largest if largest > 0.0 else None
