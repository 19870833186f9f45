"""One motion of a hybrid machine for `contwalk simulate`, with both instants at each transition."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contwalk.flow import dense
from contwalk.flow.events.crossings import Event
from contwalk.flow.hybrid.going_through import going_through
from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import HybridMachine, MotionSegment, applied, hybrid_machine, parts
from contwalk.flow.hybrid.on_guard import check_on_guard
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.flow.hybrid.scales import magnitudes
from contwalk.problems.orbit.layout import Layout
from contwalk.problems.stored_itinerary import StoredItinerary
from contwalk.studies.at_one_instant import differing
from contwalk.system import System, Transition
from contwalk.system.falling import FALLEN, falls, name_of_fall
from contwalk.system.names import free_name
from contwalk.workflow.run_file.motions import Simulation
from contwalk.workflow.run_file.settings import ReportAt
from contwalk.workflow.simulated import LONGEST, PARTS, Simulated, drawn_at, settling_of


@dataclass(frozen=True, eq=False)
class Beginning:
    """Where a hybrid motion sets out.

    Parameters
    ----------
    state : ndarray, shape (n,)
    mode : str
    at : str, optional
        A transition that happens first.
    last : str, optional
        The transition that has just led to it.
    time : float
    """

    state: np.ndarray
    mode: str
    at: str | None = None
    last: str | None = None
    time: float = 0.0


def on_orbit(system: System, itinerary: StoredItinerary) -> Beginning:
    """Where the first leg of a stored orbit begins, right after the last one's transition."""
    sizes = [len(system.states_of(mode)) for mode, _, _ in itinerary.legs]
    layout = Layout(sizes, system.period is not None, len(itinerary.pins))
    mode, state = itinerary.legs[0][0], np.zeros(len(system.states))
    state[list(system.states_of(mode))] = itinerary.unknowns[layout.states[0]]
    time = 0.0 if layout.start is None else float(itinerary.unknowns[layout.start])
    last = itinerary.legs[-1][1]
    if itinerary.image:
        last = system.symmetry(itinerary.image).events.get(last, last)
    return Beginning(state, mode, last=last or None, time=time)


def simulated(
    system: System,
    parameters: Mapping[str, float],
    beginning: Beginning,
    asked: Simulation,
    place: ReportAt | None,
    progress: Callable[[float], None],
) -> Simulated:
    """The motion until a time, until it has settled, or until the machine has fallen.

    Raises
    ------
    StartError
        If all guards are past zero at the start, and none comes back.
    """
    watching, names = _with_sections(system, place)
    fall = name_of_fall(watching)
    falling = replace(watching, transitions=(*watching.transitions, *falls(watching)))
    machine = hybrid_machine(falling, parameters)
    method, points = asked.method, asked.points
    settles, start = asked.until == "settled", beginning.time
    end = np.inf if settles else start + float(asked.until)
    found, state, mode = _begun(machine, beginning)
    last = beginning.at or beginning.last
    scales = [s.scale for s in system.states]
    weights = magnitudes(machine, start, state, mode, end, scales, method, last)
    if beginning.at is not None:
        given = machine.existing(beginning.mode, beginning.state)
        check_on_guard(machine, machine.transition(beginning.at, beginning.mode), start, given, weights)
    settling, settled = settling_of(system), False
    steps = 0
    note = "" if last else past_zero(machine, start, state, mode, weights, (fall,))
    control = Control(asked.tolerance, weights, method)
    for part in parts(machine, start, state, mode, end, control, last):
        if part.transition == fall:
            part = replace(part, transition=None, after=None, status=FALLEN, reason="")
        found.append(part)
        progress(float(part.times[-1]))
        own = len(part.times) - 1
        steps += own
        if part.status == FALLEN:
            break
        if settles and own:
            even = np.linspace(part.times[0], part.times[-1], PARTS * own + 1)
            settled = settling.add(_between(machine, part, even, method), own)
            if settled or steps >= LONGEST:
                break
    events = [(machine.transition(each.transition, each.mode), each) for each in found if each.transition]
    ends = [(transition, float(each.times[-1]), each.states[-1]) for transition, each in events]
    note = " ".join(filter(None, (note, going_through(machine, ends), _orders(machine, found, weights))))
    begin, finish = found[0].times[0], found[-1].times[-1]
    times, values, modes = _stored(machine, found, np.linspace(begin, finish, points), method)
    steps_taken = np.unique(np.concatenate([part.times for part in found]))
    return Simulated(
        times=times,
        values=values,
        modes=modes,
        events=[replace(e, name=names.get(e.name, e.name)) for e in _events(machine, found)],
        status=found[-1].status,
        reason=found[-1].reason,
        settled=settled if settles else None,
        steps=steps,
        evaluations=sum(part.evaluations for part in found),
        note=note,
        drawn=_stored(machine, found, drawn_at(steps_taken, points), method),
    )


def _orders(machine: HybridMachine, found: Sequence[MotionSegment], weights: np.ndarray) -> str:
    """What is to be said of the first transitions at one instant whose order matters and is not declared."""
    following = pairwise(found)
    at_once = [before for before, after in following if before.transition and len(after.times) == 1]
    sentences = (differing(machine, float(o.times[-1]), o.states[-1], o.mode, weights) for o in at_once)
    return next(filter(None, sentences), "")


def _begun(machine: HybridMachine, beginning: Beginning) -> tuple[list[MotionSegment], np.ndarray, str]:
    """The event that a motion begins with, if it does; the state after it, and the mode."""
    state, mode = machine.existing(beginning.mode, beginning.state), beginning.mode
    if beginning.at is None:
        return [], state, mode
    happening = machine.transition(beginning.at, mode)
    after = applied(machine, happening, beginning.time, state)
    times = np.array([beginning.time])
    event = MotionSegment(mode, times, state[None], transition=beginning.at, after=after)
    return [event], after, happening.target


def _with_sections(system: System, place: ReportAt | None) -> tuple[System, dict[str, str]]:
    """The system with the section of `report_at` as watched transitions, and what they are called."""
    if place is None or place.section is None:
        return system, {}
    name, level = place.section
    column = system.state_names.index(name)

    def passed(t: object, x: np.ndarray, p: object) -> float:
        return x[column] - level

    taken = {transition.name for transition in system.transitions}
    added = []
    for mode in system.modes:
        if column in system.states_of(mode.name):
            own = free_name(f"section_in_{mode.name}", taken)
            direction = str(place.direction)
            added.append(Transition(own, mode.name, mode.name, passed, direction, role="watched"))
    watching = replace(system, transitions=(*system.transitions, *added))
    return watching, {transition.name: f"{name} = {level:g}" for transition in added}


def _between(machine: HybridMachine, part: MotionSegment, at: np.ndarray, method: str) -> np.ndarray:
    """Full-length states at instants of a part."""
    flow = machine.mode(part.mode)
    if len(part.times) == 1:
        return np.repeat(part.states, len(at), axis=0)
    states = dense(flow.field, flow.c, part.times, part.states[:, flow.states], at, method)
    return machine.full(part.mode, states)


def _events(machine: HybridMachine, found: list[MotionSegment]) -> list[Event]:
    """Everything that happened, with the mode after it."""
    events = []
    for part in found:
        events += part.watched
        if part.transition is not None and part.after is not None:
            target = machine.transition(part.transition, part.mode).target
            time, before = float(part.times[-1]), part.states[-1]
            events.append(Event(part.transition, time, part.rising, before, part.after, target))
    return events


def _stored(
    machine: HybridMachine, found: list[MotionSegment], grid: np.ndarray, method: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Given instants and both sides of each transition: times, states, numbers of modes."""
    numbers = [mode.name for mode in machine.system.modes]
    times, values, modes = [], [], []
    begins = True
    for index, part in enumerate(found):
        first, last = part.times[0], part.times[-1]
        ends = part.transition is not None or index == len(found) - 1
        at = grid[(grid > first) & (grid < last)]
        met = begins or bool((grid == first).any())
        at = np.concatenate([[first] if met else [], at, [last] if ends and last > first else []])
        times.append(at)
        values.append(_between(machine, part, at, method))
        modes.append(np.full(len(at), numbers.index(part.mode)))
        begins = part.transition is not None
    if begins and found[-1].after is not None:
        times.append(found[-1].times[-1:])
        values.append(found[-1].after[None])
        into = machine.transition(str(found[-1].transition), found[-1].mode).target
        modes.append(np.array([numbers.index(into)]))
    return np.concatenate(times), np.concatenate(values), np.concatenate(modes)
