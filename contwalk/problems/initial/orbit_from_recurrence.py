"""The orbit that a lap is: its problem, discretised for it, and the lap as its unknowns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from contwalk.errors import StartError
from contwalk.flow.hybrid.motions import HybridMachine, hybrid_machine
from contwalk.problems import neutral as neutrals
from contwalk.problems.angles import whole_turns
from contwalk.problems.forcing import period_at
from contwalk.problems.hybrid import cutting, families
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit, Kind
from contwalk.problems.hybrid.lap import Lap
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
    lap: Lap,
    discretization: Discretization | None = None,
) -> tuple[Kind, np.ndarray]:
    """The problem of a lap's word, discretised for it, and the lap as its unknowns.

    `kind` makes it, as a class of orbits does; `at` is the lap's place on the line, by default that of the
    point that the line was made from.

    The unknowns have the shape (N + 1,).
    """
    first = lap.stretches[0]
    line = started(system, line, at, first.state, first.leg.mode)
    value = line.place(at)
    values = line.at(value)
    _check_zeros(hybrid_machine(system, values), lap)
    pins = _neutral(system, line, values, lap) if system.neutral else []
    lap = _placed(system, pins, lap, values)
    given = {"pins": pins, "reference": lap.stretches[0].state, "discretization": discretization}
    problem = kind(system, lap.word, line.parameters, line.free, line.ends, **given)
    layout = problem.layout
    lasting = np.array([stretch.duration for stretch in lap.stretches])
    drifts, states = _drifting(problem, lap, values)
    z = problem.assembled(states, lasting, drifts, value)
    if layout.start is not None and system.period is not None:
        period = period_at(system, problem.values_of(z))
        whole = problem.rounds * float(lasting.sum())
        problem = problem.of_word(lap.word, max(round(whole / period), 1))
        z[layout.start] = lap.stretches[0].start % period if problem.word.eventful else 0.0
    problem = problem.varied(turns=_turns(system, lap))
    return cutting.begun(problem.adapted_to(z, problem.weighted(lap.magnitudes)), z)


def _check_zeros(machine: HybridMachine, lap: Lap) -> None:
    """Raise where an event is a guard's jump through zero: orbits are equations, and it has no zero there."""
    for stretch in lap.stretches:
        transition = stretch.leg.transition
        if transition is None or stretch.leg.collapsed:
            continue
        flow, t = machine.mode(stretch.leg.mode), stretch.start + stretch.duration
        number, x = flow.transitions.index(transition), stretch.end[flow.states]
        value = float(flow.guards[number](t, x, flow.p)[0])
        typical = flow.scales(t, x, lap.magnitudes[flow.states], stretch.duration)[number]
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


def _neutral(system: System, line: ParameterLine, values: dict[str, float], lap: Lap) -> list[Neutral]:
    """The directions that are neutral along a lap, and so along its branch.

    Raises
    ------
    StartError
        If one is neutral where the branch begins, and not beside it.
    """
    pins = families.active(hybrid_machine(system, values), lap)
    places = [0.0, 1.0] if line.own is None else [_beside(values[line.own])]
    for place in places:
        kept = families.active(hybrid_machine(system, line.at(place)), lap)
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


def _placed(system: System, pins: Sequence[Neutral], lap: Lap, parameters: dict[str, float]) -> Lap:
    """The lap moved along pinned directions to where the motion began: translations only."""
    if lap.origin is None or not pins:
        return lap
    first = lap.stretches[0].state
    along = neutrals.directions(system, pins, first, parameters)
    if not np.array_equal(along, neutrals.directions(system, pins, lap.origin, parameters)):
        return lap
    held = [system.state_names.index(pin.pin) for pin in pins if pin.pin is not None and pin.value is None]
    if len(held) < len(pins):
        return lap
    try:
        shift = along @ np.linalg.solve(along[held], (lap.origin - first)[held])
    except np.linalg.LinAlgError:
        return lap
    moved = tuple(
        replace(stretch, state=stretch.state + shift, end=stretch.end + shift) for stretch in lap.stretches
    )
    return replace(lap, stretches=moved, returned=lap.returned + shift)


def _drifting(
    problem: DiscretizedOrbit, lap: Lap, parameters: dict[str, float]
) -> tuple[np.ndarray, list[np.ndarray]]:
    """The drifts with which a lap closes, and its legs' first states as one sees them who drifts along."""
    first, states = lap.stretches[0], [stretch.state for stretch in lap.stretches]
    if not problem.pins:
        return np.zeros(0), states
    along = neutrals.directions(problem.system, problem.pins, first.state, parameters)
    apart, scale = lap.returned - first.state, lap.magnitudes
    shares, *_ = np.linalg.lstsq(along / scale[:, None], apart / scale, rcond=None)
    drifts = -shares / sum(stretch.duration for stretch in lap.stretches)
    moved = []
    for stretch in lap.stretches:
        own = neutrals.directions(problem.system, problem.pins, stretch.state, parameters)
        moved.append(stretch.state + (stretch.start - first.start) * own @ drifts)
    return drifts, moved


def _turns(system: System, lap: Lap) -> np.ndarray:
    """What angles grow by in a closure, in whole periods."""
    own = np.array([s.period or 0.0 for s in system.states])
    return whole_turns(lap.returned - lap.stretches[0].state, own)
