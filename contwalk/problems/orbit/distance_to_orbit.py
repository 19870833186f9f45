"""How near a state is to an orbit."""

from __future__ import annotations

import numpy as np

from contwalk.problems.angles import whole_turns


def distance(curve: np.ndarray, x: np.ndarray, periods: np.ndarray, scale: np.ndarray) -> float:
    """How far a state is from a curve of states, (k, n), across it, in units of `scale`.

    Angles, of which the `periods` are positive, count modulo these.
    """
    apart = x - curve
    apart = (apart - whole_turns(apart, periods)) / scale
    k = int(np.argmin(np.linalg.norm(apart, axis=1)))
    if len(curve) < 3:
        return float(np.linalg.norm(apart[k]))
    middle = min(max(k, 1), len(curve) - 2)
    return _from_parabola(*apart[middle - 1 : middle + 2])


def _from_parabola(before: np.ndarray, here: np.ndarray, after: np.ndarray) -> float:
    """Least length on the parabola through three vectors, and a little beyond them.

    A chord would miss a curve that turns by the square of what lies between its samples.
    """
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    roots = np.roots(
        [0.5 * bend @ bend, 1.5 * slope @ bend, slope @ slope + here @ bend, here @ slope]
    )  # where its derivative is at a right angle to it
    places = np.clip(np.append(roots.real, [-1.0, 0.0, 1.0]), -1.5, 1.5)[:, None]
    vectors = here + places * slope + 0.5 * places**2 * bend
    return float(np.linalg.norm(vectors, axis=1).min())
