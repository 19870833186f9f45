"""From a stored point back to the problem that it solves, and to its place on the branch."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.problems.problem import Problem, Sample, at_stored
from contwalk.problems.restoring import problem_of
from contwalk.system import System


def reopened(
    system: System, branch: Branch, point: str | int | SpecialPoint, discretization: Any = None
) -> tuple[Problem, Sample]:
    """The problem discretised for a stored point, and the point's sample on it, facing growing arclength.

    Parameters
    ----------
    system : System
    branch : Branch
    point : str, int or SpecialPoint
        A special point or its name, or the number of a row.
    discretization : Discretization, optional
        Other steps than those the branch was computed with.

    Raises
    ------
    DatabaseError, NotFinite
        If the system is not the one of the branch, or the motion from there ends.
    """
    place = stored_place(branch, point)
    z, weights = place.z, place.weights
    problem = problem_of(system, branch.info, z[: len(branch.info.states)], discretization)
    there: Problem = at_stored(problem, z, weights)
    return there, there.examine(z, place.tangent, weights, there.linearize(z), place.unstable)


@dataclass(frozen=True)
class StoredPlace:
    """Solution, tangent and weights of a stored point, each of shape (N + 1,), and its unstable count."""

    z: np.ndarray
    tangent: np.ndarray
    weights: np.ndarray
    unstable: int


def stored_place(branch: Branch, point: str | int | SpecialPoint) -> StoredPlace:
    """Where a special point, or the row of a number, lies on its branch.

    A special point that is not located has no solution of its own: it stands at its row.
    """
    special = branch.special(point) if isinstance(point, str) else point
    index = special.index if isinstance(special, SpecialPoint) else special
    row = branch.points[index]
    if isinstance(special, SpecialPoint) and special.unknowns:
        z, tangent = np.array(special.unknowns), np.array(special.tangent)
    else:
        z = branch.unknowns(index)
        tangent = np.array(row["tangent"][: len(z)])
    return StoredPlace(z, tangent, np.array(row["weights"][: len(z)]), int(row["unstable"]))
