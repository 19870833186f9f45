"""The state that stands for an orbit: at an event, on a section, or where its phase is fixed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contwalk.problems import neutral as neutrals
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.passing import Place

MOST_BISECTIONS = 60
# A section's instant is bracketed by interpolation so nearly, in parts of its leg; of legs in their own times
# it is then stepped to.
ROUNDED, NEARLY, MOST_SECANTS = 1e-15, 1e-6, 4


def reported(orbit: OrbitData, z: np.ndarray) -> np.ndarray:
    """The state before the first event of the signature, where there is none at the phase condition's point,
    or where the run asks for it, shape (n,); NaN if it never is there.

    z has the shape (N + 1,). Of legs in their own times it is moved along pinned directions to where these
    are held.
    """
    orbit, z = orbit.explicit(z)
    place, event = orbit.discretization.report_at, orbit.discretization.report_event
    if event is not None and not orbit.in_closure:
        found = at_event(orbit, z, *event)
        x = np.full(orbit.states, np.nan) if found is None else found[1]
    elif place is not None:
        stepped, comes_back = not orbit.in_closure, not orbit.itinerary.eventful
        x = crossing(orbit.stretches(z), Place.of(orbit.system, *place), stepped, comes_back)
    elif not orbit.itinerary.eventful:
        return orbit.first_state(z)
    else:
        x = orbit.stretches(z)[-1].end[1]
    return x if orbit.in_closure else held(orbit, z, x)


def held(orbit: OrbitData, z: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A state moved along the pinned directions to where these are held.

    z has the shape (N + 1,), states (n,).
    """
    values = orbit.values_of(z)
    along = neutrals.directions(orbit.system, orbit.pins, x, values).T
    for pin, v in zip(orbit.pins, along, strict=True):
        normal, apart = orbit.held(pin, x, values)
        x = x - v * apart / float(normal @ v)
    return x


# -- at events ---------------------------------------------------------------------------------------------


def place(orbit: OrbitData) -> str:
    """Where the stored state is taken, in words; empty where nothing marks the instant."""
    if orbit.discretization.report_at is not None:
        return "at a section"
    return " ".join(reversed(_reporting(orbit))) if visits(orbit) else ""


def visits(orbit: OrbitData) -> int:
    """How often the whole orbit meets the event at which its state is reported; 0 where there is none."""
    if orbit.discretization.report_at is not None or not orbit.itinerary.eventful:
        return 0
    return [leg.name for leg in orbit.itinerary.unfolded(orbit.system).legs].count(_reporting(orbit)[0])


def visited(orbit: OrbitData, z: np.ndarray) -> list[float]:
    """States at all of these events but the first, one after the other. z has the shape (N + 1,)."""
    if visits(orbit) < 2:
        return []
    name, side = _reporting(orbit)
    found = orbit.stretches(z)
    ends = [k for k in range(-1, len(found) - 1) if found[k].name == name][1:]
    states = [found[k].end[1] if side == "before" else found[k + 1].start[1] for k in ends]
    return [float(value) for x in states for value in held(orbit, z, x)]


def _reporting(orbit: OrbitData) -> tuple[str, str]:
    """The event at which the state is reported, and on which side of it."""
    asked = orbit.discretization.report_event
    return asked or (orbit.itinerary.unfolded(orbit.system).legs[-1].name, "before")


def at_event(orbit: OrbitData, z: np.ndarray, name: str, side: str) -> tuple[float, np.ndarray] | None:
    """Time and full state before or after the first event of a name; None if the orbit has none.

    z has the shape (N + 1,), the state (n,).
    """
    found = orbit.stretches(z)
    for k in range(-1, len(found) - 1):
        if found[k].name == name:
            return found[k].end if side == "before" else found[k + 1].start
    return None


# -- on a section ------------------------------------------------------------------------------------------


def crossing(stretches: Sequence[Stretch[Any]], place: Place, stepped: bool, comes_back: bool) -> np.ndarray:
    """The state at which a motion first passes a value of a state inside a leg; NaN if it never does.

    Parameters
    ----------
    stretches : sequence of Stretch
    place : Place
    stepped : bool
        Whether steps are cut to end there; else interpolation tells.
    comes_back : bool
        The motion has no events, and returns to where it begins: it may pass there, or between two stretches.
    """
    motions = [stretch.motion for stretch in stretches]
    if comes_back:
        begun = place.begun_at(np.concatenate([x for _, x in motions]))
        if begun is not None:
            return begun
    together = [range(len(motions))] if comes_back else [[number] for number in range(len(motions))]
    for numbers in together:
        times, states = (np.concatenate(part) for part in zip(*(motions[k] for k in numbers), strict=True))
        found = place.passed(states)
        if found is None:
            continue
        k, turn = found
        ends = np.cumsum([len(motions[number][0]) for number in numbers])
        stretch = stretches[numbers[int(np.searchsorted(ends, k, side="right"))]]
        return place.told(_located(stretch, place, turn, times[k : k + 2], stepped), turn)
    return np.full(motions[0][1].shape[1], np.nan)


def _located(
    stretch: Stretch[Any], place: Place, turn: float, times: np.ndarray, stepped: bool
) -> np.ndarray:
    """The state at which a value is passed between two instants of a leg, in seconds."""
    view, there = stretch.view, np.zeros(0)
    low, high = (times - stretch.later - view.start) / view.duration
    for _ in range(MOST_BISECTIONS):
        middle = 0.5 * (low + high)
        there = stretch.at(np.array([min(middle, 1.0)]))[1][0]
        low, high = (middle, high) if place.beyond(there) < turn else (low, middle)
        if high - low < (NEARLY if stepped else ROUNDED):
            break
    return _refined(stretch, place, turn, low) if stepped else there


def _refined(stretch: Stretch[Any], place: Place, turn: float, near: float) -> np.ndarray:
    """The state at which a value is passed, on steps that end there: by the secant method."""

    def at(share: float) -> np.ndarray:
        time = stretch.view.start + stretch.view.duration * share
        return stretch.seen(np.array([time]), stretch.view.full(stretch.view.stepped(share))[None])[0]

    a, b = near, near + NEARLY if near < 0.5 else near - NEARLY
    here, there = at(a), at(b)
    for _ in range(MOST_SECANTS):
        before, after = (float(place.beyond(x)) - turn for x in (here, there))
        if after == before or b == a:
            break
        a, b, here = b, b - after * (b - a) / (after - before), there
        there = at(b)
    return there
