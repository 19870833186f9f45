"""The metric in which arclength is measured: unknowns and parameter in units of their typical magnitudes.

At the start of a branch an unknown may be zero and tell none itself. What an equation tells of it is the
change of it that would matter in that equation alone: of a stiff system, as a boundary value problem on a
fine grid, that is far less than how far it moves along the branch; of terms that are noise it is noise.
"""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np

from contwalk.continuation.settings import Settings
from contwalk.numerics.linear import EPSILON, Factored, kernel_direction, norm_in
from contwalk.problems.problem import Linearization, Problem, Sample

# Stands in for a magnitude that neither the unknown nor the equations tell yet.
UNKNOWN = 1.0
# So many unknowns are counted whole: those of a mechanism, each with a meaning of its own.
CROWD = 10
# Unknowns this many times their own error, or less, are zero.
NOISE = 1e3
# Harmonics up to this one are told by the power of the amplitude that they grow with.
MOST_POWER = 12.0
# A solution without its noise is one if its residuals are this many times their rounding, as of any solution.
ROUNDED = 20.0
# What an unknown moves by is rounding noise of zero below this part of what it may be.
_NOTHING = 1e-13


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


def initial_magnitudes(
    problem: Problem, z: np.ndarray, linearization: Linearization, parameter_weight: float
) -> np.ndarray:
    """Typical magnitudes at a start, shape (N + 1,), NaN where nothing tells.

    Beside what solution and equations tell, an unknown that does not tell its own is given how far it moves
    while the parameter changes by its weight, or an unknown that is not zero by its own size.
    """
    spread = _spread(linearization)
    clean = _without_noise(problem, z, linearization, spread)
    magnitudes = clean.magnitudes
    sized = np.abs(z) >= 0.5 * np.nan_to_num(magnitudes)
    sized &= np.isfinite(magnitudes) & (magnitudes > 0.0)
    known = np.where(np.isfinite(magnitudes) & (magnitudes > 0.0), magnitudes, 1.0)
    known[-1] = parameter_weight
    tangent = np.abs(kernel_direction(linearization.jacobian, known))
    sized[-1] = True
    # A parameter that stands still along a curve moves by rounding: others would be told endlessly far.
    moving = sized & (tangent > _NOTHING * known * float(np.max(tangent / known)))
    if not np.any(moving):
        return magnitudes
    moved = tangent * float(np.min(known[moving] / tangent[moving]))
    still = tangent <= spread @ (EPSILON * (np.abs(linearization.jacobian) @ tangent))
    moved[(moved < _NOTHING * known) | still] = 0.0
    further = ~sized & (moved > 0.0)
    return np.where(further, np.fmax(magnitudes, moved), magnitudes)


def later_magnitudes(problem: Problem, sample: Sample, weights: np.ndarray, origin: Sample) -> np.ndarray:
    """Typical magnitudes where some were not known at the last point, shape (N + 1,), NaN where still so.

    One that begins to move is scaled by how far it moves with the others, not by how little it has moved yet.
    `origin` is where the walk began.
    """
    z = np.where(np.abs(sample.z) <= _NOTHING * weights, 0.0, sample.z)
    if problem.line.second is None:  # of two free parameters each is an unknown
        z[-1] = sample.parameter
    there = problem.linearize(z)
    known, powers = there.magnitudes, _by_power(sample, origin, weights)
    spread = _spread(there)
    powers[np.abs(sample.z - origin.z) <= spread @ there.levels[0]] = np.nan  # dust grows with no power
    stays = spread @ (EPSILON * (np.abs(there.jacobian) @ np.abs(sample.tangent)))
    moved = np.fmax(np.abs(sample.tangent), powers)
    # A declared scale may be one as well; it stays what it is.
    begins = (z != 0.0) & (moved > np.maximum(_NOTHING * weights, stays)) | np.isfinite(powers)
    begins &= known != UNKNOWN
    return np.where(begins, np.fmax(np.abs(z), moved), known)


def _by_power(sample: Sample, origin: Sample, weights: np.ndarray) -> np.ndarray:
    """How far each unknown moves over the arclength 1, as the power of it that it has moved by so far.

    Beside a branch point a harmonic grows like a power of the amplitude. In units of how little that is the
    others' way would be endless. NaN where no power tells, shape (N + 1,).
    """
    gone = sample.z - origin.z
    far = norm_in(gone, weights)
    powers = np.full(len(gone), np.nan)
    moves = (gone != 0.0) & (origin.z == 0.0)
    if not 0.0 < far < 1.0:
        return powers
    powers[moves] = far * sample.tangent[moves] / gone[moves]
    powers[~((powers > 1.0) & (powers <= MOST_POWER))] = np.nan
    moved: np.ndarray = np.abs(gone) * far**-powers
    return moved


def _without_noise(
    problem: Problem, z: np.ndarray, linearization: Linearization, spread: np.ndarray
) -> Linearization:
    """The equations at z, or where unknowns that are zero but for their error are exactly zero."""
    noisy = (np.abs(z) <= spread @ linearization.levels[0]) & (z != 0.0)
    if not np.any(noisy):
        return linearization
    clean = problem.linearize(np.where(noisy, 0.0, z))
    if not clean.finite or clean.excess > max(ROUNDED, linearization.excess):
        return linearization
    return clean


def _spread(linearization: Linearization) -> np.ndarray:
    """With errors of the equations, shape (N,), below what size each unknown is one, shape (N + 1, N).

    Zero for the parameter, which is held, and where the equations are singular.
    """
    square = linearization.jacobian[:, :-1]
    spread = np.zeros((len(square) + 1, len(square)))
    with suppress(np.linalg.LinAlgError):  # a fold or a branch point
        spread[:-1] = NOISE * np.abs(Factored(square).solve(np.eye(len(square))))
    return spread
