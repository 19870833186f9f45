"""Units of an orbit's equations and unknowns."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.orbit_data import OrbitData


def equation_scales(orbit: OrbitData) -> np.ndarray:
    """Units of the equations, shape (N,)."""
    scales, variation = np.ones(orbit.size), orbit.mesh.variation
    for i, rows in enumerate(orbit.layout.matches):
        scales[rows] = variation[list(orbit.passages[i].following)]
    for segment in orbit.layout.segments:
        if not segment.last:
            scales[segment.ends] = variation[list(orbit.passages[segment.leg].states)]
    scales[orbit.layout.guards : orbit.layout.guards + orbit.layout.legs] = orbit.guard_scales
    return scales


def cycle_scales(orbit: OrbitData) -> tuple[np.ndarray, np.ndarray]:
    """Units of the rows and of the columns of `cycle_matrix`."""
    columns = orbit.known.on(orbit.mesh, "scales of unknowns", lambda: unknown_scales(orbit))
    return orbit.equation_scales, columns.copy()


def unknown_scales(orbit: OrbitData) -> np.ndarray:
    """Units of the unknowns, shape (N,)."""
    columns = np.ones(orbit.size)
    for place, passage in orbit.places:
        columns[place] = orbit.mesh.variation[list(passage.states)]
    columns[orbit.layout.durations] = orbit.mesh.total
    if orbit.layout.start is not None:
        columns[orbit.layout.start] = orbit.mesh.total
    return columns
