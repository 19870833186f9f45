"""Orbits and directions of branches moved along pinned directions, so that these are held where they are."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit import monodromy
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.scales import cycle_scales

# Shifts along pinned directions that are tried, and how little they leave of the residual.
MOST_SHIFTS, SHIFTED = 5, 2.0


def shifted(problem: OrbitData, z: np.ndarray) -> np.ndarray:
    """An orbit that is right but for drifts and for its starts along pinned directions, with these.

    Both have the shape (N + 1,).
    """
    z = z.copy()
    if not problem.pins:
        return z
    rows = problem.equation_scales
    for _ in range(MOST_SHIFTS):
        here, along = problem.linearize(z), _along_pins(problem, z)
        scaled = here.jacobian @ along / rows[:, None]
        z = z - along @ np.linalg.lstsq(scaled, here.residual / rows, rcond=None)[0]
        if problem.linearize(z).excess <= SHIFTED:
            break
    return z


def held(problem: OrbitData, start: np.ndarray, tangent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An orbit and a direction in which orbits leave it, as one sees them who drifts along all of the cycle.

    Each part was seen by one who drifts so that it alone closes. What lies across the pinned directions is
    right; the parts along them follow from the equations.

    All have the shape (N + 1,).
    """
    start, rows = shifted(problem, start), problem.equation_scales
    weights = np.append(cycle_scales(problem)[1], 1.0)
    plane = (
        weights[:, None]
        * np.linalg.svd(problem.linearize(start).jacobian / rows[:, None] * weights)[2][-2:].T
    )
    along = _along_pins(problem, start) / weights[:, None]

    def across(vectors: np.ndarray) -> np.ndarray:
        scaled = vectors / weights[:, None]
        return scaled - along @ np.linalg.lstsq(along, scaled, rcond=None)[0]

    shares = np.linalg.lstsq(across(plane), across(tangent[:, None]), rcond=None)[0]
    return start, (plane @ shares)[:, 0]


def _along_pins(problem: OrbitData, z: np.ndarray) -> np.ndarray:
    """Directions in which the starts of segments move along pinned directions, and the drifts, as columns."""
    layout, columns = problem.layout, []
    for i, n in enumerate(layout.sizes):
        for j, segment in enumerate(layout.segments_of(i)):
            for direction in monodromy.pinned_directions(problem, z, i, j):
                column = np.zeros(layout.size + 1)
                column[segment.states] = direction[:n]
                columns.append(column)
    return np.column_stack([*columns, np.eye(layout.size + 1)[:, layout.drifts]])
