"""Why a start does not converge where orbits come in a family: nothing says which one is meant."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.problems.orbit.branching import filled_magnitudes
from contwalk.problems.orbit.protocol import Orbit

# A singular value of the scaled equations below this part of the largest is zero, but for rounding and the
# steps of the start.
ZERO = 1e-7
# States that move by less than this part of the largest, in typical units, do not tell members apart.
MOVES = 1e-3


def in_a_family(problem: Orbit, z: np.ndarray, names: Mapping[int, str]) -> str:
    """A sentence where orbits near a start come in a family at the same parameters; empty where they do not.

    Parameters
    ----------
    z : ndarray, shape (N + 1,)
    names : mapping
        States by their places in z.
    """
    weights = filled_magnitudes(problem, z)
    # At the same parameters: without the last column.
    matrix = problem.linearize(z).jacobian[:, :-1] * weights[:-1]
    if not np.isfinite(matrix).all():
        return ""
    rows = np.abs(matrix).max(axis=1)
    values, right = np.linalg.svd(matrix / np.where(rows > 0.0, rows, 1.0)[:, None])[1:]
    free = right[values <= ZERO * values[0]]
    if not len(free):
        return ""
    moves = np.linalg.norm(free, axis=0)
    largest = max((moves[place] for place in names), default=0.0)
    told = [name for place, name in names.items() if largest and moves[place] > MOVES * largest]
    among = f": they differ in {', '.join(dict.fromkeys(told))}" if told else ""
    return f"Orbits come in a family there, at the same parameters{among}."
