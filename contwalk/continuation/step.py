"""One step along a branch: predict, correct, and examine what lies between; shorter until all tests agree."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import branch_jumps, control, limits, outcomes
from contwalk.continuation.attempt import (
    Attempt,
    Cause,
    Refusal,
    attempt,
    first_jump,
    nearest_bound,
    towards_a_bound,
)
from contwalk.continuation.correction import Explanation, text_of
from contwalk.continuation.ends import edge_reached, end_ahead, up_to_end
from contwalk.continuation.folds import at_branch_point
from contwalk.continuation.locating import SAME_POINT, WELL_BEYOND, Disagreement, Found, unlocated
from contwalk.continuation.marks import Observer
from contwalk.continuation.returns import back_at_parent
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.special_points import (
    COINCIDE,
    at_the_end,
    everything,
    everything_before,
    with_counts,
)
from contwalk.continuation.state import ContinuationState
from contwalk.errors import NotFinite, PluginError
from contwalk.problems.problem import Linearization, Problem, Sample, Test

# A family of orbits is followed to this size, in the metric, before it counts as shrunk onto its Hopf point.
NEARLY_SHRUNK = 1e-3
# How far from a branch point that a walk begins at its side is looked at, in parts of the first step, where
# equations are exact.
BESIDE = 1e-4
# A step is lost in the error of where it ends, if that is a larger part of it.
BLURRED = 0.1
SUDDENLY = 1e3  # what is known so many times worse than before, and not to its size, may be anything
# The field's domain ends where a step this short still leaves it.
EDGE = 1e-7
ON_PARENT = "The step ends on a solution that repeats itself, or is its own image, as those before do not."
UNTOLD_FROM_PARENT = (
    "The branch is not told from the one that it leaves: what is found is that one's. A finer `accuracy` may "
    "tell them apart."
)


@dataclass(frozen=True)
class Step:
    """An accepted step: the piece of branch, what is special on it, and the length of the next step."""

    segment: Segment
    there: Sample
    found: list[Found]
    next_length: float


def take_step(
    problem: Problem, state: ContinuationState, settings: Settings, observer: Observer
) -> Step | Outcome:
    """The longest step from here that converges, turns little, and on which the tests agree."""
    return _Search(problem, state, settings, observer).step()


@dataclass
class _Search:
    """The search for a step from a solution, by shorter and shorter attempts, and what these have told."""

    problem: Problem
    state: ContinuationState
    settings: Settings
    observer: Observer
    # Where a field ends ahead: the reason, whatever stops later.
    edge: tuple[str, Explanation] | None = None
    # Steps from a branch point on which the branch is a parabola that turns too much; whether one is tried.
    parabolas: list[float] = field(default_factory=list)
    on_parabola: bool = False
    # For the parent, beside which shorter steps know no more; for a point at which curves end.
    looked: bool = False
    ended: bool = False
    # What the smallest step sees and cannot locate.
    seen: Found | None = None

    def step(self) -> Step | Outcome:
        """The first attempt that is a step, or how the branch ends."""
        length = min(self.state.step, self.settings.max_step)
        while True:
            attempted = attempt(self.problem, self.state, length, self.settings)
            met = self._met(attempted)
            if isinstance(met, Outcome):
                return met
            self.on_parabola = isinstance(met, Refusal) and met.instead is not None
            if isinstance(met, Refusal) and met.instead is not None:
                length = met.instead
                continue
            # Beside a point at which curves end, steps fail, or their ends are not known beside their length.
            doubtful = isinstance(met, Refusal) or met.there.error > BLURRED * length
            if doubtful and not self.ended:
                self.ended = True
                end = end_ahead(self.problem, self.state.sample, length, self.settings, self.observer)
                if end is not None:
                    return Step(end[0], end[0].b, [end[1]], length)
            if isinstance(met, Step):
                return met
            outcome = self._given_up(attempted, met)
            if outcome is not None:
                return outcome
            length = self._shorter(attempted)

    def _met(self, attempted: Attempt) -> Step | Outcome | Refusal:
        """The step that an attempt is, how the branch ends on it, or why it is none."""
        correction = attempted.correction
        if attempted.jump is not None:
            return Refusal(Cause.NO_SOLUTION, attempted.why_no_further(attempted.jump), "plugin_error")
        if not correction.ok:
            return Refusal(Cause.NO_SOLUTION, correction.explanation, correction.reason)
        try:
            met = self._taken(attempted)
        except (Disagreement, LostBranch) as error:
            met = Refusal(Cause.UNDECIDED, str(error))
        except np.linalg.LinAlgError:
            return Refusal(Cause.NO_SOLUTION, "The equations are singular there in more than one direction.")
        except (PluginError, NotFinite) as error:
            return Refusal(Cause.NO_SOLUTION, error.sentence, error.reason)
        if not isinstance(met, Refusal):
            return self._regained(attempted, met) or self._seen_once(met, attempted)
        if met.cause is Cause.BLURRED:  # the last step that turned too much was a parabola: that one, then
            return replace(met, instead=self.parabolas.pop())
        if met.cause is Cause.PARABOLA:
            self.parabolas.append(attempted.length)
            return met
        return self._regained(attempted, met) or met

    def _taken(self, attempted: Attempt) -> Step | Outcome | Refusal:
        """The step that a corrected attempt is, with all that is special on it, or how the branch ends on it.

        Raises
        ------
        Disagreement, LostBranch
            If what is special on it cannot be told.
        """
        prediction, smallest, length = attempted.prediction, attempted.smallest, attempted.length
        segment = self._segment(attempted)
        if not isinstance(segment, Segment):
            return segment
        if self.parabolas and segment.b.error > BLURRED * length:
            return Refusal(Cause.BLURRED, "Where the step ends is not known beside its length.")
        segment = attempted.with_kinks(segment)
        outcome = segment.problem.diagnosis.ended(segment.a, segment.b)
        if outcome and not (outcome.reason == "unbounded" and towards_a_bound(segment.b, self.settings)):
            if outcome.reason == "shrunk" and length > NEARLY_SHRUNK and not smallest:
                return Refusal(Cause.TURNS, "The orbit shrinks to nothing within the step.")
            short = up_to_end(segment)
            if short is None:
                return outcome
            segment = short
        found = self._special(segment, smallest)
        if any(_of_the_parent(segment, f) for f in found):
            return Refusal(Cause.PARENT, ON_PARENT)
        if not all(control.inside(f.located.z, self.settings.bounds) for f in found):
            return Refusal(Cause.TURNS, "The step passes the end of the range and comes back.")
        if not (smallest or prediction.to_bound) and _ends_at_a_limit(segment, found, self.settings):
            return Refusal(Cause.TURNS, "The step ends at a limit, to within its errors.")
        if prediction.to_bound and not any(f.theta > 1.0 - COINCIDE for f in found):
            found += [f for f in at_the_end(segment) if f.type.tells_of(f.located)]
        return Step(segment, segment.b, found, self._next_length(segment, attempted))

    def _segment(self, attempted: Attempt) -> Segment | Outcome | Refusal:
        """The piece of branch up to the corrected point, or why it is not to be trusted, or ends before.

        Raises
        ------
        LostBranch
            If the branch cannot be followed beside the branch point that it begins at.
        """
        prediction, correction, a = attempted.prediction, attempted.correction, self.state.sample
        problem, linearization = correction.problem, correction.linearization
        smallest = attempted.smallest or self.on_parabola
        assert linearization is not None
        z = correction.z
        if prediction.bounded is not None:
            z = z.copy()
            z[prediction.bounded] = prediction.guess[prediction.bounded]
            if problem.diagnosis.many_branches(z):
                return _onto_crossing(problem, a, z, linearization)
        if np.array_equal(z, a.z):
            return Refusal(Cause.UNDECIDED, "The step is too short to be told from none in double precision.")
        try:
            tangent = linearization.tangent(a.tangent / a.weights**2, a.weights)
        except np.linalg.LinAlgError:
            return Refusal(Cause.TURNS, "The tangent is not determined.")
        given = a, z, tangent, prediction, self.settings, bool(self.parabolas)
        if not smallest and (refused := branch_jumps.misshapen(*given)):
            return refused
        if not control.inside(z, self.settings.bounds):
            return self._beyond_the_range(a, z, attempted.length)
        if problem.equivalence.gains_symmetry(a.z, z):
            return Refusal(Cause.PARENT, ON_PARENT)
        if a.orientation == 0.0 and problem.equivalence.keeps_symmetry(a.z, prediction.guess, z):
            return Refusal(Cause.TURNS, UNTOLD_FROM_PARENT)
        there = problem.examine(z, tangent, a.weights, linearization, a.unstable)
        suddenly = problem.meshed is not None and there.error > max(1.0, SUDDENLY * a.error)
        if suddenly and a.orientation != 0.0:
            return Refusal(Cause.TURNS, "What is found there is not known to its own size.")
        there = _counted_beyond(a, there.varied(iterations=correction.iterations))
        segment = Segment(problem, a, there)
        if not smallest and branch_jumps.jumped(segment, correction.effort):
            return Refusal(Cause.TURNS, branch_jumps.ELSEWHERE)
        # Orientation is not defined at a branch point that the walk begins at.
        return segment if a.orientation != 0.0 else Segment(segment.problem, _beside(segment), segment.b)

    def _beyond_the_range(self, a: Sample, z: np.ndarray, length: float) -> Outcome | Refusal:
        """What a step to z, shape (N + 1,), beyond the end of a range is: too long, or rounding.

        Where the parameter stands still along a branch, at that end to what it is known to, it is rounding.
        """
        known = self.settings.min_step if a.orientation == 0.0 else a.error
        for place, ends in self.settings.bounds.items():
            end = min(max(z[place], ends[0]), ends[1])
            left = abs(end - a.z[place])
            if end != z[place] and abs(a.tangent[place]) * length < left <= known * a.weights[place]:
                return outcomes.stays_at_bound(self.observer.line.names[-1 - place], float(end))
        return Refusal(Cause.TURNS, "The step passes the end of the range.")

    def _special(self, segment: Segment, smallest: bool) -> list[Found]:
        """Everything special on a segment, in order; at the smallest step, what cannot be located as well.

        What that has `seen` is told where it was, with the counts of a segment around it.
        """
        state, given = self.state, (self.settings, self.observer, self.state.sample.orientation == 0.0)
        try:
            reached = limits.passed(segment, begins=state.s == 0.0)
            end = limits.stopping(segment.problem, reached, self.settings.events)
            if end is None:
                found = [*everything(segment, *given), *reached]
            else:  # what lies beyond is not the machine's motion, and its tests tell nothing
                found, end = everything_before(segment, end, *given)
                found += limits.up_to(segment.problem, reached, end, self.settings.events)
        except Disagreement as disagreement:
            if not (smallest or self.seen):
                raise
            a, b, width = segment.a, segment.b, abs(float(segment.chord[-1]))
            what = disagreement.type, b, width, disagreement.sentence
            found = [unlocated(1.0, *what, a.unstable, b.unstable)]
            if self.seen is not None:
                place = segment.position(self.seen.located.z)
                found = [replace(self.seen, theta=place, after=segment.b.unstable)]
        counted = with_counts(sorted(found, key=lambda f: f.theta), segment.a.unstable)
        return [f for f in counted if f.type.tells_of(f.located)]

    def _seen_once(self, step: Step | Outcome, attempted: Attempt) -> Step | Outcome | Refusal:
        """A step, unless it is the smallest one and tells what it cannot locate.

        Within what solutions are known to, tests change their signs several times at one such point: it is
        told by the step that leads beyond that.
        """
        beyond = min(SAME_POINT, WELL_BEYOND * self.state.sample.error)
        lost = [f for f in step.found if f.kind == "unlocated"] if isinstance(step, Step) else []
        if not (lost and attempted.smallest and self.seen is None and attempted.length < beyond):
            return step
        self.seen = lost[0]
        return Refusal(Cause.UNDECIDED, self.seen.note, instead=beyond)

    def _regained(self, attempted: Attempt, met: Step | Outcome | Refusal) -> Step | None:
        """The step to where the branch is its parent's again; None where it is not that.

        It is looked for where a step ends on the parent, and once where one is shorter than its ends are
        known to.
        """
        problem, sample, length = attempted.correction.problem, self.state.sample, attempted.length
        on_parent = isinstance(met, Refusal) and met.cause is Cause.PARENT
        known = max(sample.error, met.there.error if isinstance(met, Step) else 0.0)
        if not on_parent and (self.looked or length >= known):
            return None
        self.looked = self.looked or length < known
        back = back_at_parent(problem, sample, max(length, sample.error), self.settings, self.observer)
        return None if back is None else Step(back[0], back[0].b, [back[1]], attempted.length)

    def _given_up(self, attempted: Attempt, refused: Refusal) -> Outcome | None:
        """How the branch ends where no shorter attempt is to be made; None where one is."""
        reason, explanation, jump = refused.reason, refused.explanation, attempted.jump
        problem, sample = self.problem, self.state.sample
        corrected = reason == "not_finite" and attempted.correction.iterations
        if corrected and problem.diagnosis.obstacle(sample.z):
            # It is the corrections that are too large, and not the field that ends ahead.
            reason, explanation = "no_convergence", "Newton's method leads to where equations have no value."
        ends = False
        if reason in ("not_finite", "plugin_error") and jump is None:
            self.edge = reason, explanation
            ends = reason == "not_finite" and edge_reached(problem, sample)
        before_jump = jump is not None and attempted.room < EDGE
        before_edge = attempted.length < EDGE and self.edge is not None
        if not (ends or attempted.smallest or before_jump or before_edge):
            return None
        reason, explanation = self.edge or (reason, explanation)
        left, which, bound = nearest_bound(sample, self.settings)
        if left <= self.settings.min_step:
            return outcomes.bound_but_for(self.observer.line.names[-1 - which], bound, sample.z[which])
        known = problem.diagnosis.obstacle(sample.z) or attempted.switchings()
        place = self.observer.line.free, sample.parameter
        return outcomes.stuck(reason, text_of(explanation), attempted.length, *place, known)

    def _shorter(self, attempted: Attempt) -> float:
        """The next shorter length to try."""
        # Where a solution jumps along the step, the guess tells.
        length, given = attempted.length, (self.state.sample.z, attempted.prediction.guess)
        ahead = None if attempted.jump is None else first_jump(self.problem.diagnosis.passed(*given))
        return control.shrunk(length) if ahead is None else control.beside(length, ahead.share)

    def _next_length(self, segment: Segment, attempted: Attempt) -> float:
        prediction, angle = attempted.prediction, control.turn(segment.a, segment.b.tangent)
        length = control.next_step(prediction.length, angle, attempted.correction.effort, self.settings)
        return max(length, self.state.step) if prediction.to_bound else length


def _counted_beyond(a: Sample, b: Sample) -> Sample:
    """The end of a step over a branch point, at which a real eigenvalue is not known to its own size.

    Such ones count as at the neighbouring point; but one of them has passed, and its sign tells. Where that
    tells of none that has, as of a family's own one, which is rounding, it is the only count that is left.
    """
    if a.orientation * b.orientation >= 0.0 or a.unstable != b.unstable:
        return b
    real = b.eigenvalues[: len(b.measures)].imag == 0.0
    doubtful = real & (np.abs(b.measures) <= b.errors)
    certain = int(np.count_nonzero(b.measures > b.errors))
    counted = certain + int(np.count_nonzero(doubtful & (b.measures > 0.0)))
    possible = {n for n in range(certain, certain + int(doubtful.sum()) + 1) if abs(n - a.unstable) == 1}
    if counted not in possible and len(possible) == 1 and b.along:
        counted = possible.pop()
    return b.varied(unstable=counted) if abs(counted - a.unstable) == 1 else b


def _onto_crossing(problem: Problem, a: Sample, z: np.ndarray, linearization: Linearization) -> Segment:
    """The step onto an end of the range that is a branch point itself: the tangent there is the chord's."""
    there = problem.examine(z, z - a.z, a.weights, linearization, a.unstable)
    return Segment(problem, a, replace(there, orientation=a.orientation, unstable=a.unstable))


def _beside(segment: Segment) -> Sample:
    """The branch point that a walk begins at, with orientation and stability as they are right beside it."""
    meshed = segment.problem.meshed
    near = segment.at(segment.beside(BESIDE if meshed is None else meshed.branching_offset))
    return replace(
        segment.a,
        tangent=at_branch_point(segment.a.tangent, segment.a.weights),
        orientation=near.orientation,
        measures=near.measures,
        rates=near.rates,
        errors=near.errors,
        eigenvalues=near.eigenvalues,
        unstable=near.unstable,
        still=near.still,
    )


def _of_the_parent(segment: Segment, found: Found) -> bool:
    """Whether a fold is where the branch is its parent's again, and goes on as its own image."""
    equivalence = (found.located.problem or segment.problem).equivalence
    return found.type.test is Test.TURN and equivalence.gains_symmetry(segment.a.z, found.located.z)


def _ends_at_a_limit(segment: Segment, found: list[Found], settings: Settings) -> bool:
    """Whether the walk goes on from a step that ends at a limit, to within what its margin is known to."""
    reached = [f for f in found if f.kind != "unlocated" and f.type.test is Test.MARGIN]
    goes_on = limits.stopping(segment.problem, reached, settings.events) is None
    return goes_on and limits.in_doubt(segment)
