"""How near a state is to an orbit."""

from __future__ import annotations

import numpy as np

from contwalk.problems.angles import whole_turns

# How far beyond three samples the parabola through them is taken for the curve, in their spacing.
FARTHEST = 1.5


def distance(curve: np.ndarray, x: np.ndarray, periods: np.ndarray, scale: np.ndarray) -> float:
    """How far a state is from a curve of states, (k, n), across it, in units of `scale`.

    Angles, of which the `periods` are positive, count modulo these. A curve that comes by several times, as
    doubled orbits do, may be nearest where no sample is: each time it does is looked at.
    """
    apart = x - curve
    apart = (apart - whole_turns(apart, periods)) / scale
    away = np.linalg.norm(apart, axis=1)
    nearest = float(away.min())
    if len(curve) < 3:
        return nearest
    for least, k in _places_to_look_at(apart, away):
        if least > nearest:
            break
        nearest = min(nearest, _from_parabola(*apart[k - 1 : k + 2]))
    return nearest


def _places_to_look_at(apart: np.ndarray, away: np.ndarray) -> list[tuple[float, int]]:
    """No more than how near the curve comes around a sample, and its number, for each time it comes by.

    The nearest first. What is `apart` has the shape (k, n), how far `away` it is (k,).
    """
    middles = _times_it_comes_by(away)
    before, here, after = (apart[middles + side] for side in (-1, 0, 1))
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    reach = FARTHEST * np.linalg.norm(slope, axis=1) + 0.5 * FARTHEST**2 * np.linalg.norm(bend, axis=1)
    return sorted(zip((away[middles] - reach).tolist(), middles.tolist(), strict=True))


def _times_it_comes_by(away: np.ndarray) -> np.ndarray:
    """Numbers of the samples that are no farther away than both beside them, those of the ends moved inwards.

    Distances have the shape (k,), k at least 3.
    """
    padded = np.concatenate([[np.inf], away, [np.inf]])
    least = np.flatnonzero((away <= padded[:-2]) & (away <= padded[2:]))
    return np.unique(np.clip(least, 1, len(away) - 2))


def _from_parabola(before: np.ndarray, here: np.ndarray, after: np.ndarray) -> float:
    """Least length on the parabola through three vectors, and a little beyond them.

    A chord would miss a curve that turns by the square of what lies between its samples.
    """
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    roots = np.roots(
        [0.5 * bend @ bend, 1.5 * slope @ bend, slope @ slope + here @ bend, here @ slope]
    )  # where its derivative is at a right angle to it
    places = np.clip(np.append(roots.real, [-1.0, 0.0, 1.0]), -FARTHEST, FARTHEST)[:, None]
    vectors = here + places * slope + 0.5 * places**2 * bend
    return float(np.linalg.norm(vectors, axis=1).min())
