"""Soft transitions on an orbit's legs: which modes they lead through, and where on a leg they happen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contwalk.errors import NotFinite
from contwalk.flow.hybrid.machine import HybridMachine
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.memory import memory_of, remembered
from contwalk.problems import neutral as neutrals
from contwalk.problems.hybrid.grouping import NO_TIME
from contwalk.problems.hybrid.limited_orbit import Kind, LimitedOrbit
from contwalk.problems.hybrid.limits import Limit, conditions_at, limits_of_leg
from contwalk.problems.hybrid.margin_values import ZERO, largest
from contwalk.problems.hybrid.rotated import rotated
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.orbit.along_pins import shifted
from contwalk.problems.orbit.closure import imaged
from contwalk.problems.orbit.fine_steps import discretized
from contwalk.problems.orbit.itinerary import Itinerary, Leg
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

TOLERANCE = 1e-9
# A field that switches and switches back within `NO_TIME` has not switched: what it does shrinks with the
# third power of the time.
MOST_SWITCHES = 16

Piece = tuple[Leg, np.ndarray, float]


def only_soft(system: System) -> System:
    """The machine without its hard transitions: what moves between them."""

    def made() -> System:
        soft = tuple(transition for transition in system.transitions if transition.role == "soft")
        return replace(system, transitions=soft, conditions=(), symmetries=(), observables=(), neutral=())

    found: System = remembered(memory_of(system, "only soft"), None, 1, made)
    return found


def hard_itinerary(itinerary: Itinerary) -> Itinerary:
    """An explicit itinerary without its soft transitions."""
    legs, mode = [], itinerary.legs[0].mode
    for i, leg in enumerate(itinerary.legs):
        if leg.soft:
            continue
        legs.append(replace(leg, mode=mode))
        mode = itinerary.legs[(i + 1) % len(itinerary)].mode
    return Itinerary(tuple(legs), itinerary.image)


def begun(problem: Kind, z: np.ndarray) -> tuple[Kind, np.ndarray]:
    """The same orbit, not beginning with a soft transition: right after a hard one, or between events.

    z has the shape (N + 1,) of its problem, before and after.
    """
    hard = [i for i, leg in enumerate(problem.itinerary.legs) if not leg.soft]
    if not hard:
        return _between(problem, z)
    first = (hard[-1] + 1) % len(problem.itinerary)
    return (problem, z) if first == 0 else rotated(problem, z, first)


def _between(problem: Kind, z: np.ndarray) -> tuple[Kind, np.ndarray]:
    """An orbit of soft transitions, beginning in its longest leg; a forced one where the force does."""
    times, at = problem.starting_times(z), 0.0
    if problem.forced:
        period = problem.duration(z) / problem.forcings
        at = float(np.ceil(times[0] / period)) * period
        if at > times[-1]:  # the force begins its period in the other half
            problem, z = rotated(problem, z, len(problem.itinerary))
            times = problem.starting_times(z)
        first = min(int(np.searchsorted(times, at, "right")), len(problem.itinerary)) - 1
        share = (at - times[first]) / (times[first + 1] - times[first])
    else:
        first, share = int(np.argmax(np.diff(times))), 0.5
    return _cut(*(rotated(problem, z, first) if first else (discretized(problem, z), z)), share)


def _cut(problem: Kind, z: np.ndarray, share: float) -> tuple[Kind, np.ndarray]:
    """The same orbit, beginning at an instant of its first leg: what came before is the last one."""
    layout, itinerary, system = problem.layout, problem.itinerary, problem.system
    states = [passage.full(z[place]) for passage, place in zip(problem.passages, layout.states, strict=True)]
    lasting, first = z[layout.durations], itinerary.legs[0]
    legs, last = (*itinerary.legs, Leg(first.mode)), states[0] + problem.turns
    if itinerary.image:
        symmetry = system.symmetry(itinerary.image)
        last = imaged(symmetry, last, ParameterValues(**problem.values_of(z)))
        legs = (*itinerary.legs, Leg(symmetry.modes.get(first.mode, first.mode)))
    view = problem.view(z)[0]
    cut = view.full(view.stepped(share)) if share > 0.0 else states[0]
    other = problem.of_itinerary(replace(itinerary, legs=legs))
    durations = [(1.0 - share) * lasting[0], *lasting[1:], share * lasting[0]]
    result = other.assembled([cut, *states[1:], last], durations, z[layout.drifts], float(z[-1]))
    other.reference = other.first_state(result)
    there = discretized(other, result)
    return there, shifted(there, result)


def passed(
    problem: LimitedOrbit, z: np.ndarray, magnitudes: np.ndarray
) -> tuple[Itinerary, list[np.ndarray], list[float]]:
    """The explicit itinerary over z, with full states at the starts of its legs and their durations.

    z has the shape (N + 1,), magnitudes (n,), each state (n,).

    Raises
    ------
    NotFinite
        If the motion over a leg ends early.
    """
    machine = hybrid_machine(only_soft(problem.system), problem.values_of(z))
    times, legs = problem.starting_times(z), problem.itinerary.legs
    found: list[Leg] = []
    states: list[np.ndarray] = []
    lasting: list[float] = []
    for i, leg in enumerate(legs):
        x, begin, end = problem.passages[i].full(problem.layout.inputs(i, z)[0]), times[i], times[i + 1]
        mode = settled(machine, leg.mode, float(begin), x)
        pieces, last = _pieces(machine, mode, float(begin), x, float(end), magnitudes)
        least = NO_TIME * problem.duration(z)
        pieces = _lasting(pieces, least)
        if leg.transition is not None:
            pieces = _switched(problem.system, leg.name, pieces, last, least)
            final = problem.system.transition(leg.name, pieces[-1][0].mode)
            pieces[-1] = (replace(leg, mode=final.source, transition=final), *pieces[-1][1:])
        own = [piece[2] for piece in pieces]
        since = np.concatenate([[0.0], np.cumsum(own)[:-1]])
        found += [piece[0] for piece in pieces]
        states += [*_held(problem, z, np.array([piece[1] for piece in pieces]), since)]
        lasting += own
    return Itinerary(tuple(found), problem.itinerary.image), states, lasting


def _held(problem: LimitedOrbit, z: np.ndarray, states: np.ndarray, since: np.ndarray) -> np.ndarray:
    """States of a motion, so long after its leg began, moved along pinned directions as the drifts say."""
    shares = np.outer(since, z[problem.layout.drifts])
    return neutrals.shifted(problem.system, problem.pins, states, problem.values_of(z), shares)


def _switched(system: System, name: str, pieces: list[Piece], last: np.ndarray, least: float) -> list[Piece]:
    """The pieces of a leg that ends with a transition, which may not lead out of the mode of the last one.

    Where both happen at nearly the same time, a soft transition to a mode that it leads out of comes first,
    and one out of such a mode has not happened yet.

    Raises
    ------
    NotFinite
        If there is none.
    """
    leg, state, lasts = pieces[-1]
    sources = system.sources(name)
    if leg.mode in sources:
        return pieces
    if len(pieces) > 1 and lasts < least and pieces[-2][0].mode in sources:
        before, x, first = pieces[-2]
        return [*pieces[:-2], (before, x, first + lasts)]
    for soft in system.leaving(leg.mode):
        if soft.role == "soft" and soft.target in sources:
            between = Leg(leg.mode, soft, soft.direction != "rising")
            return [*pieces[:-1], (between, state, lasts), (Leg(soft.target), last, 0.0)]
    raise NotFinite(
        f"'{name}' does not lead out of mode '{leg.mode}', in which the segment before it ends.", ""
    )


def holds(explicit: LimitedOrbit, unknowns: np.ndarray, unfolded: bool = False) -> bool:
    """Whether the soft transitions of an orbit are those that the machine meets: no guard is past zero.

    Unknowns have the shape (N + 1,) of the explicit orbit. `unfolded`: whether they solve the equations but
    for an unfolding: legs then do not meet by what the steps err, nor does the next one begin at its guard.
    """
    views = explicit.view(unknowns)
    missed = _missed(explicit, views) if unfolded else 0.0
    for view in views:
        for k, transition in enumerate(view.piece.passage.leaving):
            sign = {"falling": 1.0, "rising": -1.0}.get(transition.direction, 0.0)
            if transition.role != "soft" or sign == 0.0:
                continue
            _, values, rates = view.guard(transition)
            turns = [value for _, _, value, _ in view.turning[k]]
            past = -float(np.min(sign * np.append(values, turns)))
            zero = ZERO * largest(values, rates, view.duration, explicit.mesh.total)
            if past > max(zero, 2.0 * missed):
                return False
    return True


def _missed(explicit: LimitedOrbit, views: Sequence[GuardedView]) -> float:
    """The largest guard of a soft transition that an orbit has right after it: zero where its legs meet."""
    after = zip(explicit.itinerary.legs[:-1], views[1:], strict=True)
    soft = ((leg.transition, view) for leg, view in after if leg.soft and leg.transition is not None)
    return max((abs(float(view.guard_values(own)[0])) for own, view in soft), default=0.0)


def settled(machine: HybridMachine, mode: str, t: float, x: np.ndarray) -> str:
    """The mode that a state is in, of those that soft transitions connect: no guard is past zero there."""
    for _ in range(MOST_SWITCHES):
        flow = machine.mode(mode)
        for transition, guard in zip(flow.transitions, flow.guards, strict=True):
            value, _, uncertainty = guard(t, x[flow.states], flow.p)
            sign = {"falling": 1.0, "rising": -1.0}.get(transition.direction, 0.0)
            if sign * value < -uncertainty:
                mode = transition.target
                break
        else:
            return mode
    return mode


def _pieces(
    machine: HybridMachine, mode: str, begin: float, x: np.ndarray, end: float, magnitudes: np.ndarray
) -> tuple[list[Piece], np.ndarray]:
    """Legs between soft transitions with first states and durations, and the last state.

    The last one's transition is open.
    """
    found: list[Piece] = []
    if end <= begin:
        return [(Leg(mode), x, end - begin)], x
    for arc in motion_segments(machine, begin, x, mode, end, Control(TOLERANCE, magnitudes)):
        if arc.status != "ok":
            raise NotFinite(f"The motion ends at t = {arc.times[-1]:.6g} s: {arc.reason or arc.status}", "")
        transition = None
        if arc.transition is not None:
            transition = machine.system.transition(arc.transition, arc.mode)
        lasts = float(arc.times[-1] - arc.times[0])
        found.append((Leg(arc.mode, transition, not arc.rising), arc.states[0], lasts))
        last = arc.states[-1]
    if found[-1][0].transition is not None:  # it switches just at the end
        leg, state, lasts = found[-1]
        found[-1] = (replace(leg, transition=None), state, lasts)
    return found, last


def _lasting(pieces: list[Piece], least: float) -> list[Piece]:
    """The pieces without those in between that last no time: what switched has switched back."""
    k = 1
    while k < len(pieces) - 1:
        (before, x, first), (_, _, own), (after, _, last) = pieces[k - 1 : k + 2]
        if own < least and before.mode == after.mode:
            pieces[k - 1 : k + 2] = [(after, x, first + own + last)]
            k = max(k - 1, 1)
        else:
            k += 1
    return pieces


def limits_of(system: System, itinerary: Itinerary) -> tuple[Limit, ...]:
    """All that must stay positive along the legs of an itinerary, in any of the modes of each."""
    found: dict[Limit, None] = {}
    for i, leg in enumerate(itinerary.legs):
        before = itinerary.leading_in(system, i)
        for mode in system.modes_around(leg.mode):
            own = next((t for t in system.leaving(mode) if t.name == leg.name), None)
            for limit in limits_of_leg(system, mode, own, before, i):
                found[limit] = None
            for soft in system.leaving(mode):
                if soft.role == "soft":
                    found |= dict.fromkeys(conditions_at(system, soft, i))
    return tuple(found)
