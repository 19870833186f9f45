"""The walk along a branch: predict, correct, detect, adapt, yield."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation import limits, outcomes
from contwalk.continuation.allowance import Allowance
from contwalk.continuation.attempt import nearest_bound
from contwalk.continuation.ends import Crowd
from contwalk.continuation.excursion import reentered
from contwalk.continuation.locating import Found
from contwalk.continuation.marks import Observer
from contwalk.continuation.records import end_record, found_record
from contwalk.continuation.returns import place_of_closure
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


@dataclass(frozen=True)
class Earlier:
    """What a walk has behind it that goes on: nothing, where it sets out.

    Parameters
    ----------
    begun : ContinuationState, optional
        Where it began; a branch that comes back there is closed.
    crowd : Crowd
        Points since then that were not located.
    """

    begun: ContinuationState | None = None
    crowd: Crowd = field(default_factory=Crowd)


def walk(
    problem: Problem,
    state: ContinuationState,
    settings: Settings,
    observer: Observer,
    sign: float,
    points: int,
    *,
    earlier: Earlier | None = None,
    allowance: Allowance | None = None,
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
    earlier : Earlier, optional
        What the walk has behind it, where it goes on.
    allowance : Allowance, optional
        What it may cost, which is told of each point; as much as it takes by default.
    """
    allowance = allowance or Allowance()
    return _Walk(problem, state, settings, observer, sign, points, earlier or Earlier(), allowance).whole()


class _Walk:
    """A walk under way: the problem as it is posed now, and the last solution."""

    def __init__(
        self,
        problem: Problem,
        state: ContinuationState,
        settings: Settings,
        observer: Observer,
        sign: float,
        points: int,
        earlier: Earlier,
        allowance: Allowance,
    ) -> None:
        self._problem, self._state = problem, state
        self._yielded = problem, state  # the last solution as it was yielded
        self._settings, self._observer, self._sign = settings, observer, sign
        self._left = points
        self._origin = (earlier.begun or state).sample
        self._crowd, self._lost, self._allowance = earlier.crowd, SymmetriesLost(), allowance
        allowance.tell(self._origin.parameter)

    def whole(self) -> Iterator[Point | End]:
        """All points, and the end."""
        try:
            ended = yield from self._to_its_end()
        except outcomes.BREAKDOWNS as error:
            # Whatever cannot be computed is how this direction ends, and nothing else.
            ended = self._broken_down(error)
        yield ended if isinstance(ended, End) else self._end(ended)

    def _to_its_end(self) -> Generator[Point, None, Outcome | End]:
        """Predict, correct, detect, adapt, yield, until there is a reason to end."""
        while True:
            spent = _effort(self._problem)
            slid, closed_at = False, None
            if outcome := self._finished():
                if not self._comes_back(outcome, spent):
                    return outcome
            else:
                step = take_step(self._problem, self._state, self._settings, self._observer)
                if isinstance(step, Outcome):
                    return step
                closed_at = place_of_closure(step.segment, step.found, self._origin)
                end = yield from self._special_points(step, closed_at)
                if end is not None:
                    return end
                slid = _slid(self._lost, step)
                self._arrive(step, spent)
            yield from self._take_up()
            if outcome := self._over(slid, closed_at is not None):
                return outcome

    def _finished(self) -> Outcome | None:
        """Why not to take another step, if there is a reason."""
        if self._left <= 0:
            growth = self._problem.diagnosis.growth(self._state.sample.z)
            return outcomes.max_points(self._settings.max_points, growth)
        reached = self._bound()
        if reached is not None:
            return outcomes.bound(*reached)
        return outcomes.effort() if self._allowance.used_up else None

    def _bound(self) -> tuple[str, float] | None:
        """The parameter that is at an end of its range, and its value there."""
        left, place, _ = nearest_bound(self._state.sample, self._settings)
        at_it = self._observer.line.names[-1 - place], float(self._state.sample.z[place])
        return at_it if left <= 0.0 else None

    def _comes_back(self, outcome: Outcome, spent: tuple[float, int]) -> bool:
        """Whether a curve in two parameters that leaves its range was followed to where it comes back."""
        if outcome.reason != "bound" or self._problem.line.second is None:
            return False
        back = reentered(self._problem, self._state, self._settings, self._sign)
        if back is None:
            return False
        self._problem, state = back
        self._state = replace(state, sample=_with_effort(self._problem, state.sample, spent))
        return True

    def _special_points(self, step: Step, closed_at: float | None) -> Generator[Point, None, End | None]:
        """The special points of a step, and the end that one of them may be."""
        own, begins = step.segment, self._state
        for found in step.found:
            if closed_at is not None and found.theta > closed_at:
                break  # told already, where the walk began
            s = begins.s + self._sign * found.theta * own.length
            place = ContinuationState(found.sample, s, begins.step)
            known = _known(found, own.a), _known(found, step.there)
            record = found_record(own.problem, found, s, self._sign, known)
            yield self._counted(Point(place, record))
            self._crowd.tell(record.status == "located", s, place.sample.error)
            if outcome := _stop(own.problem, found, record, self._settings):
                place = replace(place, sample=replace(place.sample, unstable=found.after))
                return End(outcome, end_record(self._problem, place, outcome, self._sign, point=record))
        return None

    def _counted(self, point: Point) -> Point:
        self._left -= 1
        sample = point.state.sample
        self._allowance.tell(sample.parameter, sample.evaluations)
        return point

    def _arrive(self, step: Step, spent: tuple[float, int]) -> None:
        """Stand at the end of a step, which has cost what it has."""
        there = grown(self._problem, step.there, self._state, self._settings, self._origin)
        s = self._state.s + self._sign * step.segment.length
        self._state = ContinuationState(_with_effort(self._problem, there, spent), s, step.next_length)

    def _take_up(self) -> Iterator[Point]:
        """Yield the solution, and have it on the steps, or with the borders, for what follows it."""
        try:
            there, sample = adapted(self._problem, self._state.sample)
        except (NotFinite, np.linalg.LinAlgError):
            yield self._counted(Point(self._state))
            raise
        if _leaves_an_end(self._state.sample, sample, self._settings):
            there, sample = self._problem, self._state.sample
        self._problem, another = there, not np.array_equal(sample.z, self._state.sample.z)
        if another:  # on new steps the solution is another: that one is the point, and taken up as if stored
            self._state = replace(self._state, sample=sample)
        self._yielded = there, self._state
        yield self._counted(Point(self._state))
        if another:
            self._problem, sample = adapted(there, sample)
        self._state = replace(self._state, sample=sample)

    def _over(self, slid: bool, closed: bool) -> Outcome | None:
        """What ends the walk at a point that it has arrived at, if anything does."""
        where = self._observer.line.free, self._state.sample.parameter
        if slid:
            return outcomes.slid_onto_parent(*where)
        if closed:
            return outcomes.closed()
        self._crowd.pass_by(self._state.s, self._state.sample.error)
        noise = self._crowd.noise(self._settings.max_step)
        return None if noise is None else outcomes.noise(*noise, *where)

    def _broken_down(self, error: ContwalkError | np.linalg.LinAlgError) -> Outcome:
        """The end of a walk at which something cannot be computed."""
        reason = outcomes.reason_of(error)
        sentence = error.sentence if isinstance(error, ContwalkError) else outcomes.singular(error)
        last = self._state.sample
        known = "" if reason == "plugin_error" else self._problem.diagnosis.obstacle(last.z)
        return outcomes.given_up(reason, sentence, self._observer.line.free, last.parameter, known)

    def _end(self, outcome: Outcome) -> End:
        """The end of a walk, at the last point."""
        bound = self._bound() if outcome.reason == "bound" else None
        problem, state = self._problem, self._state
        last = self._yielded[1]
        if last.s == state.s and not np.array_equal(last.sample.z, state.sample.z):
            problem, state = self._yielded  # what follows would have begun elsewhere on the orbit
        return End(outcome, end_record(problem, state, outcome, self._sign, bound=bound))


def _leaves_an_end(before: Sample, after: Sample, settings: Settings) -> bool:
    """Whether a point at an end of the range is not there any more on other steps: it is to stay as it is."""
    at_end = [place for place, ends in settings.bounds.items() if before.z[place] in ends]
    return any(after.z[place] != before.z[place] for place in at_end)


def _known(found: Found, side: Sample) -> bool:
    """Whether stability is known on a side of a point, which a sample beside it stands for if it is none.

    At a bifurcation that is located an eigenvalue, or a pair of them, is critical, and known to be.
    """
    many = found.located.multiplicity if any(found.type.changes) else 0
    located = found.kind != "unlocated" and found.sample.undecided <= 2 * many
    return located or not side.undecided


def _slid(lost: SymmetriesLost, step: Step) -> bool:
    """Whether a step lies along the parent of the walk's own branch, onto which earlier ones have slid.

    Equilibria are known to rounding, and may come as near to a symmetric one as a parameter lets them.
    """
    problem, a, b = step.segment.problem, step.segment.a, step.there
    if problem.meshed is None:
        return False
    apart = problem.equivalence.asymmetries
    return lost.regained(lambda: apart(a.z), lambda: apart(b.z))


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
        asked = limits.policy(problem, found, settings.events)
        if asked == "ignore":
            return None
        words = limited.stopped(found.located, found.sample)
        if asked == "switch":
            words = f"{words} {limited.neighbours(record)[1]}"
        final = limits.final(found.located.among(limited.limits), found.located)
        return outcomes.limit(found.type, final, asked, words)
    if found.located.returned_to_parent:
        return outcomes.returned_to_parent()
    if found.end is not None:
        return found.end
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
