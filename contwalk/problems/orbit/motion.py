"""What is told of the whole motion of an orbit, whichever events it meets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.images import imaged
from contwalk.problems.orbit.closure import closure_image
from contwalk.problems.orbit.extrema import extremes_of
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.slow_place import AROUND, SlowPlace, slow_places_on
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.orbit.undefined import refusal
from contwalk.system.declarations import ParameterValues


def stretches(orbit: OrbitData, z: np.ndarray) -> list[Stretch[Any]]:
    """The legs of the whole motion; of an orbit that closes up to a symmetry, their images follow.

    z has the shape (N + 1,).
    """
    # What is returned is kept with the orbit, and does not keep it.
    views, itinerary, system, pins = orbit.view(z), orbit.itinerary, orbit.system, orbit.pins
    values, length, legs = orbit.values_of(z), orbit.duration(z), itinerary.legs
    # A motion in times of the closure is told as by one who drifts along with it.
    drifts = np.zeros(0) if orbit.in_closure else z[orbit.layout.drifts]
    begins, p, found = views[0].start, ParameterValues(**values), list[Stretch[Any]]()

    def drifted(times: np.ndarray, states: np.ndarray) -> np.ndarray:
        if not len(drifts):
            return states
        return neutrals.shifted(system, pins, states, values, -(times - begins)[:, None] * drifts)

    def seen(number: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        def image(times: np.ndarray, states: np.ndarray) -> np.ndarray:
            images = closure_image(system, itinerary, drifted(times, states), p, number)
            # What has drifted until the closures before are over.
            return drifted(np.full(len(times), begins + number * length), images)

        return image if number else drifted

    for number in range(itinerary.closures):
        later, own = number * length, seen(number)
        found += [
            Stretch(leg.name, view, later, own, system.states_of(leg.mode))
            for leg, view in zip(legs, views, strict=True)
        ]
        if itinerary.image:
            legs = tuple(imaged_leg(system, itinerary.image, leg) for leg in legs)
    return found


def growth(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """By how much each state is larger after the whole motion: turns of angles, and drifts.

    z has the shape (N + 1,), the growth (n,).
    """
    x, values = orbit.first_state(z), orbit.values_of(z)
    along = neutrals.directions(orbit.system, orbit.pins, x, values)
    drift = -orbit.duration(z) * along @ z[orbit.layout.drifts]
    if orbit.itinerary.image:
        symmetry, p = orbit.system.symmetry(orbit.itinerary.image), ParameterValues(**values)
        drift = drift + imaged(symmetry, x + drift, p) - imaged(symmetry, x, p)
    return orbit.turns + drift


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
