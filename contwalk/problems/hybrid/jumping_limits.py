"""Conditions, and guards away from their own event, that jump through zero: between two orbits, and on one.

The equations by which a limit is located have no solution there. Of what is only told the motion goes on as
if nothing had been, but `admissible` changes, and no special point is there. Where the guard of a transition
that acts jumps, its event happens, or ceases to, and no equation tells it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from contwalk.errors import NO_LINE, NotFinite, PluginError
from contwalk.fields.blame import first_switched
from contwalk.fields.switching import Inputs, Switching
from contwalk.memory import memory_of, remembered
from contwalk.problems.event_kinks import between, through_zero
from contwalk.problems.hybrid.end_maps import (
    Written,
    after,
    functions_at_end,
    map_at,
    passages_of,
    place_of,
    written,
)
from contwalk.problems.hybrid.limited_orbit import LimitedOrbit
from contwalk.problems.hybrid.view import GuardedView
from contwalk.problems.kink import JumpThroughZero, Kink, Met
from contwalk.problems.kinks import AT_END, Course, differ, directions, inputs, located
from contwalk.problems.orbit.passage import Passage
from contwalk.system import Condition, Transition

# A guard within this part of its size is zero.
ROUNDED = 1e-9
# Instants before and after the end of a leg, in units of its duration.
AROUND_END = 1.0 - AT_END, 1.0 + AT_END


@dataclass(frozen=True, eq=False)
class Told:
    """A number that may jump: a condition, or a guard by its place out of the mode."""

    name: str
    switching: Switching
    function: Written
    of: Condition | int
    acts: bool = False

    def values(self, view: GuardedView) -> tuple[float, float]:
        """Where its leg starts and where it ends; of a condition, which has one place, twice the same."""
        if isinstance(self.of, Condition):
            return view.conditions[self.of.name], view.conditions[self.of.name]
        ends = view.ends[self.of]
        return ends[0][0], ends[-1][0]


# -- between two orbits ------------------------------------------------------------------------------------


def passed(problem: LimitedOrbit, a: np.ndarray, b: np.ndarray) -> tuple[Met, ...]:
    """What jumps through zero on the way from one orbit to another, at the ends of legs.

    Legs of soft transitions, which may come and go, are compared only where both orbits have the same ones.

    a and b have the shape (N + 1,).
    """
    if not any(_told_on(passage) for passage in passages_of(problem, a)):
        return ()
    try:
        views = [problem.view(z) for z in (a, b)]
        found = tuple(met for pair in alike(*views) for met in _on_leg(problem, *pair))
    except (NotFinite, PluginError, np.linalg.LinAlgError):
        return ()
    if not any(met.kink.refused for met in found):
        return found
    # A guard that is armed again by its jump, as a sawtooth of the time is, changes nothing.
    changes = problem.admissible_at(a) != problem.admissible_at(b)
    return tuple(met for met in found if changes or not met.kink.refused)


def alike(
    before: tuple[GuardedView, ...], later: tuple[GuardedView, ...]
) -> Iterator[tuple[GuardedView, GuardedView]]:
    """The legs of two orbits, if they are of the same kinds."""
    if [view.piece.passage for view in before] == [view.piece.passage for view in later]:
        yield from zip(before, later, strict=True)


def _on_leg(problem: LimitedOrbit, one: GuardedView, other: GuardedView) -> Iterator[Met]:
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
                acts=told.acts,
                through_zero=True,
                share=float(share),
            )
            yield from between(event, place_of(one, start=start), place_of(other, start=start))


def _told_on(passage: Passage) -> tuple[Told, ...]:
    """Conditions at the end of a leg, and guards that do not end it."""
    known = memory_of(passage, "jumping limits")
    told: tuple[Told, ...] = remembered(known, "told", 1, lambda: tuple(_all_told_on(passage)))
    return told


def _all_told_on(passage: Passage) -> Iterator[Told]:
    mapped = functions_at_end(passage)[1:]
    for condition in passage.conditions:
        found = passage.switching_of(f"condition {condition.name}", condition.function, condition.side)
        if found is not None:
            function = written(condition.function)
            if condition.side == "after" and mapped:
                function = after(function, mapped[-1][1])
            yield Told(f"condition '{condition.name}'", found, function, condition)
    if not passage.leg.collapsed:
        yield from (told for own, told in _guards_on(passage) if own != passage.leg.transition)


def _guards_on(passage: Passage) -> Iterator[tuple[Transition, Told]]:
    """The guards out of a leg's mode that may jump."""
    if passage.guards_jump:
        yield from (
            (own, told)
            for own, told in pieced_guards(passage)
            if told.switching.jumps(range(len(told.switching.choices)))
        )


def pieced_guards(passage: Passage) -> Iterator[tuple[Transition, Told]]:
    """The guards out of a leg's mode that are smooth by pieces only."""
    for place, own in enumerate(passage.leaving):
        found = passage.switching_of(f"guard {own.name}", own.guard)
        if found is not None:
            name, function = f"the guard of transition '{own.name}'", written(own.guard)
            yield own, Told(name, found, function, place, own.role != "watched")


# -- on the way of one orbit -------------------------------------------------------------------------------


def along(problem: LimitedOrbit, z: np.ndarray) -> tuple[Kink, ...]:
    """Guards that jump through zero on the way of an orbit: where their event happens, or after it has.

    z has the shape (N + 1,).
    """
    if not any(passage.guards_jump for passage in passages_of(problem, z)):
        return ()
    return tuple(dict.fromkeys(kink for view in problem.view(z) for kink in _along_leg(problem, view, z)))


def _along_leg(problem: LimitedOrbit, view: GuardedView, z: np.ndarray) -> Iterator[Kink]:
    passage = view.piece.passage
    if not view.duration > 0.0:
        return
    for own, told in _guards_on(passage):
        course = course_of(problem, view, told, z)
        sides = course.sides(course.times, course.states)
        for k in np.flatnonzero(np.any(differ(sides[:-1], sides[1:]), axis=1)).tolist():
            low, high = located(course, k)
            if low <= AT_END or high >= 1.0 - AT_END:
                continue
            pieces = beside(course, low, high)
            if _happens(own, *pieces) or (
                np.any(through_zero(*pieces)) and _has_been_before(own, course, k, float(pieces[0][0, 0]))
            ):
                yield _jump(course, low, high, told)
        # An orbit that closes without an event goes on through its last instant, where a ramp may begin anew.
        if passage.leg.transition is None and _happens(own, *beside(course, *AROUND_END)):
            yield _jump(course, *AROUND_END, told)


def _jump(course: Course, low: float, high: float, told: Told) -> JumpThroughZero:
    """The jump between two instants of a leg."""
    states = course.at(np.minimum([low, high], 1.0))
    return JumpThroughZero(0, course.where((low, states[0]), (high, states[1])), told.name, told.acts)


def course_of(problem: LimitedOrbit, view: GuardedView, told: Told, z: np.ndarray) -> Course:
    """A leg, as one of its guards is looked at. z has the shape (N + 1,)."""
    passage, values = view.piece.passage, view.piece.values(view.scalars)
    known = {**problem.values_of(z), **passage.system.mode(passage.leg.mode).constants}

    def evaluate(times: np.ndarray, states: np.ndarray) -> Inputs:
        return inputs(passage.groups, values, times, states)

    def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
        ends = [(view.start + view.duration * t, view.full(x).tolist()) for t, x in (before, after)]
        found = first_switched(told.function, ends[0], ends[1], known)
        return found if found != NO_LINE else told.name

    return Course(told.switching, evaluate, view.times, view.states, view.at, where)


def beside(course: Course, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """A guard on either side of a place at which it may jump: both pieces there, with their derivatives."""
    times = np.array([low, high])
    states = course.at(np.minimum(times, 1.0))
    before, later = (course.evaluate(times[k : k + 1], states[k : k + 1]) for k in range(2))
    along_ = directions(course.switching, before, np.abs(course.states).max(axis=0))
    one, other = course.switching.beside(before, before, later, along_)
    return one, other


def _happens(transition: Transition, before: np.ndarray, later: np.ndarray) -> bool:
    """Whether a jump from one piece to another is its event."""
    rises = bool(before[0, 0] < later[0, 0])
    ways = {"falling": not rises, "rising": rises}
    return bool(np.any(through_zero(before, later))) and ways.get(transition.direction, True)


def _has_been_before(transition: Transition, course: Course, k: int, last: float) -> bool:
    """Whether a guard that is past zero after sample k has been before its zero on the same leg.

    It has passed it on the way: its event comes earlier, and the jump alone hides it.
    """
    values = course.switching.values(course.evaluate(course.times[: k + 1], course.states[: k + 1]))[:, 0]
    size = max(float(np.nanmax(np.abs(values))), abs(last))
    way = -1.0 if transition.direction == "rising" else 1.0
    return bool(np.nanmax(way * values) > ROUNDED * size)
