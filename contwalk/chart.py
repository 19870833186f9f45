"""The result: a chart of two parameters, its regions and the solutions at one place of each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Solution:
    """A solution at a place: how many directions are unstable (None: not known), whether it is admissible,
    and its state.
    """

    unstable: int | None
    admissible: bool
    state: dict[str, float]


def _last(unstable: int | None) -> float:
    """What counts are ordered by."""
    return math.inf if unstable is None else unstable


@dataclass(frozen=True)
class Region:
    """A region: its place that was computed, values of both parameters, and the solutions there."""

    at: tuple[float, float]
    solutions: tuple[Solution, ...]

    @property
    def shown(self) -> Solution | None:
        """The most stable of the admissible solutions, or of all where none is; None where there are none."""
        admissible = [solution for solution in self.solutions if solution.admissible]
        return min(admissible or self.solutions, key=lambda solution: _last(solution.unstable), default=None)

    @property
    def counts(self) -> tuple[int | None, ...]:
        """Unstable directions of all its solutions, in ascending order; None, last, where not known."""
        return tuple(sorted((solution.unstable for solution in self.solutions), key=_last))


@dataclass(frozen=True)
class Chart:
    """The regions of a plane of two parameters.

    Parameters
    ----------
    names : tuple of str
        The parameters along both axes.
    low, high : tuple of float
        Their values at the corners.
    labels : ndarray of int, shape (rows, columns)
        Each cell's region, -1 where it is too small.
    regions : tuple of Region
    notes : tuple of str
        What is not certain, a sentence each.
    """

    names: tuple[str, str]
    low: tuple[float, ...]
    high: tuple[float, ...]
    labels: np.ndarray
    regions: tuple[Region, ...]
    notes: tuple[str, ...]
