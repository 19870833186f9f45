"""The least part of an orbit that tells all of it: one period, and half of it where the rest is its image.

A start may be looked at for longer than its period: multipliers would be powers, and a period doubling a
branch point. And a motion may be its own image without its start having told so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.problems import neutral as neutrals
from contwalk.problems.hybrid import cut_legs
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.hybrid.mirrors import Span, carries, why_not_carried
from contwalk.problems.orbit.along_pins import shifted
from contwalk.problems.orbit.closure import imaged, order_of
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary, Leg, has_image, imaged_leg
from contwalk.problems.orbit.own_image import NEARLY
from contwalk.system import Symmetry, System
from contwalk.system.declarations import ParameterValues

# Two orbits whose states differ by less than this part of their variation are one.
ALIKE = 1e-6


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


def repetitions(problem: LimitedOrbit, z: np.ndarray) -> int:
    """How many times an orbit goes through the same states. z has the shape (N + 1,)."""
    return next((times for times in _divisions(problem) if _repeated(problem, z, times)), 1)


def _divisions(problem: LimitedOrbit) -> Iterator[int]:
    """Into how many equal parts an orbit of its itinerary may be divided, the most first."""
    most = problem.layout.legs if problem.itinerary.eventful else max(problem.subharmonic, 2)
    for times in range(most, 1, -1):
        whole = not problem.forced or problem.subharmonic % times == 0
        if whole and problem.itinerary.has_parts(problem.system, times):
            yield times


def asymmetries(problem: LimitedOrbit, z: np.ndarray) -> dict[str, float]:
    """How far an orbit, z of shape (N + 1,), is from repeating itself and from being its own image, by name.

    In units of its variation.

    Raises
    ------
    NotFinite
        If the motion ends before the closure does.
    """
    found = {
        f"{times} parts": max(_between_parts(problem, z, times), default=0.0) for times in _divisions(problem)
    }
    halves = ((symmetry.name, _between_halves(problem, z, symmetry)) for symmetry in _swapping(problem, z))
    return found | {name: max(apart, default=0.0) for name, apart in halves}


def nearly_less(problem: LimitedOrbit, z: np.ndarray) -> bool:
    """Whether an orbit z, shape (N + 1,), misses but little to repeat itself, or to be its own image.

    The errors of its steps may hide that it does.
    """
    return any(ALIKE <= apart < NEARLY for apart in asymmetries(problem, z).values())


def _repeated(problem: LimitedOrbit, z: np.ndarray, times: int) -> bool:
    """Whether an orbit of an itinerary that repeats itself meets itself after the first of so many parts."""
    return all(apart < ALIKE for apart in _between_parts(problem, z, times))


def _between_parts(problem: LimitedOrbit, z: np.ndarray, times: int) -> Iterator[float]:
    """How far an orbit of an itinerary that repeats itself is from itself after the first of some parts."""
    if not problem.itinerary.eventful:
        yield _apart(problem, z, _part_way(problem, z, times), 0, problem.turns / times)
        return
    part = problem.layout.legs // times
    symmetry, p = _symmetry(problem, problem.itinerary.image), ParameterValues(**problem.values_of(z))
    turns = np.zeros(problem.states) if symmetry else problem.turns / times
    for i in range(problem.layout.legs - part):
        yield _apart(problem, z, imaged(symmetry, _start(problem, z, i + part), p), i, turns)


def _part_way(problem: LimitedOrbit, z: np.ndarray, times: int) -> np.ndarray:
    """Full state after the first of so many parts of a closure."""
    views = problem.view(z)
    ends = np.cumsum([view.duration for view in views])
    at = float(ends[-1]) / times
    i = min(int(np.searchsorted(ends, at)), len(views) - 1)
    view = views[i]
    return view.full(view.stepped(1.0 - (float(ends[i]) - at) / view.duration))


def _start(problem: LimitedOrbit, z: np.ndarray, i: int) -> np.ndarray:
    """Full state at the start of a leg."""
    return problem.passages[i].full(z[problem.layout.states[i]])


def _apart(problem: LimitedOrbit, z: np.ndarray, x: np.ndarray, i: int, turns: np.ndarray) -> float:
    """How far a state is from the one at the start of leg i, but for turns, in units of the variation.

    And but for where it is along neutral directions: one who drifts along, so that the whole closes, sees
    its parts close elsewhere where the image of a direction is its opposite.
    """
    own, scale = list(problem.passages[i].states), problem.mesh.variation
    given = x - turns, _start(problem, z, i), problem.values_of(z), scale, own
    return float(np.linalg.norm(neutrals.apart_at_least(problem.system, problem.pins, *given) / scale))


def _symmetry(problem: LimitedOrbit, name: str) -> Symmetry | None:
    return problem.system.symmetry(name) if name else None


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
    for symmetry in _swapping(problem, z):
        if _halves_alike(problem, z, symmetry) and _its_image(problem, z, symmetry):
            return symmetry.name
    return ""


def _swapping(problem: LimitedOrbit, z: np.ndarray) -> Iterator[Symmetry]:
    """Symmetries that take the first half of a whole orbit's itinerary to the second."""
    half, rest = divmod(problem.layout.legs, 2)
    if rest or problem.itinerary.image or not problem.itinerary.eventful or np.any(problem.turns):
        return
    first, second = problem.itinerary.legs[:half], problem.itinerary.legs[half:]
    system, p = problem.system, ParameterValues(**problem.values_of(z))
    for symmetry in _spatial(system):
        if order_of(symmetry, _start(problem, z, 0), p) != 2:
            continue
        if not all(has_image(system, symmetry, leg) for leg in first):
            continue
        if second == tuple(imaged_leg(system, symmetry.name, leg) for leg in first):
            yield symmetry


def _halves_alike(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> bool:
    """Whether each leg lasts as long as the one half a cycle later, and starts at its image."""
    half = problem.layout.legs // 2
    lasting = z[problem.layout.durations]
    if np.max(np.abs(lasting[half:] - lasting[:half])) > ALIKE * problem.duration(z):
        return False
    return all(apart < ALIKE for apart in _between_halves(problem, z, symmetry))


def _between_halves(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> Iterator[float]:
    """How far each leg's start in the second half is from the image of that in the first."""
    half, p = problem.layout.legs // 2, ParameterValues(**problem.values_of(z))
    turns = np.zeros(problem.states)
    for i in range(half):
        yield _apart(problem, z, imaged(symmetry, _start(problem, z, i), p), i + half, turns)


def _spatial(system: System) -> list[Symmetry]:
    return [symmetry for symmetry in system.symmetries if symmetry.role == "spatial"]


def _its_image(problem: LimitedOrbit, z: np.ndarray, symmetry: Symmetry) -> bool:
    """Whether the machine is its own image half a cycle later."""
    machine = hybrid_machine(problem.system, problem.values_of(z))
    later = 0.5 * problem.duration(z) if problem.forced else 0.0
    return carries(machine, symmetry, _spans(problem, z), later, problem.mesh.variation)


def _spans(problem: LimitedOrbit, z: np.ndarray) -> list[Span]:
    spans = []
    for stretch in problem.stretches(z):
        (begin, x), (end, y) = stretch.start, stretch.end
        spans.append(Span(stretch.view.piece.passage.leg, begin, x, end - begin, y))
    return spans


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
    if order_of(symmetry, _start(problem, z, 0), ParameterValues(**problem.values_of(z))) != 2:
        return "its map is not its own inverse"
    machine, reasons = hybrid_machine(problem.system, problem.values_of(z)), []
    period = problem.duration(z) / problem.subharmonic if problem.forced else 0.0
    for later in sorted({0.0, 0.5 * period}):
        given = later, problem.mesh.variation
        told = (why_not_carried(machine, symmetry, span, *given) for span in _spans(problem, z))
        reasons.append(next((why for why in told if why), ""))
    if not all(reasons):
        return ""
    return f"{reasons[-1]} is not taken to its image by it (see contwalk systems check)"
