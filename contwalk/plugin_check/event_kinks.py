"""Guards and resets that are smooth by pieces only, where their event happens.

Where a reset or the surface of a guard jumps no orbit beyond is near, and where slopes jump multipliers do.
Elsewhere nothing depends on it. Where a jump lies along the surface of the guard itself, rounding decides on
which side an event is: nothing can be made of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk.errors import NO_LINE, UnsupportedOperation
from contwalk.fields.blame import first_switched
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.fields.trace import Tracer, trace
from contwalk.plugin_check.events import Happening, traced_reset
from contwalk.plugin_check.findings import Report, split_switch
from contwalk.plugin_check.samples import Samples, as_field
from contwalk.plugin_check.states_at_event import state_on
from contwalk.plugin_check.traced import Traced, number_form, traced
from contwalk.problems.event_kinks import EndMap, between, on_a_jump
from contwalk.problems.kink import PARTED, Kink
from contwalk.system import System, Transition

# How many pairs of states at an event are looked between, and at how many places each.
PAIRS, PLACES = 8, 24
# Two neighbouring places on a guard are on one piece of its surface if not further apart than so many parts.
NEXT = 4.0


def check_event_kinks(
    report: Report, happening: Happening, reset: Traced | None, system: System, samples: Samples
) -> None:
    """Tell of jumps of a transition's guard and reset, and of their slopes, between states at the event."""
    end = _end_map(happening, reset, system, samples)
    if end is None or _lies_on_a_jump(report, happening, end):
        return
    places = _places(happening)[: PAIRS + 1]
    found = [
        met.kink
        for ends in pairwise(places)
        for piece in _pieces(happening, *ends, samples)
        for met in between(end, *piece)
    ]
    for kink in dict.fromkeys(found):
        _tell(report, "warning", kink, _sentence(kink))


def check_told_kinks(report: Report, happening: Happening, system: System, samples: Samples) -> None:
    """Tell of conditions at an event, and of what is watched there, that jump through zero between states at
    it.
    """
    transition = happening.transition
    if transition.role == "watched" or not happening.before:
        return
    places = _places(happening)[: PAIRS + 1]
    told = [
        (after, end)
        for of, mode, after, function in _told_there(transition, system)
        if (end := _map({of: function}, mode, places, system, samples, acts=False)) is not None
    ]
    if not told:  # nothing chooses, as on most machines
        return
    reset = traced_reset(Report(), transition, system)
    pieces = [piece for ends in pairwise(places) for piece in _pieces(happening, *ends, samples)]
    for after, end in told:
        moved = [[_landed(reset, place, samples) for place in piece] if after else piece for piece in pieces]
        for kink in dict.fromkeys(met.kink for a, b in moved for met in between(end, a, b)):
            sentence = (
                f"It jumps through zero here ({_what(kink)}), at states where '{transition.name}' happens: a "
                "branch that gets there is told to be admissible on one side only, without a special point. "
                "Return a number that passes zero there smoothly."
            )
            _tell(report, "warning", kink, sentence)


def _told_there(transition: Transition, system: System) -> Iterator[tuple[str, str, bool, Traced]]:
    """Conditions at a transition, and watched guards that read states: in words, in which mode, whether with
    the state after it, and traced.
    """
    form = number_form("function(t, x, p)")
    for condition in system.conditions:
        if condition.at == transition.name:
            after = condition.side == "after"
            mode, of = (transition.target if after else transition.source), f"condition '{condition.name}'"
            function = traced(Report(), of, condition.function, system, form, mode=mode)
            if function is not None:
                yield of, mode, after, function
    for other in system.leaving(transition.source):
        if other.role == "watched":
            of = f"guard of transition '{other.name}'"
            function = traced(Report(), of, other.guard, system, form, mode=transition.source)
            if function is not None and function.depends() - {0}:
                yield of, transition.source, False, function


def _landed(reset: Traced | None, place: np.ndarray, samples: Samples) -> np.ndarray:
    """The state after the transition, with its time."""
    if reset is None:
        return place
    return np.append(reset.values(float(place[-1]), place[:-1], samples.values), place[-1])


def chooses(*functions: Traced | None) -> bool:
    """Whether one of some functions is smooth by pieces only."""
    return any(function is not None and choices_of(function.program) for function in functions)


def check_on_a_jump(
    report: Report, happening: Happening, reset: Traced | None, system: System, samples: Samples
) -> None:
    """Tell of a jump of a transition's guard or reset at the states of its own event."""
    end = _end_map(happening, reset, system, samples)
    if end is not None:
        _lies_on_a_jump(report, happening, end)


def _lies_on_a_jump(report: Report, happening: Happening, end: EndMap) -> bool:
    """Whether there are jumps at states of the event, which are told."""
    places = _places(happening)
    moving = np.ones(len(end.sizes) + 1, dtype=bool)
    found = [kink for place in places if (kink := on_a_jump(end, place, moving)) is not None]
    always = 0 < len(found) == len(places)
    share = "every state" if always else f"{len(found)} of {len(places)} states"
    for kink in dict.fromkeys(found):
        sentence = (
            f"It jumps here ({_what(kink)}) at {share} of its own event that {'was' if always else 'were'} "
            "tried: just where the guard is zero, so that rounding decides between two outcomes. Leave the "
            "choice out: its guard passes zero in one direction; for both, write two transitions."
        )
        _tell(report, "error" if always else "warning", kink, sentence)
    return bool(found)


def _tell(report: Report, level: str, kink: Kink, sentence: str) -> None:
    place, _ = split_switch(kink.where)
    report.add(level, kink.of, sentence, place)


def _what(kink: Kink) -> str:
    return split_switch(kink.where)[1]


def _places(happening: Happening) -> np.ndarray:
    """States at the event with their times, a row each."""
    return np.array([[*x, t] for t, x in happening.before])


def _end_map(happening: Happening, reset: Traced | None, system: System, samples: Samples) -> EndMap | None:
    """What a transition does, as a function of the state and the time; None where it is smooth or watched."""
    transition = happening.transition
    if transition.role == "watched" or not happening.before:
        return None
    named = {"reset": reset, "guard": happening.guard}
    functions = {
        f"{kind} of transition '{transition.name}'": function
        for kind, function in named.items()
        if function is not None
    }
    return _map(functions, transition.source, _places(happening), system, samples, acts=True)


def _map(
    functions: Mapping[str, Traced],
    mode: str,
    places: np.ndarray,
    system: System,
    samples: Samples,
    acts: bool,
) -> EndMap | None:
    """Some functions by their names in words, of the state and the time; None where they are smooth."""

    def all_of(tracer: Tracer) -> list[Any]:
        return [entry for function in functions.values() for entry in function.recorded(tracer)]

    if not chooses(*functions.values()):
        return None
    try:
        program = trace(all_of)
    except UnsupportedOperation:  # together they compare too often, which an orbit's equations refuse
        return None
    given = samples.parameters | dict(system.mode(mode).constants)
    constants = {("p", k): value for k, value in enumerate(samples.values)}

    def evaluate(places: np.ndarray) -> Inputs:
        return {("x", i): x for i, x in enumerate(places.T[:-1])} | {("t", 0): places[:, -1]} | constants

    def blame(before: np.ndarray, after: np.ndarray) -> tuple[str, str]:
        ends = [(float(place[-1]), place[:-1].tolist()) for place in (before, after)]
        for of, function in reversed(list(functions.items())):
            where = first_switched(as_field(function), ends[0], ends[1], given)
            if where != NO_LINE:
                return of, where
        return next(iter(functions)), NO_LINE

    switching = Switching(program, [("x", i) for i in range(len(system.states))], ("t", 0))
    return EndMap(switching, acts, acts, evaluate, np.abs(places).max(axis=0)[:-1], blame, not acts)


def _pieces(
    happening: Happening, a: np.ndarray, b: np.ndarray, samples: Samples
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Neighbouring places on the guard's surface on the way from one to another."""
    way = [a + share * (b - a) for share in np.linspace(0.0, 1.0, PLACES)]
    states = [state_on(happening.guard, place[-1], place[:-1], samples) for place in way]
    found = [None if x is None else np.append(x, place[-1]) for x, place in zip(states, way, strict=True)]
    scales = np.append(samples.scales, 1.0)
    furthest = NEXT * float(np.max(np.abs(b - a) / scales)) / PLACES
    return [
        (one, other)
        for one, other in pairwise(found)
        if one is not None and other is not None and np.max(np.abs(other - one) / scales) <= furthest
    ]


def _sentence(kink: Kink) -> str:
    if kink.order == 0:
        return (
            f"It jumps here ({_what(kink)}), at states where its event happens: a branch that gets there "
            f"ends. {PARTED}, or make it continuous."
        )
    return (
        f"Its slopes jump here ({_what(kink)}), at states where its event happens: multipliers of a branch "
        f"that crosses this place jump, and special points near it may stay unlocated. {PARTED}, or make it "
        "smooth."
    )
