"""Whether branch points are ones at all values of two parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.problems.problem import MAX_RE

# An unfolding below so many roundings of the equations is nothing: parameters such as pi are rounded too.
NOTHING = 16.0


def unfolds(plane: Any, z: np.ndarray, change: np.ndarray) -> bool:
    """Whether what is added to the equations of an orbit, shape (N,), is more than their rounding at z.

    `plane` is an `OrbitPlane`, z has the shape (N + k + 2,).
    """
    there, own = plane.first(z)
    levels = there.linearize(own).levels[0]
    return not bool(np.all(np.abs(change) <= NOTHING * levels))


def not_persistent(problem: Any, z: np.ndarray) -> str:
    """Why there is no curve of branch points through z, shape (N + 1,)."""
    return (
        f"The branch point does not persist as {problem.line.second} varies: beside {place_of(problem, z)} "
        "the branches that cross come apart. Only where a symmetry or an invariant subspace keeps them "
        "together is there such a curve; follow the folds (LP) that are born instead."
    )


def place_of(problem: Any, z: np.ndarray, digits: int = 10) -> str:
    """A place on a curve in words: the values of both parameters at z, shape (N + 1,)."""
    values = problem.values_of(z)
    return ", ".join(f"{name} = {values[name]:.{digits}g}" for name in problem.line.names)


def not_followed(point: SpecialPoint, free: tuple[str, str]) -> str:
    """Why a marked value has no curve, as the rest of a sentence."""
    name, level = point.mark.get("name"), point.mark.get("value")
    if name is None:
        return "what is marked there is not stored (a database of an earlier version: compute it once more)."
    if level is None:
        return f"it is an extremum of {name}, and curves of extrema are not followed."
    if name == MAX_RE:
        return "a real eigenvalue vanishes there, and the LP or BP there has that curve."
    return f"{name} stands still where {' and '.join(free)} vary."
