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
# That of a weighted sum of states which is conserved, and which nobody declared.
SUM = "conserved_sum"
# Shifts until a state is nearest to another one, the part of the magnitudes that ends them, and the steps of
# each where generators turn on the way.
MOST_SHIFTS, NO_SHIFT, PARTS = 8, 1e-10, 32


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


def apart_at_least(
    system: System,
    pins: Sequence[Neutral],
    x: np.ndarray,
    target: np.ndarray,
    parameters: dict[str, float],
    scale: np.ndarray,
    own: Sequence[int],
) -> np.ndarray:
    """Difference of a state to another one, once it is moved along generators to where they are nearest.

    Parameters
    ----------
    x, target, scale : ndarray, shape (n,)
    own : sequence of int
        Which of the states exist: others are no matter, and zero in the difference of shape (n,).
    """
    exists = np.zeros(len(x))
    exists[list(own)] = 1.0
    for _ in range(MOST_SHIFTS):
        apart = (x - target) * exists
        along = directions(system, pins, x, parameters) * exists[:, None]
        if not along.shape[1]:
            return apart
        shares, *_ = np.linalg.lstsq(along / scale[:, None], -apart / scale, rcond=None)
        if np.linalg.norm(along @ shares / scale) <= NO_SHIFT:
            break
        x = carried(system, pins, x, parameters, shares)
    return (x - target) * exists


def carried(
    system: System, pins: Sequence[Neutral], x: np.ndarray, parameters: dict[str, float], shares: np.ndarray
) -> np.ndarray:
    """A state, shape (n,), carried along the sum of generators by a share of each for one unit of time."""

    def rate(y: np.ndarray) -> np.ndarray:
        return directions(system, pins, y, parameters) @ shares

    first = rate(x)
    if np.array_equal(rate(x + first), first):  # the same everywhere
        return x + first
    h = 1.0 / PARTS
    for _ in range(PARTS):
        a = rate(x)
        b = rate(x + 0.5 * h * a)
        c = rate(x + 0.5 * h * b)
        d = rate(x + h * c)
        x = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    return x


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


def constant(direction: np.ndarray, name: str = UNDECLARED) -> Neutral:
    """An undeclared neutral direction, the same at every state; or the weights of a conserved sum, along
    which a drift unfolds what is singular as well, and which tell where it is held.
    """

    def generator(t: float, x: np.ndarray, p: object, v: np.ndarray) -> None:
        for i, entry in enumerate(direction.tolist()):
            v[i] = entry

    return Neutral(name, generator)


def kept(pins: Sequence[Neutral], line: ParameterLine, states: int) -> dict[str, Any]:
    """What is stored with a branch so that its equations can be set up again, as plain JSON values."""
    undeclared = [
        generator_at(pin, np.zeros(states), line.parameters) for pin in pins if pin.name in (UNDECLARED, SUM)
    ]
    return {
        "pins": [pin.name for pin in pins],
        "undeclared": [direction.tolist() for direction in undeclared],
        "path": None if line.ends is None else [dict(end) for end in line.ends],
    }
