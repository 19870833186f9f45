"""Neutral directions: which to pin at the start of a branch, and states along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.errors import called
from contwalk.problems.mapping import mapped
from contwalk.problems.parameter_line import ParameterLine
from contwalk.system import Neutral, System
from contwalk.system.declarations import ParameterValues

# A generator counts as neutral where A g is this far below the size of its terms.
NEUTRAL = 1e-12
# A generator this small against its size nearby is rounding noise of zero.
VANISHED = 1e-9
# Name of a direction that nobody declared, found at a start.
UNDECLARED = "undeclared"


def generator_at(neutral: Neutral, x: np.ndarray, parameters: Mapping[str, float]) -> np.ndarray:
    """The direction a neutral generator points at state x, shape (n,)."""
    v = np.zeros(len(x))
    what = f"generator of the neutral direction '{neutral.name}'"
    called(what, neutral.generator, 0.0, x.copy(), ParameterValues(**parameters), v)
    return v


def directions(
    system: System, pins: Sequence[Neutral], x: np.ndarray, parameters: dict[str, float]
) -> np.ndarray:
    """Generators at a state as columns, shape (n, k)."""
    return np.array([generator_at(pin, x, parameters) for pin in pins]).reshape(len(pins), len(x)).T


def shifted(
    system: System,
    pins: Sequence[Neutral],
    states: np.ndarray,
    parameters: dict[str, float],
    shares: np.ndarray,
) -> np.ndarray:
    """Many states, (k, n), each moved along the generators by its row of shares, (k, number of pins)."""
    values, result = ParameterValues(**parameters), states.copy()
    for j, pin in enumerate(pins):
        along = mapped(f"generator of '{pin.name}'", pin.generator, states, values)
        result += along * shares[:, j, None]
    return result


def across(apart: np.ndarray, along: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """A difference of states without its part along some directions, in the metric of the scales."""
    if not along.shape[1]:
        return apart
    scaled = along / scale[:, None]
    shares, *_ = np.linalg.lstsq(scaled, apart / scale, rcond=None)
    return apart - along @ shares


def _size_nearby(neutral: Neutral, x: np.ndarray, parameters: Mapping[str, float]) -> float:
    """Size of a generator a little away from x, where it does not vanish by a coincidence of the state."""
    away = x + 1e-2 * np.cos(np.arange(1.0, len(x) + 1.0)) * (1.0 + np.abs(x))
    return float(np.linalg.norm(generator_at(neutral, away, parameters)))


def active(
    system: System, x: np.ndarray, parameters: Mapping[str, float], matrix: np.ndarray
) -> list[Neutral]:
    """Declared generators that are neutral at an equilibrium, without ones that depend on earlier ones.

    Parameters
    ----------
    x : ndarray, shape (n,)
    parameters : mapping
        Values by name.
    matrix : ndarray, shape (n, n)
        A = df/dx there.
    """
    chosen: list[Neutral] = []
    basis = np.zeros((len(x), 0))
    for neutral in system.neutral:
        g = generator_at(neutral, x, parameters)
        size = np.linalg.norm(g)
        if not np.all(np.isfinite(g)) or size <= VANISHED * _size_nearby(neutral, x, parameters):
            continue
        terms = (np.abs(matrix) @ np.abs(g)).max()
        if np.abs(matrix @ g).max() > NEUTRAL * terms:
            continue
        rest = g / size - basis @ (basis.T @ (g / size))
        if np.linalg.norm(rest) < 1e-6:
            continue
        basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
        chosen.append(neutral)
    return chosen


def constant(direction: np.ndarray) -> Neutral:
    """An undeclared neutral direction, the same at every state."""

    def generator(t: float, x: np.ndarray, p: object, v: np.ndarray) -> None:
        for i, entry in enumerate(direction.tolist()):
            v[i] = entry

    return Neutral(UNDECLARED, generator)


def kept(
    pins: Sequence[Neutral],
    line: ParameterLine,
    states: int,
) -> dict[str, Any]:
    """What is stored with a branch so that its equations can be set up again, as plain JSON values."""
    undeclared = [
        generator_at(pin, np.zeros(states), line.parameters) for pin in pins if pin.name == UNDECLARED
    ]
    return {
        "pins": [pin.name for pin in pins],
        "undeclared": [direction.tolist() for direction in undeclared],
        "path": None if line.ends is None else [dict(end) for end in line.ends],
    }
