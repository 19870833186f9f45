"""Typical magnitudes of the unknowns of an orbit through events."""

from __future__ import annotations

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.shooting import AT_REST
from contwalk.problems.orbit.closure import imaged
from contwalk.system.declarations import ParameterValues


def magnitudes_near(orbit: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """Half the range of each state over the orbit; declared scales where there are any.

    Both have the shape (N + 1,).
    """
    every = states_along(orbit, z)
    half = 0.5 * np.ptp(every, axis=0)
    if orbit.itinerary.image and not np.all(half > 0.0):  # held until the image follows
        whole = np.vstack([every, _images(orbit, z, every)])
        half = np.where(half > 0.0, half, 0.5 * np.ptp(whole, axis=0))
    largest = np.maximum(np.abs(every).max(axis=0), orbit.mesh.magnitudes)
    shares = half / largest
    moves = float(shares.max()) > AT_REST
    half = np.where(moves & (shares > max(1e-5 * float(shares.max()), 1e-13)), half, np.nan)
    for i, state in enumerate(orbit.system.states):
        if state.scale is not None:
            half[i] = state.scale
    result, m = np.full(orbit.size + 1, np.nan), orbit.layout.legs
    for place, passage in orbit.places:
        result[place] = half[list(passage.states)] * np.sqrt(len(orbit.layout.segments))
    total = abs(orbit.duration(z))
    result[orbit.layout.durations] = total * np.sqrt(m)
    if orbit.layout.start is not None:
        result[orbit.layout.start] = total
    result[orbit.layout.drifts] = drift_scales(orbit, z) * np.sqrt(m)
    result[-1] = abs(z[-1])
    return result


def states_along(orbit: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """States at the steps of all legs, shape (k, n). z has the shape (N + 1,)."""
    return np.concatenate([view.full(view.nodes) for view in orbit.view(z)])


def _images(orbit: LimitedOrbit, z: np.ndarray, states: np.ndarray) -> np.ndarray:
    """States of the part of the orbit that follows."""
    symmetry, p = orbit.system.symmetry(orbit.itinerary.image), ParameterValues(**orbit.values_of(z))
    return np.array([imaged(symmetry, x, p) for x in states])


def drift_scales(orbit: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """Drifts that move states by their variation in a closure, or those that there are, if larger.

    z has the shape (N + 1,), the drifts (k,).
    """
    x, variation = orbit.first_state(z), orbit.mesh.variation
    along = neutrals.directions(orbit.system, orbit.pins, x, orbit.values_of(z)) / variation[:, None]
    typical = 1.0 / (np.linalg.norm(along, axis=0) * abs(orbit.duration(z)))
    return np.maximum(typical, np.abs(z[orbit.layout.drifts]))


def beginnings(orbit: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
    result = np.ones(orbit.size + 1)
    for place, passage in orbit.places:
        result[place] = orbit.mesh.variation[list(passage.states)]
    result[orbit.layout.durations] = abs(orbit.duration(z))
    if orbit.layout.start is not None:
        result[orbit.layout.start] = abs(orbit.duration(z))
    result[orbit.layout.drifts] = drift_scales(orbit, z)
    result[-1] = max(abs(float(z[-1])), 1e-300)
    return result
