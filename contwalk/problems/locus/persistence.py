"""Whether branch points are ones at all values of two parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

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
    second = str(problem.line.second)
    values = problem.values_of(z)
    place = f"{problem.free} = {values[problem.free]:.10g}, {second} = {values[second]:.10g}"
    return (
        f"The branch point does not persist as {second} varies: beside {place} the branches that cross come "
        "apart. Only where a symmetry or an invariant subspace keeps them together is there such a curve; "
        "follow the folds (LP) that are born instead."
    )
