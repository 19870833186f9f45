"""What is said of a motion in which no return has been found, or the best one after all."""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, StartError
from contwalk.flow.hybrid.motion_segment import MotionSegment
from contwalk.problems.conserving import ONE_OF_EACH_VALUE
from contwalk.problems.hybrid.hybrid_recurrence import HybridRecurrence
from contwalk.problems.hybrid.mirrors import Span
from contwalk.problems.initial.event_search import EVENT, LOOK_BACK, Search
from contwalk.problems.initial.recurrence import recurrent
from contwalk.problems.orbit.itinerary import Leg

# So many times as large as where it began, a motion has grown without bound.
BEYOND = 1e9
FIRST_RETURN = " Where it is near an orbit that may be unstable, until: 0 takes its first near return."


def given_up(search: Search) -> HybridRecurrence:
    """The best return, where the motion ended or went on without an exact one.

    Raises
    ------
    NotFinite, StartError
    """
    if search.ended is not None:
        return _cut_short(search, search.ended)
    if not search.period and search.last_state is not None and not search.stretches:
        return _smooth(search)
    raise StartError(f"{_found_nothing(search)}{_nearest(search)}{_noted(search)}", _remedy(search))


def _cut_short(search: Search, arc: MotionSegment) -> HybridRecurrence:
    """The best return of a motion that has ended, if it was not to settle, or to last for longer."""
    if search.best is not None and search.until is None:
        return search.best
    grown = _grown(search)
    if grown:
        raise StartError(
            f"The motion grows without bound: {grown}{_where(search)}.{_noted(search)}",
            "Start from a motion that stays bounded, or at parameters at which it does.",
        )
    error = NotFinite if arc.status == "not_finite" else StartError
    remedy = "Start elsewhere, or mend the plugin."
    if search.best is not None:
        remedy += FIRST_RETURN
    raise error(f"The simulation ends{_where(search)}: {arc.reason or arc.status}{_noted(search)}", remedy)


def _grown(search: Search) -> str:
    """The state that has grown most, and is beyond what any motion of a machine is; empty if none is."""
    if search.last_state is None or search.origin is None:
        return ""
    x = np.abs(search.last_state[1])
    k = int(np.argmax(x))
    if not x[k] > BEYOND * (float(np.max(np.abs(search.origin))) or 1.0):
        return ""
    return f"'{search.system.state_names[k]}' is {search.last_state[1][k]:.1e}"


def _noted(search: Search) -> str:
    return f" {search.note}" if search.note else ""


def _where(search: Search) -> str:
    return "" if search.last_state is None else f" at t = {search.system.lasting(search.last_state[0])}"


def _found_nothing(search: Search) -> str:
    """Why there is no return, of a motion that goes on."""
    if search.keeps_volumes:
        return (
            f"The motion did not come back within {search.events} events{_where(search)}, and does not "
            "settle: volumes of states neither shrink nor grow along it, as where nothing is lost. "
            f"It looks quasi-periodic or irregular{_conserves(search)}."
        )
    if not search.exhausted:
        return f"The simulation meets no more events{_where(search)}, and has not come back before."
    work = f"after {search.events} events and {search.work - EVENT * search.events} steps{_where(search)}"
    if not search.looking:
        return f"The simulation was given up {work}: that is more than may pass before until."
    return (
        f"The search for a return was given up {work}: it settles slower than that, or on one that "
        f"is not periodic, or comes back after more than {LOOK_BACK} events."
    )


def _nearest(search: Search) -> str:
    if search.best is None:
        return ""
    return f" Its nearest return missed by {search.best.missed:.2g} of the motion's size."


def _conserves(search: Search) -> str:
    """What a machine that loses nothing seems to do; forcing changes its energy."""
    if search.period or search.system.conserved:
        return ""
    return ", and the machine seems to conserve a quantity, such as its energy"


def _remedy(search: Search) -> str:
    if search.keeps_volumes:
        declare = f"{ONE_OF_EACH_VALUE} " if _conserves(search) else ""
        return f"{declare}Start from a state on, or near, a periodic orbit.{FIRST_RETURN}"
    remedy = "Start from another state"
    if search.looking:
        remedy += ", or look for a return later with until: SECONDS"
    # Else it is the first near return that was looked for.
    return remedy + "." + (FIRST_RETURN if search.until is not None else "")


def _smooth(search: Search) -> HybridRecurrence:
    """An orbit of an autonomous system that meets no event, in the mode in which the motion stays."""
    assert search.last_state is not None
    _, x, mode = search.last_state
    own = list(search.system.states_of(mode))
    found = recurrent(search.system, search.parameters, x[own], mode=mode)
    state, magnitudes = np.zeros(len(x)), np.ones(len(x))
    state[own], magnitudes[own] = found.state, found.magnitudes
    stretch = Span(Leg(mode), 0.0, state, found.period, state)
    return HybridRecurrence((stretch,), magnitudes, 0.0, state)
