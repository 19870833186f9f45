"""Typical magnitudes of the unknowns of an orbit."""

from __future__ import annotations

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.closure import images_of
from contwalk.problems.orbit.extents import extent_along, states_along
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.shooting import AT_REST, CONSTANT
from contwalk.system.declarations import ParameterValues

# A closure that moves less than this part of its magnitudes is a point.
POINT = 1e-10
# What moves less than this part of its size moves by rounding.
ROUNDED = 1e-13


def magnitudes_near(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """Half the range of each state over the orbit; declared scales where there are any.

    Both have the shape (N + 1,).
    """
    low, high = extent_along(orbit, z)
    half = 0.5 * (high - low)
    if orbit.itinerary.image and not orbit.in_closure and not np.all(half > 0.0):  # held until its image
        half = np.where(half > 0.0, half, _half_with_images(orbit, z))
    half = np.where(_told(orbit, half, np.maximum(np.abs(low), np.abs(high))), half, np.nan)
    for i, state in enumerate(orbit.system.states):
        if state.scale is not None:
            half[i] = state.scale
    result, layout = np.full(orbit.size + 1, np.nan), orbit.layout
    for place, passage in orbit.places:
        result[place] = half[list(passage.states)] * np.sqrt(len(layout.segments))
    legs = np.sqrt(layout.legs)
    _time(orbit, z, result, legs)
    if not orbit.in_closure:  # there drifts are zero; what they are is noise
        result[layout.drifts] = drift_scales(orbit, z) * legs
    result[-1] = abs(z[-1])
    return result


def beginnings(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """Typical magnitudes for the first corrections of a start, shape (N + 1,)."""
    result, layout = np.ones(orbit.size + 1), orbit.layout
    for place, passage in orbit.places:
        result[place] = orbit.mesh.variation[list(passage.states)]
    _time(orbit, z, result)
    if not orbit.in_closure:
        result[layout.drifts] = drift_scales(orbit, z)
    result[-1] = max(abs(float(z[-1])), 1e-300)
    return result


def drift_scales(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """Drifts that move states by their variation in a closure, or those that there are, if larger.

    z has the shape (N + 1,), the drifts (k,).
    """
    x, variation = orbit.first_state(z), orbit.mesh.variation
    along = neutrals.directions(orbit.system, orbit.pins, x, orbit.values_of(z)) / variation[:, None]
    typical = 1.0 / (np.linalg.norm(along, axis=0) * abs(orbit.duration(z)))
    return np.maximum(typical, np.abs(z[orbit.layout.drifts]))


def _time(orbit: OrbitData, z: np.ndarray, magnitudes: np.ndarray, legs: float = 1.0) -> None:
    """Fill in those of durations, as of so many legs, of the start and of times of cuts."""
    layout = orbit.layout
    if layout.durations.stop > layout.durations.start:
        total = abs(orbit.duration(z))
        magnitudes[layout.durations] = total * legs
        if layout.start is not None:
            magnitudes[layout.start] = total
    if layout.times is not None:
        magnitudes[layout.inside] = 1.0


def _told(orbit: OrbitData, half: np.ndarray, largest: np.ndarray) -> np.ndarray:
    """Which states tell a magnitude: a point tells nothing, what it moves is rounding. Shape (n,)."""
    mesh = orbit.mesh
    shares = half / np.maximum(largest, mesh.variation if orbit.in_closure else mesh.magnitudes)
    most = float(shares.max())
    moves = np.any(half > POINT * mesh.magnitudes) if orbit.in_closure else most > AT_REST
    told: np.ndarray = moves & (shares > max(CONSTANT * most, ROUNDED))
    return told


def _half_with_images(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """Half the range of each state over the orbit and the part of it that follows. Shape (n,)."""
    every = states_along(orbit, z)
    symmetry, p = orbit.system.symmetry(orbit.itinerary.image), ParameterValues(**orbit.values_of(z))
    half: np.ndarray = 0.5 * np.ptp(np.vstack([every, images_of(symmetry, every, p)]), axis=0)
    return half
