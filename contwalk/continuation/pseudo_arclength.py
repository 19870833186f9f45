"""The walk along a branch: predict, correct, detect, adapt, yield."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation import limits, outcomes
from contwalk.continuation.closing import place_of_closure
from contwalk.continuation.crowd import Crowd
from contwalk.continuation.excursion import reentered
from contwalk.continuation.locating import Found
from contwalk.continuation.marks import Observer
from contwalk.continuation.records import end_record, found_record
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, adapted, grown
from contwalk.continuation.step import Step, take_step
from contwalk.errors import ContwalkError, NotFinite
from contwalk.problems.parents import SymmetriesLost
from contwalk.problems.problem import LimitType, Problem, Sample


@dataclass(frozen=True)
class Point:
    """A solution found by a walk. `special` is its record where it is a special point."""

    state: ContinuationState
    special: SpecialPoint | None = None


@dataclass(frozen=True)
class End:
    """The end of a walk, with the record of its end point."""

    outcome: Outcome
    special: SpecialPoint


def walk(
    problem: Problem,
    state: ContinuationState,
    settings: Settings,
    observer: Observer,
    sign: float,
    points: int,
    *,
    begun: ContinuationState | None = None,
    done: int = 0,
    crowd: Crowd | None = None,
) -> Iterator[Point | End]:
    """Solutions along a branch from `state`, special points in their places, and how it ended.

    Parameters
    ----------
    state : ContinuationState
        A solution, its tangent pointing the way to go. It is not yielded itself.
    sign : float
        +1 where arclength grows along the walk, -1 where it decreases (the other direction from a start).
    points : int
        How many points there may still be.
    begun : ContinuationState, optional
        Where the walk began that goes on here; a branch that comes back there is closed.
    done : int
        How many points it has had since.
    crowd : Crowd, optional
        Those of them that were not located.
    """
    origin, number, point, lost = begun or state, 0, (problem, state), SymmetriesLost()
    crowd = crowd or Crowd()
    try:
        while True:
            closed: float | None = None
            slid = False
            before = _effort(problem)
            if outcome := _finished(problem, state, number, points, settings, observer):
                back = _back(problem, state, settings, sign, outcome)
                if back is None:
                    break
                problem, state = back
                state = replace(state, sample=_with_effort(problem, state.sample, before))
            else:
                step = take_step(problem, state, settings, observer)
                if isinstance(step, Outcome):
                    outcome = step
                    break
                if done + number + len(step.found) >= 3:
                    closed = place_of_closure(step.segment, step.found, origin.sample)
                for place, found in _on_the_way(step, state, sign):
                    if closed is not None and found.theta > closed:
                        break  # told already, where the walk began
                    record = found_record(step.segment.problem, found, place.s, sign)
                    yield Point(place, record)
                    number += 1
                    crowd.tell(record.status == "located", place.s, place.sample.error)
                    if outcome := _stop(step.segment.problem, found, record, settings):
                        place = replace(place, sample=replace(place.sample, unstable=found.after))
                        yield End(outcome, end_record(problem, place, outcome, sign, point=record))
                        return
                slid = _slid(lost, step)
                state = _arrived(problem, step, state, sign, settings, before, origin.sample)
            problem, state, point = yield from _taken_up(problem, state, settings)
            number += 1
            if slid:
                outcome = outcomes.slid_onto_parent(observer.line.free, state.sample.parameter)
                break
            if closed is not None:
                outcome = outcomes.closed()
                break
            if crowd.is_noise:
                outcome = outcomes.noise(crowd.error, observer.line.free, state.sample.parameter)
                break
    except outcomes.BREAKDOWNS as error:
        # Whatever cannot be computed is how this direction ends, and nothing else.
        reason = outcomes.reason_of(error)
        sentence = error.sentence if isinstance(error, ContwalkError) else outcomes.singular(error)
        known = "" if reason == "plugin_error" else problem.diagnosis.obstacle(state.sample.z)
        outcome = outcomes.given_up(reason, sentence, observer.line.free, state.sample.parameter, known)
    bound = _bound(state, settings, observer) if outcome.reason == "bound" else None
    if point[1].s == state.s and not np.array_equal(point[1].sample.z, state.sample.z):
        problem, state = point  # what follows would have begun elsewhere on the orbit: the end is the point
    yield End(outcome, end_record(problem, state, outcome, sign, bound=bound))


def _taken_up(
    problem: Problem, state: ContinuationState, settings: Settings
) -> Generator[Point, None, tuple[Problem, ContinuationState, tuple[Problem, ContinuationState]]]:
    """A point on the steps, or with the borders, for what follows it; and as it was told, on its own."""
    try:
        there, sample = adapted(problem, state.sample)
    except (NotFinite, np.linalg.LinAlgError):
        yield Point(state)
        raise
    if _leaves_an_end(state.sample, sample, settings):
        yield Point(state)
        return problem, state, (problem, state)
    problem = there
    point = problem, state
    if np.array_equal(sample.z, state.sample.z):
        yield Point(state)
    else:  # on new steps the solution is another: that one is the point, and taken up as if stored
        state = replace(state, sample=sample)
        point = problem, state
        yield Point(state)
        problem, sample = adapted(problem, sample)
    return problem, replace(state, sample=sample), point


def _leaves_an_end(before: Sample, after: Sample, settings: Settings) -> bool:
    """Whether a point at an end of the range is not there any more on other steps: it is to stay as it is."""
    at_end = [place for place, ends in settings.bounds.items() if before.z[place] in ends]
    return any(after.z[place] != before.z[place] for place in at_end)


def _back(
    problem: Problem, state: ContinuationState, settings: Settings, sign: float, outcome: Outcome
) -> tuple[Problem, ContinuationState] | None:
    """Where a curve in two parameters that leaves its range comes back; None where it does not."""
    if outcome.reason != "bound" or problem.line.second is None:
        return None
    return reentered(problem, state, settings, sign)


def _slid(lost: SymmetriesLost, step: Step) -> bool:
    """Whether a step lies along the parent of the walk's own branch, onto which earlier ones have slid.

    Equilibria are known to rounding, and may come as near to a symmetric one as a parameter lets them.
    """
    problem, a, b = step.segment.problem, step.segment.a, step.there
    if problem.meshed is None:
        return False
    apart = problem.equivalence.asymmetries
    return lost.regained(lambda: apart(a.z), lambda: apart(b.z))


def _finished(
    problem: Problem,
    state: ContinuationState,
    number: int,
    points: int,
    settings: Settings,
    observer: Observer,
) -> Outcome | None:
    """Why not to take another step, if there is a reason."""
    if number >= points:
        return outcomes.max_points(settings.max_points, problem.diagnosis.growth(state.sample.z))
    reached = _bound(state, settings, observer)
    return None if reached is None else outcomes.bound(*reached)


def _bound(state: ContinuationState, settings: Settings, observer: Observer) -> tuple[str, float] | None:
    """The parameter that is at an end of its range, and its value there."""
    place = state.bound_at(settings)
    return None if place is None else (observer.line.names[-1 - place], float(state.sample.z[place]))


def _on_the_way(
    step: Step, state: ContinuationState, sign: float
) -> Iterator[tuple[ContinuationState, Found]]:
    """The special points of a step with their places."""
    for found in step.found:
        yield (
            ContinuationState(found.sample, state.s + sign * found.theta * step.segment.length, state.step),
            found,
        )


def _arrived(
    problem: Problem,
    step: Step,
    state: ContinuationState,
    sign: float,
    settings: Settings,
    before: tuple[float, int],
    origin: Sample,
) -> ContinuationState:
    """The place at the end of a step, with what the step has cost."""
    sample = _with_effort(problem, grown(problem, step.there, state, settings, origin), before)
    return ContinuationState(sample, state.s + sign * step.segment.length, step.next_length)


def _with_effort(problem: Problem, sample: Sample, before: tuple[float, int]) -> Sample:
    """A sample with what it has cost since then."""
    seconds, evaluations = (now - then for now, then in zip(_effort(problem), before, strict=True))
    return sample.varied(seconds=seconds, evaluations=int(evaluations))


def _stop(problem: Problem, found: Found, record: SpecialPoint, settings: Settings) -> Outcome | None:
    """The end of the branch at a point: at a limit, where it meets its parent, or where a mark has a value of
    `stop_at`.
    """
    limited = problem.limited
    if limited is not None and found.kind != "unlocated" and isinstance(found.type, LimitType):
        asked = limits.policy(problem, found.located, settings.events)
        if asked == "ignore":
            return None
        words = limited.stopped(found.located, found.sample)
        if asked == "switch":
            words = f"{words} {limited.neighbours(record)[1]}"
        final = limits.final(limited.limits[int(found.located.vectors["limit"])], found.located)
        return outcomes.limit(found.type, final, asked, words)
    if found.located.vectors.get("returned_to_parent"):
        return outcomes.returned_to_parent()
    if found.type.saddles and settings.neutral_saddles == "stop":
        return outcomes.neutral_saddles()
    if found.mark is None:
        return None
    name, value = found.mark
    if value is None:
        return None
    wanted = value in settings.stop_at.get(name, ())
    return outcomes.stop_at(f"{name} = {value:.10g}") if wanted else None


def _effort(problem: Problem) -> tuple[float, int]:
    """Clock and number of evaluations so far."""
    return time.perf_counter(), problem.evaluations
