"""Conditions, and watched guards at the ends of legs, that jump through zero between two orbits.

The motion goes on as if nothing had been; but `admissible` changes, and no special point is there: the
equations by which a limit is located have no solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.errors import NotFinite, PluginError
from contwalk.fields.switching import Switching
from contwalk.problems.event_kinks import Met, between
from contwalk.problems.hybrid.discretized_orbit import DiscretizedOrbit
from contwalk.problems.hybrid.end_maps import Written, after, functions_at_end, map_at, place_of, written
from contwalk.problems.hybrid.view import LegView
from contwalk.problems.orbit.passage import Passage
from contwalk.system import Condition


@dataclass(frozen=True, eq=False)
class _Told:
    """A number that is smooth by pieces only: a condition, or a guard by its place out of the mode."""

    name: str
    switching: Switching
    function: Written
    of: Condition | int

    def values(self, view: LegView) -> tuple[float, float]:
        """Where its leg starts and where it ends; of a condition, which has one place, twice the same."""
        if isinstance(self.of, Condition):
            return view.conditions[self.of.name], view.conditions[self.of.name]
        ends = view.ends[self.of]
        return ends[0][0], ends[-1][0]


def passed(problem: DiscretizedOrbit, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What jumps through zero on the way from one orbit to another.

    Legs of soft transitions, which may come and go, are compared only where both orbits have the same ones.
    """
    if not any(True for passage in problem.passages for _ in _told_on(passage)):
        return ()
    try:
        views = [problem.view(z) for z in (a, b)]
        return tuple(met for pair in _alike(*views) for met in _on_leg(problem, *pair))
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return ()


def _alike(before: tuple[LegView, ...], later: tuple[LegView, ...]) -> Iterator[tuple[LegView, LegView]]:
    """The legs of two orbits, if they are of the same kinds."""
    if [view.piece.passage for view in before] == [view.piece.passage for view in later]:
        yield from zip(before, later, strict=True)


def _on_leg(problem: DiscretizedOrbit, one: LegView, other: LegView) -> Iterator[Met]:
    passage = one.piece.passage
    for told in _told_on(passage):
        for share, (a, b) in enumerate(zip(told.values(one), told.values(other), strict=True)):
            start = share == 0
            if not a * b < 0.0 or (start and isinstance(told.of, Condition)):
                continue
            event = map_at(
                problem,
                passage,
                told.switching,
                [(told.name, told.function)],
                acts=False,
                share=float(share),
            )
            yield from between(event, place_of(one, start=start), place_of(other, start=start))


def _told_on(passage: Passage) -> Iterator[_Told]:
    """Conditions at the end of a leg, and what is watched on one that an event ends."""
    mapped = functions_at_end(passage)[1:]
    for condition in passage.conditions:
        found = passage.switching_of(f"condition {condition.name}", condition.function, condition.side)
        if found is not None:
            function = written(condition.function)
            if condition.side == "after" and mapped:
                function = after(function, mapped[-1][1])
            yield _Told(f"condition '{condition.name}'", found, function, condition)
    if passage.leg.transition is None or passage.leg.collapsed:
        return
    for place, other in enumerate(passage.leaving):
        if other.role == "watched":
            found = passage.switching_of(f"guard {other.name}", other.guard)
            if found is not None:
                yield _Told(f"the guard of transition '{other.name}'", found, written(other.guard), place)
