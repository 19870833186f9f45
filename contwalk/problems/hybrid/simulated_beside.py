"""What the machine does a little beside a limit: simulated, and its itinerary read off.

Where no orbit of another itinerary passes through the limit itself the motion beyond still tells how it goes
on. Where an event is touched that leads into another mode, orbits that visit it may lie on this side of the
limit, as where an unstable orbit meets one that sticks: a motion out of that mode tells. Where an event that
jumps arrives with no rate the motion beyond may settle on an orbit far from this one, of the same itinerary.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.errors import ContwalkError
from contwalk.flow.events.guard import EPSILON
from contwalk.flow.hybrid.guard_status import ENTERING, guard_statuses
from contwalk.flow.hybrid.machine import hybrid_machine
from contwalk.numerics.linear import kernel_direction, parameter_held
from contwalk.problems.hybrid.least_part import least
from contwalk.problems.hybrid.legs_without_length import collapsed
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.margin_values import ZERO
from contwalk.problems.hybrid.reasons_in_words import first_sentence, told_once
from contwalk.problems.initial.event_recurrence import recurrence_from
from contwalk.problems.initial.orbit_from_recurrence import orbit_of
from contwalk.problems.orbit.branching import amplitude, filled_magnitudes
from contwalk.problems.orbit.conservation import off_its_value
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary
from contwalk.problems.problem import Seed
from contwalk.problems.solving import newton_on
from contwalk.signatures import folded

# How far beyond, in the metric.
STEPS = (1e-3, 1e-4, 1e-5, 1e-2)
# What returns sooner than in this part of the orbit's closure is no orbit like it.
SHORTEST = 0.8
# What has not come back after so many closures is no orbit near it: a walker that has fallen, for example.
LONGEST = 20.0
# A visit that begins lasts as long as the root of the distance: so many times that, in the orbit's closure.
VISITS = (0.3, 1.0, 3.0)
# Of the orbit's variation: what a state that is zero has of rounding.
ROUNDED = 1e-12


@dataclass(frozen=True)
class Begin:
    """Where a simulation begins: a full state, shape (n,), at a time in a mode, right after an event."""

    time: float
    x: np.ndarray
    mode: str
    event: str


@dataclass(frozen=True)
class Trial:
    """Where a motion is looked for: from a guess a step in the metric along a way, shape (N + 1,).

    `words` tell it, `begin` is where the motion begins if that is not the guess's start. `settles`: it is
    simulated until it settles: right beside the limit the branch has no orbits at that parameter.
    """

    words: str
    way: np.ndarray
    step: float
    begin: Begin | None = None
    settles: bool = False


def seeds(
    problem: LimitedOrbit, point: SpecialPoint, visited: Begin | None = None
) -> tuple[Sequence[Seed], str]:
    """The orbit of another itinerary a little beside a point, and in words what was found, or seen instead.

    `visited`: right after the event that is touched, where it leads into another mode.
    """
    z, tangent = np.array(point.unknowns), np.array(point.tangent)
    outward = tangent if point.s >= 0.0 else -tangent
    there = discretized(problem, z)
    weights = filled_magnitudes(there, z)
    told: list[str] = []
    for trial in _trials(there, z, outward, weights, point.label, visited):
        guess = z + trial.step * trial.way / float(np.linalg.norm(trial.way / weights))
        try:
            seed = _simulated(there, guess, trial, point.label)
        except (ContwalkError, np.linalg.LinAlgError) as error:
            told += [first_sentence(str(error))] if trial.begin is None else []
            continue
        found = seed.problem
        assert isinstance(found, LimitedOrbit)
        own = "" if trial.settles else ": a branch of its own"  # or, beyond a fold, of the one that ends
        signature = folded(found.itinerary.signature(found.system)) or "no events"
        return (seed,), f"{trial.words} [{signature}]{_lasting(there, z, seed)}{own}."
    return (), f"Beyond it: {told_once(told)}."


def _lasting(problem: LimitedOrbit, z: np.ndarray, seed: Seed) -> str:
    """What tells an orbit from the one at the limit, z of shape (N + 1,), where their signatures do not."""
    other = seed.problem
    assert isinstance(other, LimitedOrbit)
    if problem.itinerary.signature(problem.system) != other.itinerary.signature(other.system):
        return ""
    lasts, before = (f"{each.duration(place):.10g}" for each, place in ((other, seed.z), (problem, z)))
    if lasts == before:
        return ", with the same period and other states"
    return f", with the period {lasts} and not {before}"


def _trials(
    problem: LimitedOrbit,
    z: np.ndarray,
    outward: np.ndarray,
    weights: np.ndarray,
    label: str,
    visited: Begin | None,
) -> Iterator[Trial]:
    """What is tried, the way along the branch first; beyond a grazing also the one of the parameter alone.

    All have the shape (N + 1,).
    """
    for step in STEPS:
        yield Trial("A little beyond, the motion has the signature", outward, step)
    across = _across(problem, z, outward, weights) if label == "GR" else None
    if across is not None:
        words = f"A little beyond in '{problem.free}', the motion settles on an orbit of signature"
        for step in STEPS[:2]:
            yield Trial(words, across, step, settles=True)
    if visited is None:
        return
    flow = hybrid_machine(problem.system, problem.values_of(z)).mode(visited.mode)
    own = flow.states
    rate = flow.field.along(np.array([visited.time]), visited.x[own][None], flow.c)[0]
    words = f"A little before, a motion that visits mode '{visited.mode}' has the signature"
    for step, share in itertools.product(STEPS[:2], VISITS):
        lasts, x = share * float(np.sqrt(step)) * problem.duration(z), visited.x.copy()
        x[own] -= lasts * rate
        yield Trial(words, -outward, step, replace(visited, time=visited.time - lasts, x=x))


def _across(
    problem: LimitedOrbit, z: np.ndarray, outward: np.ndarray, weights: np.ndarray
) -> np.ndarray | None:
    """The way of the parameter alone away from a branch's orbits before its limit, at which it may turn.

    None if those are not found.

    All have the shape (N + 1,).
    """
    direction = outward / float(np.linalg.norm(outward / weights))
    try:
        before = newton_on(problem, z - STEPS[0] * direction, weights, direction / weights**2)
    except (ContwalkError, np.linalg.LinAlgError):
        return None
    across = np.zeros(len(z))
    across[-1] = z[-1] - before[-1]
    return across if across[-1] else None


def _beginning(problem: LimitedOrbit, guess: np.ndarray) -> Begin:
    """Where the orbit of a guess begins.

    Raises
    ------
    ContwalkError
        If its first event would be passed the wrong way.
    """
    x = problem.passages[0].full(problem.layout.inputs(0, guess)[0])
    x = np.where(np.abs(x) < ROUNDED * problem.mesh.variation, 0.0, x)  # no magnitude of a state
    itinerary, time = problem.itinerary, float(problem.starting_times(guess)[0])
    event = itinerary.leading_in(problem.system, 0)
    if event and _goes_back(problem, problem.values_of(guess), event, time, x):
        raise ContwalkError(f"orbits of this signature would pass '{event}' the wrong way")
    return Begin(time, x, itinerary.legs[0].mode, event)


def _simulated(problem: LimitedOrbit, guess: np.ndarray, trial: Trial, label: str) -> Seed:
    """The orbit that a simulation goes round in at a guess's parameters, from its start or from another one.

    Raises
    ------
    ContwalkError
        If it does not come back, or its orbit is not the machine's.
    """
    values, itinerary = problem.values_of(guess), problem.itinerary
    begin = trial.begin or _beginning(problem, guess)
    recurrence = recurrence_from(
        problem.system,
        values,
        begin.x,
        begin.mode,
        until="settled" if trial.settles else None,
        time=begin.time,
        after=begin.event or None,
        least=SHORTEST * problem.duration(guess),
        longest=LONGEST * problem.duration(guess),
    )
    rotations = [itinerary.rotated(problem.system, k) for k in range(len(itinerary))]
    lasted = sum(stretch.duration for stretch in recurrence.stretches) / problem.duration(guess)
    times, room = round(lasted), float(np.sqrt(trial.step))  # what begins at no rate is as far as the root
    if (
        not trial.settles
        and abs(lasted - times) < room * times
        and any(_alike(each, recurrence.itinerary, times) for each in rotations)
    ):
        raise ContwalkError("the motion has the same signature still")
    line = replace(problem.line, parameters=values)
    rough, start = orbit_of(
        type(problem), problem.system, line, float(guess[-1]), recurrence, problem.discretization
    )
    weights = filled_magnitudes(rough, start)
    normal = parameter_held(weights)
    start = newton_on(rough, start, weights, normal)
    there = discretized(rough, start)
    start = newton_on(there, start, weights, normal)
    shorter, part = least(there, start)
    if shorter is not there:
        there, start, weights = shorter, part, filled_magnitudes(shorter, part)
        alike = abs(there.duration(start) / problem.duration(guess) - 1.0) < room and not trial.settles
        if alike and there.itinerary in rotations:
            raise ContwalkError("the motion has the same signature still, run through more than once")
        start = newton_on(there, start, weights, parameter_held(weights))
    at_once = collapsed(there, start)
    if at_once:
        raise ContwalkError(f"in the orbit that a simulation leads to '{at_once}' happens at once")
    off = off_its_value(there, start)
    if off:
        raise ContwalkError(f"the orbit that a simulation leads to has '{off}' at another value")
    margins = there.margins(start)
    lost = [o.name for o, r in zip(margins.limits, margins.relative, strict=True) if r < -ZERO and o.acts]
    if lost:
        raise ContwalkError(f"the orbit that a simulation leads to violates '{lost[0]}'")
    weights = filled_magnitudes(there, start)
    tangent = kernel_direction(there.linearize(start).jacobian, weights)
    tangent = tangent * (np.sign(tangent[-1]) * np.sign(trial.way[-1]) or 1.0)
    walking = there.adapted_to(start, weights)
    return Seed(label, start, tangent, amplitude(tangent), walking)


def _goes_back(problem: LimitedOrbit, values: dict[str, float], event: str, t: float, x: np.ndarray) -> bool:
    """Whether a guess right after an event goes back through its guard.

    Beyond the point at which an event arrives with no rate, no state of the guess is one after a reset.
    """
    flow = hybrid_machine(problem.system, values).mode(problem.itinerary.legs[0].mode)
    own, sizes = x[flow.states], problem.mesh.variation[flow.states]
    standing = guard_statuses(flow, t, own, EPSILON * np.abs(own), sizes, (event,))
    return any(
        guard.kind == ENTERING
        for transition, guard in zip(flow.transitions, standing, strict=True)
        if transition.name == event
    )


def _alike(itinerary: Itinerary, recurrence: Itinerary, times: int) -> bool:
    """Whether what lasts so many times as long is the itinerary so many times, soft transitions aside."""
    if not any(leg.soft for leg in (*itinerary.legs, *recurrence.legs)):
        return recurrence.legs == itinerary.legs * times
    own, other = (
        [leg.name for leg in each.legs if leg.name and not leg.soft] for each in (itinerary, recurrence)
    )
    return other == own * times
