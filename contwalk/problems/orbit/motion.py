"""What is told of the whole motion of an orbit, whichever events it meets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.problems.orbit.extrema import extremes_of
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.slow_place import AROUND, SlowPlace, slow_places_on
from contwalk.problems.orbit.undefined import refusal


def motion(orbit: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times in seconds, shape (k,), and states, (k, n), of z, shape (N + 1,); both sides of each event."""
    found = [stretch.motion for stretch in orbit.stretches(z)]
    return np.concatenate([t for t, _ in found]), np.concatenate([x for _, x in found])


def extremes(orbit: OrbitData, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest value of each state over the whole orbit of z, shapes (n,), where the state exists.

    NaN of an angle that goes round: it has neither. z has the shape (N + 1,).

    Raises
    ------
    NotFinite
        Where the motion has no value on a part of its way.
    """
    found = orbit.stretches(z)
    low, high = extremes_of([s.smooth for s in found], [np.array(s.exists) for s in found])
    if np.isnan(low).any():
        raise refusal(orbit.diagnosis.without_value(z))
    neither = (orbit.turns != 0.0) | np.isinf(high)
    low[neither] = high[neither] = np.nan
    return low, high


def slow_places(orbit: OrbitData, z: np.ndarray) -> list[SlowPlace]:
    """Where the orbit of z, shape (N + 1,), is slower than beside, and the field there; the slowest first."""
    orbit, z = orbit.explicit(z)
    places = list[SlowPlace]()
    for view in orbit.view(z):
        if view.duration == 0.0:
            continue
        times, path = view.sampled(AROUND)
        passage = view.piece.passage
        own = list(passage.states)
        scale, names = orbit.mesh.variation[own], tuple(orbit.system.state_names[k] for k in own)
        places += slow_places_on(passage, view.values, abs(view.duration), times, path, scale, names)
    fastest = max((place.fastest for place in places), default=0.0)
    return sorted((replace(place, fastest=fastest) for place in places), key=lambda place: place.speed)
