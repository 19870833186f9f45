"""The metric in which arclength is measured: unknowns and parameter in units of their typical magnitudes."""

from __future__ import annotations

import math

import numpy as np

from contwalk.continuation.settings import Settings
from contwalk.problems.problem import Problem

# Stands in for a magnitude that neither the unknown nor the equations tell yet.
UNKNOWN = 1.0
# So many unknowns are counted whole: those of a mechanism, each with a meaning of its own.
CROWD = 10


def updated(
    weights: np.ndarray | None, magnitudes: np.ndarray, settings: Settings, sizes: np.ndarray, z: np.ndarray
) -> np.ndarray:
    """Weights at the next point.

    A weight starts as the magnitude that the problem tells, and then only grows with its unknown, so that
    passing zero does not shrink the steps. A parameter's follows its size, within the width of its range.

    Parameters
    ----------
    weights : ndarray or None, shape (N + 1,)
        Those of the last point; None at the start.
    magnitudes : ndarray, shape (N + 1,)
        Typical magnitudes at the new point, NaN where unknown.
    sizes : ndarray, shape (N + 1,)
        Sizes of the unknowns at the new point.
    z : ndarray, shape (N + 1,)
        The new point.
    """
    # What nothing tells grows too, as a state that stands still over an orbit and is sampled by a clock.
    untold = UNKNOWN if weights is None else np.maximum(UNKNOWN, sizes)
    known = np.where(np.isfinite(magnitudes), magnitudes, untold)
    result = known if weights is None else np.where(weights == UNKNOWN, known, np.maximum(weights, sizes))
    for place, ends in settings.bounds.items():
        result[place] = parameter_weight(magnitudes[place], ends, float(z[place]))
    return result


def crowded(problem: Problem, sizes: np.ndarray) -> np.ndarray:
    """Sizes or magnitudes of the unknowns as the metric counts them, shape (N + 1,).

    Arclength is a sum over the unknowns. Of many that are values of one function on a grid, each counts the
    less the more there are: steps do not get shorter where the grid gets finer. Orbits count their own.
    """
    size = len(sizes) - 1
    if problem.meshed is not None or size <= CROWD:
        return sizes
    result = sizes * math.sqrt(size / CROWD)
    result[-1] = sizes[-1]
    return result


def parameter_weight(magnitude: float, ends: tuple[float, float], value: float) -> float:
    """Typical magnitude of a free parameter: |lambda|, but not more than the width of its range.

    Where the range contains zero it does not drop below a hundredth of the width; where it spans decades on
    one side of zero, the steps are the same in each decade.
    """
    low, high = ends
    size, width = abs(value), high - low
    if not math.isfinite(width):
        return max(size, magnitude) if math.isfinite(magnitude) else max(size, 1.0)
    if low * high <= 0.0:
        size = max(size, width / 100.0)
    return min(max(size, width * 1e-12), width)
