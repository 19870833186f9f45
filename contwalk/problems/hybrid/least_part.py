"""The least part of an orbit that tells all of it: one period, and half of it where the rest is its image.

A start may be looked at for longer than its period: multipliers would be powers, and a period doubling a
branch point. And a motion may be its own image without its start having told so.
"""

from __future__ import annotations

import numpy as np

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid import cut_legs
from contwalk.problems.hybrid.closed_up import spans_of
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.hybrid.mirrors import carries, why_not_carried
from contwalk.problems.orbit.along_pins import shifted
from contwalk.problems.orbit.asymmetry import between_halves, repetitions, swapping
from contwalk.problems.orbit.closure import order_of
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.problems.orbit.own_image import ALIKE
from contwalk.system import Symmetry, System
from contwalk.system.declarations import ParameterValues


def least(problem: Kind, z: np.ndarray) -> tuple[Kind, np.ndarray]:
    """The same orbit over its least period, and over half of it if it is its own image after that.

    `problem` itself where there is nothing to leave out. What comes back is discretised for the orbit, and is
    a solution as nearly as its parts were alike.

    z has the shape (N + 1,) of its problem, before and after.
    """
    times = repetitions(problem, z)
    if times > 1:
        problem, z = divided(problem, z, times)
    name = own_image(problem, z)
    return _beginning(problem, z, problem.layout.legs // 2, 1, name) if name else (problem, z)


def divided(problem: Kind, z: np.ndarray, times: int) -> tuple[Kind, np.ndarray]:
    """The problem of the first part of an itinerary that repeats itself, and the same part of the orbit.

    z has the shape (N + 1,) of its problem, before and after.
    """
    if problem.itinerary.eventful:
        return _beginning(problem, z, problem.layout.legs // times, times, problem.itinerary.image)
    layout, whole, z = problem.layout, z, problem.bare(z)
    ends = np.cumsum(z[layout.durations])
    at = float(ends[-1]) / times
    last = min(int(np.searchsorted(ends, at)), layout.legs - 1)
    lasting = np.diff([0.0, *ends[:last], at])
    itinerary = Itinerary((*problem.itinerary.legs[:last], Leg(problem.itinerary.legs[last].mode)))
    other = problem.of_itinerary(itinerary, turns=problem.turns / times)
    other.subharmonic = max(problem.subharmonic // times, 1)
    states = z[: layout.states[last].stop]
    start = np.concatenate([states, lasting, z[layout.durations.stop :]])
    if problem.cuts > 1:
        start = cut_legs.copied(other, start, float(problem.starting_times(whole)[0]), problem, whole)
    return discretized(other, start), start


def _beginning(problem: Kind, z: np.ndarray, legs: int, times: int, image: str) -> tuple[Kind, np.ndarray]:
    """The first legs of an orbit, which close up to an image, as one of a period so many times shorter."""
    layout = problem.layout
    states, lasting = slice(0, layout.states[legs].start), layout.durations.start
    start = np.concatenate([z[states], z[lasting : lasting + legs], z[layout.rest], z[-1:]])
    start = cut_legs.completed(start, cut_legs.blocks(problem, z)[:legs])
    other = problem.of_itinerary(Itinerary(problem.itinerary.legs[:legs], image), turns=problem.turns / times)
    other.subharmonic = max(problem.subharmonic // times, 1)
    there = discretized(other, start)
    return there, shifted(there, start)


def own_image(problem: LimitedOrbit, z: np.ndarray) -> str:
    """The symmetry under which the second half of a whole orbit is the image of the first; empty if none.

    z has the shape (N + 1,).
    """
    for symmetry in swapping(problem, z):
        if _halves_alike(problem, z, symmetry) and _its_image(problem, z, symmetry):
            return symmetry.name
    return ""


def _halves_alike(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> bool:
    """Whether each leg lasts as long as the one half a cycle later, and starts at its image."""
    half = problem.layout.legs // 2
    lasting = z[problem.layout.durations]
    if np.max(np.abs(lasting[half:] - lasting[:half])) > ALIKE * problem.duration(z):
        return False
    return all(apart < ALIKE for apart in between_halves(problem, z, symmetry))


def _spatial(system: System) -> list[Symmetry]:
    return [symmetry for symmetry in system.symmetries if symmetry.role == "spatial"]


def _its_image(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> bool:
    """Whether the machine is its own image half a cycle later, for other values of its parameter too."""
    own, system = problem.values_of(z), problem.system
    values = [own, problem.line.at(problem.line.elsewhere(system, float(z[-1])))]
    periods = 0.5 * round(problem.duration(z) / period_at(system, own)) if problem.forced else 0.0
    return carries(system, values, symmetry, spans_of(problem, z), periods, problem.mesh.variation)


def unused_symmetries(problem: LimitedOrbit, z: np.ndarray) -> str:
    """Why no orbit of this itinerary is closed up to a declared symmetry, a sentence each; empty if one
    may be.

    That an orbit is not its own image is no reason: the machine is not, or orbits without events are followed
    as they are.

    z has the shape (N + 1,).
    """
    if problem.itinerary.image:
        return ""
    reasons = {symmetry.name: _unused(problem, z, symmetry) for symmetry in _spatial(problem.system)}
    return " ".join(f"Symmetry '{name}' is not used: {why}." for name, why in reasons.items() if why)


def _unused(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> str:
    if not problem.itinerary.eventful:
        return "an orbit without events is followed over its whole period"
    if order_of(symmetry, problem.first_state(z), ParameterValues(**problem.values_of(z))) != 2:
        return "its map is not its own inverse"
    machine, reasons = hybrid_machine(problem.system, problem.values_of(z)), []
    period = problem.duration(z) / problem.subharmonic if problem.forced else 0.0
    for later in sorted({0.0, 0.5 * period}):
        given = later, problem.mesh.variation
        told = (why_not_carried(machine, symmetry, span, *given) for span in spans_of(problem, z))
        reasons.append(next((why for why in told if why), ""))
    if not all(reasons):
        return ""
    return f"{reasons[-1]} is not taken to its image by it (see contwalk systems check)"
