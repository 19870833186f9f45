"""Units of an orbit's equations and unknowns."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.orbit_data import OrbitData


def equation_scales(orbit: OrbitData, weights: np.ndarray | None = None) -> np.ndarray:
    """Units of the equations, shape (N,): those of states as of `variation`."""
    scales, each = np.ones(orbit.size), variation(orbit, weights)
    for i, rows in enumerate(orbit.layout.matches):
        scales[rows] = each[list(orbit.passages[i].following)]
    for segment in orbit.layout.segments:
        if not segment.last:
            scales[segment.ends] = each[list(orbit.passages[segment.leg].states)]
    scales[orbit.layout.guards : orbit.layout.guards + orbit.layout.legs] = orbit.guard_scales
    return scales


def variation(orbit: OrbitData, weights: np.ndarray | None) -> np.ndarray:
    """How far each state varies, or as much as its weights say, of shape (N + 1,); shape (n,).

    One that a symmetry keeps at zero on an orbit has no size of its own beside it.
    """
    found = orbit.mesh.variation.copy()
    if weights is not None:
        for place, passage in orbit.places:
            states = list(passage.states)
            found[states] = np.maximum(found[states], weights[place])
    return found


def cycle_scales(orbit: OrbitData, weights: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Units of the rows and of the columns of `cycle_matrix`, those of states as of `variation`."""
    if weights is not None:
        return equation_scales(orbit, weights), unknown_scales(orbit, weights)
    columns = orbit.known.on(orbit.mesh, "scales of unknowns", lambda: unknown_scales(orbit))
    return orbit.equation_scales, columns.copy()


def unknown_scales(orbit: OrbitData, weights: np.ndarray | None = None) -> np.ndarray:
    """Units of the unknowns, shape (N,): those of states as of `variation`."""
    columns, each = np.ones(orbit.size), variation(orbit, weights)
    for place, passage in orbit.places:
        columns[place] = each[list(passage.states)]
    columns[orbit.layout.durations] = orbit.mesh.total
    if orbit.layout.start is not None:
        columns[orbit.layout.start] = orbit.mesh.total
    return columns
