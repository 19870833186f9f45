"""The walk along a branch: predict, correct, detect, adapt, yield."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation import outcomes
from contwalk.continuation.detection import Disagreement, Found, bifurcations
from contwalk.continuation.marks import Observer, marked
from contwalk.continuation.metric import updated
from contwalk.continuation.newton import Correction, correct
from contwalk.continuation.segment import LostBranch, Segment
from contwalk.continuation.settings import Mark, Settings
from contwalk.errors import PluginError
from contwalk.problems.linear import Factored, kernel_direction
from contwalk.problems.problem import Located, Problem, Sample

_GROWTH = 1.6
_SHRINK = 0.4
# No step moves the parameter by more than this share of its range: curves of observables look smooth.
PARAMETER_SHARE = 1.0 / 64.0


@dataclass(frozen=True)
class Here:
    """Where a walk stands: what is needed to go on from a point, and nothing else."""

    sample: Sample
    s: float
    step: float


@dataclass(frozen=True)
class Point:
    """A solution found by a walk. `special` is its record where it is a special point."""

    here: Here
    special: SpecialPoint | None = None


@dataclass(frozen=True)
class End:
    """The end of a walk."""

    outcome: Outcome
    special: SpecialPoint


def begin(
    problem: Problem,
    z: np.ndarray,
    settings: Settings,
    toward: np.ndarray | None = None,
    reach: np.ndarray | None = None,
) -> Here | Correction:
    """The first solution of a branch near z, with the tangent towards growing parameter (or along `toward`).

    With `toward`, z is taken as a solution already (a branch point) and `toward` as the tangent there; `reach` then
    stands in for magnitudes that z does not tell.
    Returns the failed `Correction` where there is no solution.
    """
    value = float(z[-1])
    normal = np.zeros(len(z))
    normal[-1] = 1.0
    if toward is None:
        size = np.maximum(np.abs(z), 1.0)
        correction = correct(problem, z, normal, size, iterations=60, damped=True)
        if not correction.ok:
            return correction
        z = np.append(correction.z[:-1], value)
    linearization = problem.linearize(z)
    magnitudes = problem.magnitudes(z, linearization)
    if reach is not None:
        magnitudes = np.where(np.isfinite(magnitudes) | ~(reach > 0.0), magnitudes, reach)
    weights = updated(None, magnitudes, settings, z)
    tangent = toward if toward is not None else first_tangent(linearization.jacobian, weights)
    sample = problem.examine(z, tangent, weights, linearization, None)
    if toward is not None:
        sample = replace(sample, orientation=0.0)  # not defined at a branch point
    return Here(sample, 0.0, settings.step)


def first_tangent(jacobian: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Unit tangent at a start, towards growing parameter where the parameter moves at all."""
    tangent = kernel_direction(jacobian, weights)
    lead = tangent[-1] / weights[-1]
    if abs(lead) < 1e-12:
        lead = (tangent / weights)[int(np.argmax(np.abs(tangent / weights)))]
    return tangent * np.sign(lead)


def turned(here: Here) -> Here:
    """The same place, facing the other way."""
    sample = here.sample
    back = replace(
        sample, tangent=-sample.tangent, orientation=-sample.orientation, rates=-sample.rates
    )
    return replace(here, sample=back)


def walk(
    problem: Problem, here: Here, settings: Settings, observer: Observer, sign: float, points: int
) -> Iterator[Point | End]:
    """Solutions along a branch from `here`, special points in their places, and how it ended.

    Parameters
    ----------
    here : Here
        A solution, its tangent pointing the way to go. It is not yielded itself.
    sign : float
        +1 where arclength grows along the walk, -1 where it decreases (the other direction from a start).
    points : int
        How many points there may still be.
    """
    origin, walked = here, 0
    while True:
        if walked >= points:
            yield _end(problem, here, outcomes.max_points(settings.max_points))
            return
        if _outward(here.sample, settings):
            yield _end(problem, here, outcomes.bound(observer.parameter, here.sample.parameter))
            return
        clock, evaluations = time.perf_counter(), _evaluations(problem)
        advance = _advance(problem, here, settings, observer)
        if isinstance(advance, Outcome):
            yield _end(problem, here, advance)
            return
        stop = _stop(advance, settings, observer)
        for found in advance.found:
            place = Here(found.sample, here.s + sign * found.theta * advance.segment.length, here.step)
            yield Point(place, _record(problem, found, place.s, sign))
            walked += 1
            if found is stop:
                yield _end(problem, place, outcomes.stop_at(_what(found, settings, observer)))
                return
        sample = updated_weights(problem, advance.there, here, settings)
        sample = replace(
            sample,
            seconds=time.perf_counter() - clock,
            evaluations=_evaluations(problem) - evaluations,
        )
        closed = advance.closed(origin, walked)
        here = Here(sample, here.s + sign * advance.segment.length, advance.next_step)
        yield Point(here)
        walked += 1
        if closed:
            yield _end(problem, here, outcomes.closed())
            return


def _outward(sample: Sample, settings: Settings) -> bool:
    """Whether a walk stands at an end of the range, facing out of it."""
    low, high = settings.range
    ahead = sample.tangent[-1]
    return bool((sample.parameter >= high and ahead > 0) or (sample.parameter <= low and ahead < 0))


def updated_weights(problem: Problem, sample: Sample, here: Here, settings: Settings) -> Sample:
    """A new sample in the metric that its own size adds to."""
    magnitudes = problem.magnitudes(sample.z, problem.linearize(sample.z))
    weights = updated(here.sample.weights, magnitudes, settings, sample.z)
    factor = float(np.linalg.norm(sample.tangent / weights))
    return replace(sample, weights=weights, tangent=sample.tangent / factor, rates=sample.rates / factor)


# -- one step --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Advance:
    """One accepted step."""

    segment: Segment
    there: Sample
    found: list[Found]
    next_step: float

    def closed(self, origin: Here, walked: int) -> bool:
        """Whether the step passed the walk's own beginning again."""
        if walked < 3:
            return False
        theta = self.segment.position(origin.sample.z)
        if not 0.0 < theta <= 1.0:
            return False
        tangents = origin.sample.tangent / origin.sample.weights**2 @ self.there.tangent
        try:
            return tangents > 0.0 and self.segment.distance(origin.sample.z, theta) < 1e-5
        except LostBranch:
            return False


def _advance(problem: Problem, here: Here, settings: Settings, observer: Observer) -> Advance | Outcome:
    """The longest step from here that converges, turns little, and on which the tests agree."""
    step = min(here.step, settings.max_step)
    last: Correction | None = None
    while True:
        smallest = step <= settings.min_step
        step = max(step, settings.min_step)
        guess, normal, length, to_bound = _predict(here, step, settings)
        last = correct(problem, guess, normal, here.sample.weights, settings.newton_iterations)
        sentence = last.sentence
        if last.ok and last.linearization is not None:
            try:
                return _examined(problem, here, last, length, to_bound, settings, observer, smallest)
            except (Disagreement, LostBranch) as error:
                sentence = str(error)
            except PluginError as error:
                last, sentence = replace(last, reason="plugin_error"), error.sentence
        if smallest:
            return outcomes.stuck(last.reason, sentence, step, observer.parameter, here.sample.parameter)
        step *= _SHRINK if step > 1e-6 else 0.1


def _predict(
    here: Here, step: float, settings: Settings
) -> tuple[np.ndarray, np.ndarray, float, bool]:
    """Guess, normal of the corrector's hyperplane, predicted length, and whether the step ends at a bound."""
    sample = here.sample
    step = min(step, _longest(sample, settings))
    guess = sample.z + step * sample.tangent
    low, high = settings.range
    bound = high if sample.tangent[-1] > 0 else low
    overshoot = (guess[-1] - bound) * np.sign(sample.tangent[-1])
    if np.isfinite(bound) and sample.tangent[-1] != 0.0 and overshoot >= -1e-3 * step * abs(sample.tangent[-1]):
        # Straight to the bound: the corrector holds the parameter there.
        length = (bound - sample.z[-1]) / sample.tangent[-1]
        guess = sample.z + length * sample.tangent
        guess[-1] = bound
        normal = np.zeros(len(guess))
        normal[-1] = 1.0 / sample.weights[-1]
        return guess, normal, length, True
    return guess, sample.tangent / sample.weights**2, step, False


def _longest(sample: Sample, settings: Settings) -> float:
    """The step that moves the parameter by the largest share of its range."""
    moved = abs(sample.tangent[-1])
    return PARAMETER_SHARE * settings.width / moved if moved > 0.0 else np.inf


def _examined(
    problem: Problem,
    here: Here,
    correction: Correction,
    length: float,
    to_bound: bool,
    settings: Settings,
    observer: Observer,
    smallest: bool,
) -> Advance:
    """The corrected point with all that is special on the way to it; `Disagreement` if the step is too long."""
    a, linearization = here.sample, correction.linearization
    assert linearization is not None
    z = correction.z
    if to_bound:
        z = np.append(z[:-1], settings.range[1] if a.tangent[-1] > 0 else settings.range[0])
    right = np.zeros(len(z))
    right[-1] = 1.0
    try:
        bordered = np.vstack([linearization.jacobian, a.tangent / a.weights**2])
        tangent = Factored(bordered, a.weights).solve(right)
    except np.linalg.LinAlgError:
        raise Disagreement("BP", "The tangent is not determined.") from None
    if np.array_equal(z, a.z):
        raise LostBranch("The step is too short to be told from none in double precision.")
    angle = _angle(a, tangent)
    moved = float(np.linalg.norm((z - a.z - length * a.tangent) / a.weights))
    if not smallest and (angle > settings.max_angle or moved > 0.5 * length):
        raise Disagreement("LP", f"The branch turns by {angle:.0f} degrees in one step.")
    if not smallest and _bend(a, z, tangent) > max(0.25 * np.radians(angle), 0.02):
        raise Disagreement("BP", "The step does not lie along the branch: it may have left it for another one.")
    beyond = not settings.range[0] <= z[-1] <= settings.range[1]
    if beyond:
        raise Disagreement("EP", "The step passes the end of the range.")
    there = problem.examine(z, tangent, a.weights, linearization, a.unstable)
    there = replace(there, iterations=correction.iterations)
    segment = Segment(problem, a, there)
    if a.orientation == 0.0:
        segment = Segment(problem, _beside(segment), there)
    try:
        found = bifurcations(segment)
    except Disagreement as disagreement:
        if not smallest:
            raise
        found = [_unlocated(segment, disagreement)]
    stops = tuple(Mark(name, values) for name, values in settings.stop_at.items())
    turns = [f.theta for f in found if f.label in ("LP", "BP")]
    found += marked(segment, (*settings.marks, *stops), observer, turns)
    found = sorted(found, key=lambda f: f.theta)
    step = _next_step(length, angle, correction.iterations, settings)
    return Advance(segment, there, found, max(step, here.step) if to_bound else step)


# How far from a branch point its side is looked at, in parts of the first step.
BESIDE = 1e-4


def _beside(segment: Segment) -> Sample:
    """The branch point that a walk begins at, with orientation and stability as they are right beside it."""
    near = segment.at(BESIDE)
    return replace(
        segment.a,
        orientation=near.orientation,
        measures=near.measures,
        rates=near.rates,
        errors=near.errors,
        eigenvalues=near.eigenvalues,
        unstable=near.unstable,
    )


def _angle(a: Sample, tangent: np.ndarray) -> float:
    """Turn of the tangent, degrees, in the metric of `a`."""
    u, v = a.tangent / a.weights, tangent / a.weights
    cosine = float(u @ v / np.linalg.norm(u) / np.linalg.norm(v))
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _bend(a: Sample, z: np.ndarray, tangent: np.ndarray) -> float:
    """How far the chord's direction is from the mean of the tangents at its ends.

    On a smooth arc it is an eighth of the square of the turn. A step onto another branch that happens to point the
    same way keeps the tangents alike, but not the chord.
    """
    chord = (z - a.z) / a.weights
    u, v = a.tangent / a.weights, tangent / a.weights
    mean = 0.5 * (u / np.linalg.norm(u) + v / np.linalg.norm(v))
    return float(np.linalg.norm(chord / np.linalg.norm(chord) - mean))


def _next_step(length: float, angle: float, iterations: int, settings: Settings) -> float:
    """Step length from curvature (half the largest angle is aimed at) and from the corrector's effort."""
    by_angle = 0.5 * settings.max_angle / max(angle, 1e-3)
    by_effort = {0: 2.0, 1: 2.0, 2: 1.5, 3: 1.2}.get(iterations, 0.7)
    return float(np.clip(length * np.clip(min(by_angle, by_effort), 0.3, _GROWTH), settings.min_step, settings.max_step))


def _unlocated(segment: Segment, disagreement: Disagreement) -> Found:
    """What is detected and cannot be located is kept, between the samples that show it."""
    b = segment.b
    width = abs(float(segment.chord[-1]))
    located = Located(b.z, width, {"note": disagreement.sentence}, refined=False)
    return Found(1.0, disagreement.label, located, b, segment.a.unstable, b.unstable, kind="unlocated")


def _stop(advance: Advance, settings: Settings, observer: Observer) -> Found | None:
    """The first point of the step at which a `stop_at` value is met."""
    for found in advance.found:
        if found.label == "UZ" and _what(found, settings, observer):
            return found
    return None


def _what(found: Found, settings: Settings, observer: Observer) -> str:
    """The `stop_at` value that a marked point has, in words; empty if none."""
    for name, values in settings.stop_at.items():
        here = observer.value(name, found.sample)
        for value in values:
            if abs(here - value) <= 1e-9 * max(abs(value), abs(here)) + 1e-12:
                return f"{name} = {value:.10g}"
    return ""


# -- records ---------------------------------------------------------------------------------------------


def _record(problem: Problem, found: Found, s: float, sign: float) -> SpecialPoint:
    """The record of a found point; counts are in the order of growing arclength."""
    before, after = (found.before, found.after) if sign > 0 else (found.after, found.before)
    if found.kind == "unlocated":
        record = problem.special_point("UZ", found.located, found.sample, s)
        note = str(found.located.vectors["note"])
        record = replace(record, label=found.label, status="unlocated", note=note)
    else:
        record = problem.special_point(found.label, found.located, found.sample, s)
        if found.kind is not None:
            record = replace(record, kind=found.kind)
    return replace(record, unstable_before=before, unstable_after=after)


def _end(problem: Problem, here: Here, outcome: Outcome) -> End:
    """The end of a walk with the record of its end point, which keeps the outcome's sentence."""
    error = 0.0 if outcome.reason == "bound" else float(np.spacing(abs(here.sample.parameter)))
    record = problem.special_point("EP", Located(here.sample.z, error), here.sample, here.s)
    count = here.sample.unstable
    return End(
        outcome,
        replace(
            record, kind=outcome.reason, unstable_before=count, unstable_after=count, note=outcome.message
        ),
    )


def _evaluations(problem: Problem) -> int:
    return int(getattr(problem, "evaluations", 0))
