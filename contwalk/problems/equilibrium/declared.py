"""Equilibria that a plugin names: its closed forms as they are, its guesses corrected."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.errors import StartError
from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.problem import Linearization
from contwalk.system import System

# Residuals this many times above their rounding error count as solved, as along branches.
SOLVED = 20.0
# Corrections, and the shortest part of one that is tried.
MOST, SHORTEST = 60, 1e-6
# Singular values below this part of the largest belong to directions along which equilibria are neighbours.
SINGULAR = 1e-10


def named_equilibria(system: System, name: str, parameters: Mapping[str, float]) -> list[np.ndarray]:
    """States of a named start, shape (n,) each, corrected by Newton's method.

    What is an equilibrium to rounding is given as it is, and so are the states of a forced system: constant
    solutions, which are corrected as orbits.

    Raises
    ------
    StartError
        Where it does not exist, or where no equilibrium is found near what the plugin gives.
    """
    found = system.named_states(name, parameters)
    if system.period is not None:
        return found
    places = [resting(system, x, parameters) for x in found]
    if any(place is None for place in places):
        raise StartError(
            f"The start '{name}' of '{system.name}' is no equilibrium, and Newton's method finds none there.",
            "Give a better guess in the plugin, or [] where it does not exist.",
        )
    return [place for place in places if place is not None]


def resting(system: System, x: np.ndarray, parameters: Mapping[str, float]) -> np.ndarray | None:
    """The equilibrium that a state is, to rounding, or that Newton's method finds from it; None if none.

    Both have the shape (n,). Of neighbouring equilibria the nearest in units of the states' magnitudes.
    """
    values = system.all_parameters(parameters)
    problem = Equilibrium(system, values, "path", (values, values))
    n, z = problem.states, np.append(x, 0.0)
    here = problem.linearize(z)
    for _ in range(MOST):
        if not here.finite:
            return None
        if here.excess <= SOLVED:
            return z[:n]
        scales = _scales(system, z[:n])
        step = _correction(here, here.residual, scales)
        size, part = float(np.linalg.norm(step / scales)), 1.0
        while True:
            there = problem.linearize(np.append(z[:n] - part * step, 0.0))
            if there.finite:
                following = float(np.linalg.norm(_correction(here, there.residual, scales) / scales))
                if following <= (1.0 - 0.25 * part) * size:
                    break
            part /= 2.0
            if part < SHORTEST:
                return None
        z, here = np.append(z[:n] - part * step, 0.0), there
    return None


def _scales(system: System, x: np.ndarray) -> np.ndarray:
    """Magnitudes of the states: declared, or their own, and one where both are nothing."""
    declared = np.array([state.scale or 0.0 for state in system.states])
    largest = float(np.abs(x).max()) or 1.0
    return np.where(declared > 0.0, declared, np.maximum(np.abs(x), 1e-3 * largest))


def _correction(here: Linearization, residual: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """The shortest change of the states that Newton's method subtracts for a residual, shape (n,)."""
    n = len(scales)
    matrix = here.jacobian[:n, :n] * scales
    rows = np.abs(matrix).max(axis=1)
    rows = np.where(rows > 0.0, rows, 1.0)
    solved = np.linalg.lstsq(matrix / rows[:, None], residual[:n] / rows, rcond=SINGULAR)[0]
    return scales * solved
