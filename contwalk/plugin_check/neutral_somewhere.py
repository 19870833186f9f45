"""Are there parameters, or an equilibrium, with which a declared direction is neutral? By least squares.

A direction is neutral where a residual is zero: the bracket Df v - Dv f at all sampled states, or f and A v
at one state. Zeros are sought from several starts. Where none is found there may be one all the same: what is
told of it is a doubt, no proof.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import numpy as np

from contwalk.system import System

Residual = Callable[[np.ndarray], np.ndarray]

# Residuals are parts of the size of their terms. What is below the second solves the equations.
SOLVED = 1e-9
STARTS, STEPS, MOST_CUTS = 8, 30, 12
# A value found that is this small beside the default is told as zero.
NOTHING = 1e-6
# What nothing depends on is moved by nothing.
SLIGHT = 1e-12
# Step of differences, in units of an unknown; how far, in units, zeros are looked for.
DIFFERENCE, FAR = 1e-6, 1e3
_SEED = 3  # any; fixed, so that two checks of one plugin say the same


def zero_of(
    residual: Residual, starts: list[np.ndarray], units: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray | None:
    """A zero of a residual, shape (k,), within bounds; None where none is found from any start.

    Parameters
    ----------
    residual : callable
        From unknowns, shape (k,), to numbers of size 1, shape (m,).
    starts : list of ndarray, shape (k,)
    units, low, high : ndarray, shape (k,)
        Magnitudes of the unknowns, and where they must stay.
    """
    low, high = np.maximum(low, -FAR * units), np.minimum(high, FAR * units)
    for start in starts:
        found = _descended(residual, np.clip(start, low, high), units, low, high)
        if found is not None:
            return found
    return None


def _descended(
    residual: Residual, u: np.ndarray, units: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray | None:
    """The zero that Levenberg's and Marquardt's steps lead to; None where they lead to none."""
    value, damping = residual(u), 1e-3
    for _ in range(STEPS):
        if not np.isfinite(value).all():
            return None
        if np.max(np.abs(value), initial=0.0) < SOLVED:
            return u
        slopes = np.array([(residual(u + h) - value) / DIFFERENCE for h in DIFFERENCE * np.diag(units)]).T
        if not np.isfinite(slopes).all():
            return None
        for _ in range(MOST_CUTS):
            resist = np.sqrt(damping) * (np.linalg.norm(slopes, axis=0) + SLIGHT)
            matrix = np.vstack([slopes, np.diag(resist)])
            step, *_ = np.linalg.lstsq(matrix, np.concatenate([value, np.zeros(len(u))]), rcond=None)
            tried = np.clip(u - units * step, low, high)
            there = residual(tried)
            if np.isfinite(there).all() and np.linalg.norm(there) < np.linalg.norm(value):
                damping *= 0.1
                break
            damping *= 10.0
        else:
            return None
        u, value = tried, there
    return None


def parameter_starts(
    system: System, defaults: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray, np.ndarray, np.ndarray]:
    """Values of all parameters to begin with, the defaults first; their units, and their bounds."""
    random = Random(_SEED)
    units = np.where(defaults == 0.0, 1.0, np.abs(defaults))
    starts = [defaults]
    while len(starts) < STARTS:
        starts.append(np.array([unit * random.gauss(0.0, 2.0) for unit in units]))
    bounds = [parameter.bounds for parameter in system.parameters]
    low = np.array([-np.inf if bound[0] is None else bound[0] for bound in bounds])
    high = np.array([np.inf if bound[1] is None else bound[1] for bound in bounds])
    return starts, units, low, high


def in_words(system: System, defaults: np.ndarray, found: np.ndarray) -> str:
    """`with k = 0.25, r = 0`: of the parameters that are not at their defaults; empty if all are."""
    moved = []
    for parameter, default, value in zip(system.parameters, defaults.tolist(), found.tolist(), strict=True):
        if value != default:
            told = 0.0 if abs(value) < NOTHING * (abs(default) or 1.0) else value
            moved.append(f"{parameter.name} = {told:.4g}")
    return f"with {', '.join(moved)}" if moved else ""
