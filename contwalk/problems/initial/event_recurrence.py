"""From a state to a recurrence: simulate until an event finds it where an earlier one of its kind did.

What happened in between is the recurrence's itinerary; nobody has to type it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from contwalk.flow.hybrid.event_integrator import METHOD
from contwalk.flow.hybrid.motion_segment import Control, MotionSegment
from contwalk.flow.hybrid.motions import HybridMachine, applied, hybrid_machine, motion_segments
from contwalk.flow.hybrid.on_guard import check_on_guard
from contwalk.flow.hybrid.past_zero import past_zero
from contwalk.flow.hybrid.scales import magnitudes
from contwalk.flow.hybrid.stiffness import is_stiff
from contwalk.flow.method import IMPLICIT
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.initial.event_search import Search
from contwalk.problems.initial.giving_up import given_up
from contwalk.system import System

TOLERANCE = 1e-9
# How many times as long each stretch is as the one before, after stability has ended the first.
LONGER = 20.0


def recurrence_from(
    system: System,
    parameters: Mapping[str, float],
    state: np.ndarray,
    mode: str | None = None,
    at: str | None = None,
    until: float | str | None = "settled",
    *,
    time: float = 0.0,
    after: str | None = None,
    least: float = 0.0,
    longest: float = np.inf,
    elsewhere: Mapping[str, float] | None = None,
) -> HybridRecurrence:
    """One recurrence of the orbit that a motion leads to from a state, shape (n,).

    Parameters
    ----------
    mode : str, optional
        In which the motion begins, the first one by default.
    at : str, optional
        The state is the one right before this transition.
    after : str, optional
        The state is the one right after this transition.
    least : float
        Seconds that a recurrence lasts at least.
    longest : float
        Seconds after which the search for one ends.
    elsewhere : mapping, optional
        Other values of the parameters, for which a symmetry that an orbit closes up to has to hold as well.
    until : float, "settled" or None
        Seconds to simulate before looking for a return; `settled` waits until returns agree closely; None
        takes the first that comes near: the state is on an orbit, perhaps an unstable one.

    Raises
    ------
    NotFinite, StartError
        If the motion ends, comes to rest, accumulates events, or does not come back.
    """
    machine = hybrid_machine(system, parameters)
    mode = mode or system.modes[0].name
    x = np.array(state, dtype=float)
    if at is not None:
        happening = machine.transition(at, None if len(system.sources(at)) == 1 else mode)
        before = x
        x, mode, after = applied(machine, happening, time, x), happening.target, at
        scales = [each.scale for each in system.states]
        typical = magnitudes(machine, time, x, mode, np.inf, scales, METHOD, at)
        check_on_guard(machine, happening, time, before, typical)
    search = Search(system, parameters, None if until == 0 else until, least)
    search.elsewhere = elsewhere
    if after is not None:
        search.first = False  # the first arc is a whole leg
    search.origin = x
    if after is None:
        search.note = past_zero(machine, time, x, mode, search.weights(x))
    for arc in _motion(machine, time, x, mode, after, search, time + longest):
        recurrence = search.add(arc)
        if recurrence is not None:
            return recurrence
    return given_up(search)


def _motion(
    machine: HybridMachine, t: float, x: np.ndarray, mode: str, last: str | None, search: Search, end: float
) -> Iterator[MotionSegment]:
    """Arcs of the motion until `end`, in stretches short enough to notice that nothing happens.

    A stretch ends between events: right after one, a new start would not know what of a guard is rounding.
    Where stability limits the steps of the explicit method, the implicit one goes on from there.
    """
    quiet, method, most, goes_on = 0, METHOD, np.inf, False
    while True:
        weights = search.weights(x)
        length = min(search.stretch(machine, t, x, mode, weights), end - t, most)
        most *= LONGER
        control = Control(TOLERANCE, weights, method, watched=False)
        for arc in motion_segments(machine, t, x, mode, t + length, control, last, goes_on=goes_on):
            if method == METHOD and arc.status == "too_many_steps" and is_stiff(machine, arc):
                # How large the states are matters to it, and so short a motion tells little of that.
                method, most = IMPLICIT, LONGER * float(arc.times[-1] - arc.times[0])
                search.see(arc)
                break
            yield arc
            search.check_moves(machine, arc)
            if arc.status != "ok" or search.hopeless(machine, arc):
                return
            t = float(arc.times[-1])
            if arc.transition is None:
                quiet += len(arc.times)
                x, last, goes_on = arc.states[-1], None, True
            else:
                assert arc.after is not None
                quiet, x, last, goes_on = 0, arc.after, arc.transition, False
                mode = machine.transition(arc.transition, arc.mode).target
        if t >= end or not search.waits(quiet):
            return
