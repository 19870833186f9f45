"""The orbit that a recurrence is: its problem, discretised for it, and the recurrence as its unknowns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.motions import HybridMachine, hybrid_machine
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid import cut_legs, families
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.initial.orbit_from_state import started
from contwalk.problems.orbit.discretization import Discretization
from contwalk.problems.parameter_line import ParameterLine
from contwalk.python_functions import line_of
from contwalk.system import Neutral, System

# A guard that is more than this part of its typical changes where its event has found it has jumped.
JUMPED = 1e-3
# How long before its event it is looked at too, as a part of the leg.
BEFORE = 1e-3


def orbit_of(
    kind: Callable[..., Kind],
    system: System,
    line: ParameterLine,
    at: float | None,
    recurrence: HybridRecurrence,
    discretization: Discretization | None = None,
) -> tuple[Kind, np.ndarray]:
    """The problem of a recurrence's itinerary, discretised for it, and the recurrence as its unknowns.

    `kind` makes it, as a class of orbits does; `at` is the recurrence's place on the line, by default that of
    the point that the line was made from.

    The unknowns have the shape (N + 1,).
    """
    first = recurrence.stretches[0]
    line = started(system, line, at, first.state, first.leg.mode)
    value = line.place(at)
    values = line.at(value)
    _check_zeros(hybrid_machine(system, values), recurrence)
    pins = _neutral(system, line, values, recurrence) if system.neutral else []
    recurrence = _placed(system, pins, recurrence, values)
    given = {"pins": pins, "reference": recurrence.stretches[0].state, "discretization": discretization}
    problem = kind(system, recurrence.itinerary, line.parameters, line.free, line.ends, **given)
    layout = problem.layout
    lasting = np.array([stretch.duration for stretch in recurrence.stretches])
    drifts, states = _drifting(problem, recurrence, values)
    z = problem.assembled(states, lasting, drifts, value)
    if layout.start is not None and system.period is not None:
        period = period_at(system, problem.values_of(z))
        whole = problem.rounds * float(lasting.sum())
        problem = problem.of_itinerary(recurrence.itinerary, max(round(whole / period), 1))
        z[layout.start] = recurrence.stretches[0].start % period if problem.itinerary.eventful else 0.0
    problem = problem.varied(turns=_turns(system, recurrence))
    return cut_legs.begun(problem.adapted_to(z, problem.weighted(recurrence.magnitudes)), z)


def _check_zeros(machine: HybridMachine, recurrence: HybridRecurrence) -> None:
    """Raise where an event is a guard's jump through zero: orbits are equations, and it has no zero there."""
    for stretch in recurrence.stretches:
        transition = stretch.leg.transition
        if transition is None or stretch.leg.collapsed:
            continue
        flow, t = machine.mode(stretch.leg.mode), stretch.start + stretch.duration
        number, x = flow.transitions.index(transition), stretch.end[flow.states]
        value = float(flow.guards[number](t, x, flow.p)[0])
        typical = flow.scales(t, x, recurrence.magnitudes[flow.states], stretch.duration)[number]
        # At a pole what it typically changes by is as large as itself; a little earlier it is far less.
        ago = BEFORE * stretch.duration
        earlier = abs(float(flow.guards[number](t - ago, x - ago * flow.field(t, x, flow.c), flow.p)[0]))
        if not abs(value) <= JUMPED * min(typical, earlier / BEFORE):
            raise StartError(
                f"{line_of(transition.guard)}the guard of transition '{transition.name}' jumps through zero "
                f"at t = {machine.system.lasting(t)}: it is {value:.6g} beside it.",
                "Return a number that passes zero evenly, as a distance does. For what jumps at an instant "
                "declare a transition of its own, whose guard is of time alone, such as "
                "math.sin(2 * math.pi * t / p.T).",
            )


def _neutral(
    system: System, line: ParameterLine, values: dict[str, float], recurrence: HybridRecurrence
) -> list[Neutral]:
    """The directions that are neutral along a recurrence, and so along its branch.

    Raises
    ------
    StartError
        If one is neutral where the branch begins, and not beside it.
    """
    pins = families.active(hybrid_machine(system, values), recurrence)
    places = [0.0, 1.0] if line.own is None else [_beside(values[line.own])]
    for place in places:
        kept = families.active(hybrid_machine(system, line.at(place)), recurrence)
        lost = [pin.name for pin in pins if pin not in kept]
        if lost:
            raise StartError(
                f"The direction '{lost[0]}' is neutral where the branch begins, and not along '{line.free}': "
                "orbits are not isolated there.",
                "Begin elsewhere, such as at the other end of the path.",
            )
    return pins


def _beside(value: float) -> float:
    """A value of a parameter near another one, at which what holds for that one only does not."""
    return 1.01 * value if value else 0.01


def _placed(
    system: System, pins: Sequence[Neutral], recurrence: HybridRecurrence, parameters: dict[str, float]
) -> HybridRecurrence:
    """The recurrence moved along pinned directions to where the motion began: translations only."""
    if recurrence.origin is None or not pins:
        return recurrence
    first = recurrence.stretches[0].state
    along = neutrals.directions(system, pins, first, parameters)
    if not np.array_equal(along, neutrals.directions(system, pins, recurrence.origin, parameters)):
        return recurrence
    held = [system.state_names.index(pin.pin) for pin in pins if pin.pin is not None and pin.value is None]
    if len(held) < len(pins):
        return recurrence
    try:
        shift = along @ np.linalg.solve(along[held], (recurrence.origin - first)[held])
    except np.linalg.LinAlgError:
        return recurrence
    moved = tuple(
        replace(stretch, state=stretch.state + shift, end=stretch.end + shift)
        for stretch in recurrence.stretches
    )
    return replace(recurrence, stretches=moved, returned=recurrence.returned + shift)


def _drifting(
    problem: LimitedOrbit, recurrence: HybridRecurrence, parameters: dict[str, float]
) -> tuple[np.ndarray, list[np.ndarray]]:
    """The drifts with which a recurrence closes, and its legs' first states as one who drifts sees them."""
    first, states = recurrence.stretches[0], [stretch.state for stretch in recurrence.stretches]
    if not problem.pins:
        return np.zeros(0), states
    along = neutrals.directions(problem.system, problem.pins, first.state, parameters)
    apart, scale = recurrence.returned - first.state, recurrence.magnitudes
    shares, *_ = np.linalg.lstsq(along / scale[:, None], apart / scale, rcond=None)
    drifts = -shares / sum(stretch.duration for stretch in recurrence.stretches)
    moved = []
    for stretch in recurrence.stretches:
        own = neutrals.directions(problem.system, problem.pins, stretch.state, parameters)
        moved.append(stretch.state + (stretch.start - first.start) * own @ drifts)
    return drifts, moved


def _turns(system: System, recurrence: HybridRecurrence) -> np.ndarray:
    """What angles grow by in a closure, in whole periods."""
    own = np.array([s.period or 0.0 for s in system.states])
    return whole_turns(recurrence.returned - recurrence.stretches[0].state, own)
