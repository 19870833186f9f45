"""Conditions, and guards at the ends of legs, that jump through zero between two orbits.

The motion goes on as if nothing had been; but `admissible` changes, and no special point is there: the
equations by which a limit is located have no solution.
"""

from __future__ import annotations

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.fields.switching import Switching
from contwalk.problems.event_kinks import Met, between
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.end_maps import Written, after, functions_at_end, map_at, place_of, written
from contwalk.problems.hybrid.limits import margins, transition_of
from contwalk.problems.hybrid.margins import Limit

AT_ENDS = ("condition", "start", "end")


def passed(problem: DiscretizedOrbit, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What jumps through zero on the way from one orbit to another, where its limit changes sign with it."""
    choosing = [
        (k, limit, *found)
        for k, limit in enumerate(problem.limits)
        if limit.test in AT_ENDS and (found := _choosing(problem, limit)) is not None
    ]
    if not choosing:
        return ()
    try:
        views = [problem.view(z) for z in (a, b)]
        values = [margins(problem, z).relative for z in (a, b)]
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return ()
    met: list[Met] = []
    for k, limit, switching, function in choosing:
        if not values[0][k] * values[1][k] < 0.0:
            continue
        start = limit.test == "start"
        passage = problem.passages[limit.leg]
        places = [place_of(view[limit.leg], start=start) for view in views]
        event = map_at(problem, passage, switching, [function], acts=False, share=0.0 if start else 1.0)
        met += between(event, *places)
    return tuple(met)


def _choosing(problem: DiscretizedOrbit, limit: Limit) -> tuple[Switching, tuple[str, Written]] | None:
    """The number that a limit is of, if it is smooth by pieces only, with its name in words."""
    passage = problem.passages[limit.leg]
    if limit.test != "condition":
        transition = transition_of(problem, limit)
        found = passage.switching_of(f"guard {transition.name}", transition.guard)
        named = f"the guard of transition '{transition.name}'", written(transition.guard)
        return None if found is None else (found, named)
    condition = next(c for c in passage.conditions if c.name == limit.name)
    found = passage.switching_of(f"condition {condition.name}", condition.function, condition.side)
    function = written(condition.function)
    mapped = functions_at_end(passage)[1:]
    if condition.side == "after" and mapped:
        function = after(function, mapped[-1][1])
    return None if found is None else (found, (f"condition '{condition.name}'", function))
