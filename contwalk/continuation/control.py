"""Step control: how much a step turned, whether it stayed on its branch, and how long the next one may be."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contwalk.continuation.settings import Settings
from contwalk.numerics.linear import norm
from contwalk.problems.problem import Sample

# Largest factors from one step to the next.
GROWTH, DECAY = 1.6, 0.3
# Factors of the step after so many corrections, and between them.
BY_EFFORT = (1.0, 2.0, 3.0, 4.0), (2.0, 1.5, 1.2, 0.7)
# Shrinking after a failure: fast where the step is small already.
SHRINK, PLUNGE, SMALL = 0.4, 0.1, 1e-6
# What the chord of a step may be off the mean of its tangents: a part of the turn; where it hardly turns.
OF_TURN, NO_TURN = 0.25, 0.02
# Part of its slope by which a parabola's end may differ.
PARABOLIC = 0.1
# How far towards a jump a step goes, and which part of a step counts as near.
BEFORE, NEAR = 0.99, 0.25


def turn(a: Sample, tangent: np.ndarray) -> float:
    """Turn of the tangent, shape (N + 1,), in degrees, in the metric of `a`."""
    u, v = a.tangent / a.weights, tangent / a.weights
    cosine = float(u @ v / norm(u) / norm(v))
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def bend(a: Sample, z: np.ndarray, tangent: np.ndarray) -> float:
    """How far the chord's direction is from the mean of the tangents at its ends.

    z, where the chord from `a` ends, and the tangent there have the shape (N + 1,). On a smooth arc it is an
    eighth of the square of the turn. A step onto another branch that happens to point the same way keeps the
    tangents alike, but not the chord.
    """
    chord = (z - a.z) / a.weights
    u, v = a.tangent / a.weights, tangent / a.weights
    mean = 0.5 * (u / norm(u) + v / norm(v))
    return float(norm(chord / norm(chord) - mean))


def left_branch(a: Sample, z: np.ndarray, tangent: np.ndarray, angle: float) -> bool:
    """Whether a step seems to have ended on another branch: its chord departs too far for how it turns.

    z, where it ends, and the tangent there have the shape (N + 1,); `angle` is its turn in degrees.
    """
    return bend(a, z, tangent) > max(OF_TURN * np.radians(angle), NO_TURN)


def inside(z: np.ndarray, bounds: Mapping[int, tuple[float, float]]) -> bool:
    """Whether the free parameters of z, shape (N + 1,), are within bounds that are given by their places."""
    return all(low <= z[place] <= high for place, (low, high) in bounds.items())


def is_parabola(a: Sample, z: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether an arc from `a` goes as z_a + h t + h^2 q / 2: where it ends and its tangent there agree.

    z, where it ends, and the tangent there have the shape (N + 1,).
    """
    along, chord, there = a.tangent / a.weights, (z - a.z) / a.weights, tangent / a.weights
    along = along / norm(along)
    h, ahead = float(along @ chord), float(along @ there)
    if not (h > 0.0 and ahead > 0.0):
        return False
    bent, turned = chord / h - along, there / ahead - along
    return bool(norm(turned - 2.0 * bent) <= PARABOLIC * norm(turned))


def next_step(length: float, angle: float, effort: float, settings: Settings) -> float:
    """Step length from curvature (half the largest angle is aimed at) and from the corrector's effort.

    `effort` is a real number of corrections, so that no last bit decides on a length.
    """
    by_angle = 0.5 * settings.max_angle / max(angle, 1e-3)
    by_effort = np.interp(effort, *BY_EFFORT)
    return float(
        np.clip(
            length * np.clip(min(by_angle, by_effort), DECAY, GROWTH), settings.min_step, settings.max_step
        )
    )


def shrunk(step: float) -> float:
    """The next shorter step to try."""
    return step * (SHRINK if step > SMALL else PLUNGE)


def beside(step: float, share: float) -> float:
    """The next step to try where one passes a jump after a part of it: one that ends right before it, or, if
    that is near, one that shows whether it is there.
    """
    return step * (BEFORE * share if share > NEAR else max(2.0 * share, PLUNGE**2))


def longest(sample: Sample, settings: Settings) -> float:
    """The step that moves a parameter by the largest share of its range: curves look smooth."""
    longest = np.inf
    for place, (low, high) in settings.bounds.items():
        moved = abs(sample.tangent[place])
        longest = min(longest, settings.max_share * (high - low) / moved if moved > 0.0 else np.inf)
    return longest
