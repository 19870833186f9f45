"""How near a state is to an orbit."""

from __future__ import annotations

import numpy as np


def distance(curve: np.ndarray, x: np.ndarray, periods: np.ndarray, scale: np.ndarray) -> float:
    """How far a state is from a curve of states, (k, n), across it, in units of `scale`.

    Angles, of which the `periods` are positive, count modulo these.
    """
    apart, turned = x - curve, periods > 0.0
    apart[:, turned] -= np.round(apart[:, turned] / periods[turned]) * periods[turned]
    k = int(np.argmin(np.linalg.norm(apart / scale, axis=1)))
    a, b = curve[max(k - 1, 0)] / scale, curve[min(k + 1, len(curve) - 1)] / scale
    return _off_chord(apart[k] / scale, b - a)


def _off_chord(vector: np.ndarray, chord: np.ndarray) -> float:
    """Length of a vector's part at a right angle to a chord."""
    size = float(chord @ chord)
    along = vector @ chord / size if size > 0.0 else 0.0
    return float(np.linalg.norm(vector - along * chord))
