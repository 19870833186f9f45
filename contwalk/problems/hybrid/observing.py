"""What is told of a hybrid orbit: its motion, its observables, the state that stands for it."""

from __future__ import annotations

import numpy as np

from contwalk import quantities
from contwalk.errors import measured
from contwalk.problems import neutral as neutrals
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.images import imaged
from contwalk.problems.orbit.closure import images_of
from contwalk.problems.orbit.itinerary import imaged_leg
from contwalk.problems.orbit.motion import extremes, motion
from contwalk.problems.orbit.multipliers import Multipliers
from contwalk.problems.orbit.sampling import MOST_BISECTIONS
from contwalk.problems.orbit.stretch import Stretch
from contwalk.problems.passing import Place
from contwalk.system.declarations import ParameterValues

# A section's instant is bracketed by interpolation so nearly, in parts of its leg, and then stepped to.
NEARLY, MOST_SECANTS = 1e-6, 4
# Multipliers this small are zero but for errors.
NOTHING = 1e-6


def stretches(problem: LimitedOrbit, z: np.ndarray) -> list[Stretch[LegView]]:
    """The legs of the whole motion; of an orbit that closes up to a symmetry, their images follow.

    z has the shape (N + 1,).
    """
    # What is returned is kept with the problem, and does not keep it.
    views, itinerary, system, pins = problem.view(z), problem.itinerary, problem.system, problem.pins
    drifts, values = z[problem.layout.drifts], problem.values_of(z)
    begins, length = float(problem.starting_times(z)[0]), problem.duration(z)

    def drifted(times: np.ndarray, states: np.ndarray) -> np.ndarray:
        if not len(drifts):
            return states
        shares = -(times - begins)[:, None] * drifts
        return neutrals.shifted(system, pins, states, values, shares)

    found = [
        Stretch(leg.name, view, 0.0, drifted, system.states_of(leg.mode))
        for leg, view in zip(itinerary.legs, views, strict=True)
    ]
    if not itinerary.image:
        return found
    symmetry, p = system.symmetry(itinerary.image), ParameterValues(**values)

    def image(times: np.ndarray, states: np.ndarray) -> np.ndarray:
        images = images_of(symmetry, drifted(times, states), p)
        # What has drifted until the half is over.
        return drifted(np.full(len(times), begins + length), images)

    legs = [imaged_leg(system, itinerary.image, leg) for leg in itinerary.legs]
    return found + [
        Stretch(leg.name, view, length, image, system.states_of(leg.mode))
        for leg, view in zip(legs, views, strict=True)
    ]


def place(problem: LimitedOrbit) -> str:
    """Where the stored state is taken, in words; empty where nothing marks the instant."""
    if problem.discretization.report_at is not None:
        return "at a section"
    return " ".join(reversed(_reporting(problem))) if visits(problem) else ""


def visits(problem: LimitedOrbit) -> int:
    """How often the whole orbit meets the event at which its state is reported; 0 where there is none."""
    if problem.discretization.report_at is not None or not problem.itinerary.eventful:
        return 0
    return [leg.name for leg in problem.itinerary.unfolded(problem.system).legs].count(_reporting(problem)[0])


def visited(problem: LimitedOrbit, z: np.ndarray) -> list[float]:
    """States at all of these events but the first, one after the other. z has the shape (N + 1,)."""
    if visits(problem) < 2:
        return []
    name, side = _reporting(problem)
    found = problem.stretches(z)
    ends = [k for k in range(-1, len(found) - 1) if found[k].name == name][1:]
    states = [found[k].end[1] if side == "before" else found[k + 1].start[1] for k in ends]
    return [float(value) for x in states for value in held(problem, z, x)]


def _reporting(problem: LimitedOrbit) -> tuple[str, str]:
    """The event at which the state is reported, and on which side of it."""
    asked = problem.discretization.report_event
    return asked or (problem.itinerary.unfolded(problem.system).legs[-1].name, "before")


def value(problem: LimitedOrbit, name: str, z: np.ndarray) -> float:
    """The value of one observable. z has the shape (N + 1,)."""
    found = problem.multipliers(z, problem.linearize(z).jacobian)
    told = quantities.column(name, problem.observable_names, problem.observables(z, found))
    assert told is not None, name
    return float(told)


def values(problem: LimitedOrbit, z: np.ndarray, found: Multipliers) -> list[float]:
    """Values of `observable_names`. z has the shape (N + 1,)."""
    problem, z = problem.explicit(z)
    margins = problem.margins(z)
    p = ParameterValues(**problem.values_of(z))
    own = problem.system.observables
    t, x = motion(problem, z) if any(o.at is None for o in own) else (np.zeros(0), np.zeros((0, 0)))
    result = []
    for o in own:
        if o.at is None:
            place: tuple[float | np.ndarray, np.ndarray] | None = (t, x)
        else:
            place = at_event(problem, z, o.at, o.side)
        if place is None:
            result.append(float("nan"))
        else:
            result.append(measured(f"observable '{o.name}'", o.function, place[0], place[1], p))
    if problem.system.has_events:
        named = [name for name in problem.system.margins if name not in [o.name for o in own]]
        result += [*(margins.least(name) for name in named), split(found.values)]
    largest = float(np.abs(found.values[0])) if len(found.values) else float("nan")
    low, high = extremes(problem, z)
    return [*result, *high.tolist(), *low.tolist(), *visited(problem, z), largest]


def split(multipliers: np.ndarray) -> float:
    """Signed square of the smallest difference of two multipliers: negative of a complex pair.

    It is smooth where two real multipliers meet and become a pair, and passes zero there. Those that are zero
    but for errors, of what a motion forgets, are left out.

    Shape (m,).
    """
    best, finite = np.nan, multipliers[np.isfinite(multipliers) & (np.abs(multipliers) > NOTHING)]
    for k, a in enumerate(finite):
        for b in finite[k + 1 :]:
            square = (a - b) ** 2
            if (a.imag == 0.0) != (b.imag == 0.0) or (a.imag != 0.0 and b != np.conj(a)):
                continue
            if not abs(square.real) >= abs(best):
                best = float(square.real)
    return best


def at_event(problem: LimitedOrbit, z: np.ndarray, name: str, side: str) -> tuple[float, np.ndarray] | None:
    """Time and full state before or after the first event of a name; None if the orbit has none.

    z has the shape (N + 1,), the state (n,).
    """
    found = problem.stretches(z)
    for k in range(-1, len(found) - 1):
        if found[k].name == name:
            return found[k].end if side == "before" else found[k + 1].start
    return None


def reported(problem: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """The state before the first event of the signature, or where the run asks for it, shape (n,).

    Along pinned directions it is moved to where these are held.
    """
    problem, z = problem.explicit(z)
    place, event = problem.discretization.report_at, problem.discretization.report_event
    if event is not None:
        found = at_event(problem, z, *event)
        x = np.full(problem.states, np.nan) if found is None else found[1]
    elif place is not None:
        x = _passing(problem, z, Place.of(problem.system, *place))
    elif not problem.itinerary.eventful:
        return problem.first_state(z)
    else:
        x = problem.stretches(z)[-1].end[1]
    return held(problem, z, x)


def held(problem: LimitedOrbit, z: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A state moved along the pinned directions to where these are held.

    z has the shape (N + 1,), states (n,).
    """
    values = problem.values_of(z)
    for pin, v in zip(
        problem.pins, neutrals.directions(problem.system, problem.pins, x, values).T, strict=True
    ):
        normal, apart = problem.held(pin, x, values)
        x = x - v * apart / float(normal @ v)
    return x


def _passing(problem: LimitedOrbit, z: np.ndarray, place: Place) -> np.ndarray:
    """The state at which the motion first passes a value of a state inside a leg; NaN if it never does."""
    stretches = problem.stretches(z)
    if not problem.itinerary.eventful:
        begun = place.begun_at(np.concatenate([stretch.motion[1] for stretch in stretches]))
        if begun is not None:
            return begun
    for stretch in stretches:
        t, x = stretch.motion
        found = place.passed(x)
        if found is None:
            continue
        view, (k, turn) = stretch.view, found
        low, high = ((t[j] - stretch.later - view.start) / view.duration for j in (k, k + 1))
        for _ in range(MOST_BISECTIONS):
            middle = 0.5 * (low + high)
            there = stretch.at(np.array([middle]))[1][0]
            low, high = (middle, high) if place.beyond(there) < turn else (low, middle)
            if high - low < NEARLY:
                break
        return place.told(_refined(stretch, place, turn, low), turn)
    return np.full(problem.states, np.nan)


def _refined(stretch: Stretch[LegView], place: Place, turn: float, near: float) -> np.ndarray:
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


def growth(orbit: LimitedOrbit, z: np.ndarray) -> np.ndarray:
    """By how much each state is larger after the whole motion: turns of angles, and drifts.

    z has the shape (N + 1,), the growth (n,).
    """
    x, values = orbit.first_state(z), orbit.values_of(z)
    drift = (
        -orbit.duration(z) * neutrals.directions(orbit.system, orbit.pins, x, values) @ z[orbit.layout.drifts]
    )
    if orbit.itinerary.image:
        symmetry, p = orbit.system.symmetry(orbit.itinerary.image), ParameterValues(**values)
        drift = drift + imaged(symmetry, x + drift, p) - imaged(symmetry, x, p)
    return orbit.turns + drift
