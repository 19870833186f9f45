"""One step along a branch: predict, correct, and examine what lies between; shorter until all tests agree."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from contwalk.branch import Outcome
from contwalk.continuation import branch_jumps, control, kinks_passed, limits, outcomes
from contwalk.continuation.attempt import (
    Attempt,
    Prediction,
    Refusal,
    attempt,
    nearest_bound,
    towards_a_bound,
)
from contwalk.continuation.correction import Explanation, text_of
from contwalk.continuation.detection import at_the_end
from contwalk.continuation.ends import edge_reached, end_ahead, up_to_end
from contwalk.continuation.folds import at_branch_point
from contwalk.continuation.locating import SAME_POINT, WELL_BEYOND, Disagreement, Found, TooLong, unlocated
from contwalk.continuation.marks import Observer
from contwalk.continuation.returns import WentOver, back_at_parent
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Settings
from contwalk.continuation.special_points import COINCIDE, everything, everything_before, with_counts
from contwalk.continuation.state import ContinuationState
from contwalk.errors import NotFinite, PluginError
from contwalk.numerics.linear import norm_in
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


class Parabola(TooLong):
    """The branch turns too much within a step from a branch point, as the parabola does that it is there."""


class _Blurred(TooLong):
    """A step from a branch point that is lost in the error of where it ends."""


@dataclass(frozen=True)
class Step:
    """An accepted step: the piece of branch, what is special on it, and the length of the next step."""

    segment: Segment
    there: Sample
    found: list[Found]
    next_length: float


@dataclass
class _Search:
    """What longer attempts at a step have told."""

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


def take_step(
    problem: Problem, state: ContinuationState, settings: Settings, observer: Observer
) -> Step | Outcome:
    """The longest step from here that converges, turns little, and on which the tests agree."""
    length, search = min(state.step, settings.max_step), _Search()
    while True:
        attempted = attempt(problem, state, length, settings)
        met = _met(attempted, search, state, settings, observer)
        if isinstance(met, Outcome):
            return met
        search.on_parabola = isinstance(met, Refusal) and met.instead is not None
        if isinstance(met, Refusal) and met.instead is not None:
            length = met.instead
            continue
        # Beside a point at which curves end, steps fail, or end where little is known beside their length.
        doubtful = isinstance(met, Refusal) or met.there.error > BLURRED * length
        if doubtful and not search.ended:
            search.ended = True
            end = end_ahead(problem, state.sample, length, settings, observer)
            if end is not None:
                return Step(end[0], end[0].b, [end[1]], length)
        if isinstance(met, Step):
            return met
        outcome = _given_up(problem, attempted, met, search, state, settings, observer)
        if outcome is not None:
            return outcome
        length = _shorter(problem, state, attempted)


def _met(
    attempted: Attempt, search: _Search, state: ContinuationState, settings: Settings, observer: Observer
) -> Step | Outcome | Refusal:
    """The step that an attempt is, how the branch ends on it, or why it is none."""
    correction, length = attempted.correction, attempted.length
    if attempted.jump is not None:
        return Refusal("plugin_error", kinks_passed.refusal(correction.problem, attempted.jump))
    if not correction.ok:
        return Refusal(correction.reason, correction.explanation)
    try:
        return _seen_once(_taken(attempted, search, state, settings, observer), attempted, search, state)
    except _Blurred:
        return Refusal(correction.reason, "", instead=search.parabolas.pop())
    except Parabola as error:
        search.parabolas.append(length)
        return Refusal(correction.reason, str(error))
    except (TooLong, LostBranch) as error:
        blind = length < state.sample.error
        if isinstance(error, WentOver) or (blind and not search.looked):
            search.looked = search.looked or blind
            reach = max(length, state.sample.error) if blind else length
            back = back_at_parent(correction.problem, state.sample, reach, settings, observer)
            if back is not None:
                segment, point = back
                return Step(segment, segment.b, [point], length)
        return Refusal(correction.reason, str(error))
    except np.linalg.LinAlgError:
        return Refusal(correction.reason, "The equations are singular there in more than one direction.")
    except (PluginError, NotFinite) as error:
        return Refusal(error.reason, error.sentence)


def _taken(
    attempted: Attempt, search: _Search, state: ContinuationState, settings: Settings, observer: Observer
) -> Step | Outcome:
    """The step that a corrected attempt is, with all that is special on it, or how the branch ends on it.

    Raises
    ------
    TooLong, LostBranch
        If it is not to be trusted.
    """
    prediction, smallest, length = attempted.prediction, attempted.smallest, attempted.length
    segment = _segment(state, attempted, settings, search)
    if search.parabolas and segment.b.error > BLURRED * length:
        raise _Blurred("Where the step ends is not known beside its length.")
    segment = kinks_passed.with_kinks(segment, attempted.passed)
    outcome = segment.problem.diagnosis.ended(segment.a, segment.b)
    if outcome and not (outcome.reason == "unbounded" and towards_a_bound(segment.b, settings)):
        if outcome.reason == "shrunk" and length > NEARLY_SHRUNK and not smallest:
            raise TooLong("The orbit shrinks to nothing within the step.")
        short = up_to_end(segment)
        if short is None:
            return outcome
        segment = short
    found = _special(segment, settings, observer, smallest, state, search.seen)
    if not (smallest or prediction.to_bound) and _ends_at_a_limit(segment, found, settings):
        raise TooLong("The step ends at a limit, to within its errors.")
    if prediction.to_bound and not any(f.theta > 1.0 - COINCIDE for f in found):
        found += [f for f in at_the_end(segment) if f.type.tells_of(f.located)]
    return Step(segment, segment.b, found, _next_length(segment, attempted, state, settings))


def _seen_once(
    step: Step | Outcome, attempted: Attempt, search: _Search, state: ContinuationState
) -> Step | Outcome | Refusal:
    """A step, unless it is the smallest one and tells what it cannot locate.

    Within what solutions are known to, tests change their signs several times at one such point: it is told
    by the step that leads beyond that.
    """
    beyond = min(SAME_POINT, WELL_BEYOND * state.sample.error)
    lost = [f for f in step.found if f.kind == "unlocated"] if isinstance(step, Step) else []
    if not (lost and attempted.smallest and search.seen is None and attempted.length < beyond):
        return step
    search.seen = lost[0]
    return Refusal(attempted.correction.reason, search.seen.located.vectors["note"], instead=beyond)


def _given_up(
    problem: Problem,
    attempted: Attempt,
    refused: Refusal,
    search: _Search,
    state: ContinuationState,
    settings: Settings,
    observer: Observer,
) -> Outcome | None:
    """How the branch ends where no shorter attempt is to be made; None where one is."""
    reason, explanation, jump = refused.reason, refused.explanation, attempted.jump
    ends = False
    iterated = attempted.correction.iterations
    if reason == "not_finite" and iterated and problem.diagnosis.obstacle(state.sample.z):
        # It is the corrections that are too large, and not the field that ends ahead.
        reason, explanation = "no_convergence", "Newton's method leads to where the equations have no value."
    if reason in ("not_finite", "plugin_error") and jump is None:
        search.edge = reason, explanation
        ends = reason == "not_finite" and edge_reached(problem, state.sample)
    before_jump = jump is not None and kinks_passed.reach(jump, attempted.length) < EDGE
    before_edge = attempted.length < EDGE and search.edge is not None
    if not (ends or attempted.smallest or before_jump or before_edge):
        return None
    reason, explanation = search.edge or (reason, explanation)
    left, which, bound = nearest_bound(state.sample, settings)
    if left <= settings.min_step:
        return outcomes.bound_but_for(observer.line.names[-1 - which], bound, state.sample.z[which])
    known = problem.diagnosis.obstacle(state.sample.z) or kinks_passed.sentence(problem, attempted.passed)
    place = observer.line.free, state.sample.parameter
    return outcomes.stuck(reason, text_of(explanation), attempted.length, *place, known)


def _shorter(problem: Problem, state: ContinuationState, attempted: Attempt) -> float:
    """The next shorter length to try."""
    if attempted.jump is None:
        return control.shrunk(attempted.length)
    # A solution beyond has jumped: where it does along the step, the guess tells.
    ahead = kinks_passed.jump(kinks_passed.between(problem, state, attempted.prediction.guess))
    return (
        control.shrunk(attempted.length) if ahead is None else control.beside(attempted.length, ahead.share)
    )


def _segment(state: ContinuationState, attempted: Attempt, settings: Settings, search: _Search) -> Segment:
    """The piece of branch up to the corrected point; `TooLong` if it is not to be trusted."""
    prediction, correction, a = attempted.prediction, attempted.correction, state.sample
    problem, linearization = correction.problem, correction.linearization
    smallest = attempted.smallest or search.on_parabola
    assert linearization is not None
    z = correction.z
    if prediction.bounded is not None:
        z = z.copy()
        z[prediction.bounded] = prediction.guess[prediction.bounded]
        if problem.diagnosis.many_branches(z):
            return _onto_crossing(problem, a, z, linearization)
    if np.array_equal(z, a.z):
        raise LostBranch("The step is too short to be told from none in double precision.")
    tangent = _tangent(a, linearization)
    if not smallest:
        _check_shape(a, z, tangent, prediction, settings, bool(search.parabolas))
    if not control.inside(z, settings.bounds):
        raise TooLong("The step passes the end of the range.")
    if problem.equivalence.gains_symmetry(a.z, z):
        raise WentOver
    if a.orientation == 0.0 and problem.equivalence.keeps_symmetry(a.z, prediction.guess, z):
        raise TooLong(
            "The branch is not told from the one that it leaves: what is found is that one's. "
            "A finer `accuracy` may tell them apart."
        )
    there = problem.examine(z, tangent, a.weights, linearization, a.unstable)
    suddenly = problem.meshed is not None and there.error > max(1.0, SUDDENLY * a.error)
    if suddenly and a.orientation != 0.0:
        raise TooLong("What is found there is not known to its own size.")
    there = _counted_beyond(a, there.varied(iterations=correction.iterations))
    segment = Segment(problem, a, there)
    if not smallest and branch_jumps.jumped(segment, correction.effort):
        raise TooLong("The step does not lie along the branch: it may have left it for another one.")
    # Orientation is not defined at a branch point that the walk begins at.
    if a.orientation != 0.0:
        return segment
    beside = _beside(segment)
    return Segment(segment.problem, beside, segment.b)


def _counted_beyond(a: Sample, b: Sample) -> Sample:
    """The end of a step over a branch point, at which a real eigenvalue is not known to its own size.

    Such ones count as at the neighbouring point; but one of them has passed, and its sign tells.
    """
    if a.orientation * b.orientation >= 0.0 or a.unstable != b.unstable:
        return b
    real = b.eigenvalues[: len(b.measures)].imag == 0.0
    doubtful = real & (np.abs(b.measures) <= b.errors)
    positive = np.count_nonzero(doubtful & (b.measures > 0.0))
    counted = int(np.count_nonzero(b.measures > b.errors) + positive)
    return b.varied(unstable=counted) if abs(counted - a.unstable) == 1 else b


def _tangent(a: Sample, linearization: Linearization) -> np.ndarray:
    try:
        return linearization.tangent(a.tangent / a.weights**2, a.weights)
    except np.linalg.LinAlgError:
        raise TooLong("The tangent is not determined.") from None


def _check_shape(
    a: Sample,
    z: np.ndarray,
    tangent: np.ndarray,
    prediction: Prediction,
    settings: Settings,
    shorter: bool,
) -> None:
    """Refuse a step on which the branch turns too much, or that may have ended on another branch.

    Where longer ones have led to the parabola that a branch begins as, what is none is errors.
    """
    refused = _Blurred if shorter else TooLong
    angle = control.turn(a, tangent)
    moved = norm_in(z - prediction.guess, a.weights)
    if angle > settings.max_angle or moved > 0.5 * prediction.length:
        parabola = a.orientation == 0.0 and not prediction.to_bound and control.is_parabola(a, z, tangent)
        raise (Parabola if parabola else refused)(f"The branch turns by {angle:.0f} degrees in one step.")
    if control.left_branch(a, z, tangent, angle):
        raise refused("The step does not lie along the branch: it may have left it for another one.")


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


def _special(
    segment: Segment,
    settings: Settings,
    observer: Observer,
    smallest: bool,
    state: ContinuationState,
    seen: Found | None,
) -> list[Found]:
    """Everything special on a segment, in its order; at the smallest step, what cannot be located as well.

    What that has `seen` is told where it was, with the counts of a segment around it.
    """
    born = state.sample.orientation == 0.0
    try:
        reached = limits.passed(segment, begins=state.s == 0.0)
        end = limits.stopping(segment.problem, reached, settings.events)
        if end is None:
            found = [*everything(segment, settings, observer, born), *reached]
        else:  # what lies beyond is not the machine's motion, and its tests tell nothing
            found, end = everything_before(segment, end, settings, observer, born)
            found += limits.up_to(segment.problem, reached, end, settings.events)
    except Disagreement as disagreement:
        if not (smallest or seen):
            raise
        found = [_unlocated(segment, disagreement)]
        if seen is not None:
            found = [replace(seen, theta=segment.position(seen.located.z), after=segment.b.unstable)]
    if not all(control.inside(f.located.z, settings.bounds) for f in found):
        raise TooLong("The step passes the end of the range and comes back.")
    counted = with_counts(sorted(found, key=lambda f: f.theta), segment.a.unstable)
    return [f for f in counted if f.type.tells_of(f.located)]


def _ends_at_a_limit(segment: Segment, found: list[Found], settings: Settings) -> bool:
    """Whether the walk goes on from a step that ends at a limit, to within what its margin is known to."""
    reached = [f for f in found if f.kind != "unlocated" and f.type.test is Test.MARGIN]
    goes_on = limits.stopping(segment.problem, reached, settings.events) is None
    return goes_on and limits.in_doubt(segment)


def _unlocated(segment: Segment, disagreement: Disagreement) -> Found:
    """What is detected and cannot be located is kept, between the samples that show it."""
    b = segment.b
    width, counts = abs(float(segment.chord[-1])), {"before": segment.a.unstable, "after": b.unstable}
    return unlocated(1.0, disagreement.type, b, width, disagreement.sentence, **counts)


def _next_length(segment: Segment, attempted: Attempt, state: ContinuationState, settings: Settings) -> float:
    prediction, angle = attempted.prediction, control.turn(segment.a, segment.b.tangent)
    effort = attempted.correction.effort
    length = control.next_step(prediction.length, angle, effort, settings)
    return max(length, state.step) if prediction.to_bound else length
