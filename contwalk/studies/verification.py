"""A special point computed once more, on another path to it, and how the two agree.

Orbits: the point is left a little along the branch and solved for again with another integrator, on steps
of a tolerance far below the stored error. Equilibria: the defining system is solved from another start and
refined with residuals of 40 digits. Beside that, where an eigenvalue or multiplier crosses, its distance
from the border, which no defining system has a part in, is turned into a distance of the parameter.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from contwalk import quantities
from contwalk.branch import ORBITS, Branch, SpecialPoint
from contwalk.continuation import outcomes
from contwalk.continuation.marks import observer_of
from contwalk.continuation.newton import correct
from contwalk.diagram.reopening import reopened, stored_place
from contwalk.errors import ContwalkError
from contwalk.labels import END, LOCUS, MARK
from contwalk.numerics.linear import parameter_held
from contwalk.problems.orbit.discretization import TIGHTEST, Discretization
from contwalk.problems.problem import (
    Linearization,
    Located,
    Problem,
    Sample,
    Test,
    at_stored,
    refined,
)
from contwalk.problems.restoring import problem_of
from contwalk.studies.comparison import (
    ELSEWHERE,
    LOST,
    SKIPPED,
    Comparison,
    at_value,
    critical,
    defining,
    judged,
)
from contwalk.system import System

# How far the search begins beside the stored point, in the metric of the branch; nearer than this part of the
# way to the next point of its kind, which it would find instead, down to where corrections are rounding.
ASIDE, NEXT, NEAREST = 1e-4, 0.05, 1e-9
# Between one half and one: which part of a straight line's way an observable that touches a value has gone.
HALF = 0.75
# The second computation aims at this part of the stored error, and where no integrator reaches that, at so
# many times more.
TIGHTER, RELAXED = 0.1, 30.0


def other_methods(
    system: System,
    branch: Branch,
    point: SpecialPoint,
    steps: Discretization,
    marks: Mapping[str, Sequence[float | str]],
) -> tuple[str, ...]:
    """Integrators that a stored orbit was not computed with, the one that suits it best first.

    Parameters
    ----------
    steps : Discretization
        The run's own. The point is located with them as the run did, to see what `auto` takes.
    """
    problem, sample = reopened(system, branch, point, steps)
    finest = _finest(problem, sample, branch, point, marks)
    used = {there.mesh.method for there in (problem, finest)}  # type: ignore[attr-defined]
    first = ("radau9", "dop853") if "verner98" in used else ("verner98", "radau9")
    stiff = ("verner98", "dop853")
    return tuple(m for m in (stiff if used & {"radau5", "radau9"} else first) if m not in used)


def compared(
    system: System,
    branch: Branch,
    point: SpecialPoint,
    steps: Discretization,
    method: str = "",
    marks: Mapping[str, Sequence[float | str]] | None = None,
) -> Comparison:
    """Recompute one special point.

    Parameters
    ----------
    system : System
    branch : Branch
    point : SpecialPoint
    steps : Discretization
        What the run asked of its orbits, its relative accuracy first.
    method : str
        The integrator for orbits; the first of `other_methods` that finds the point by default.
    marks : mapping, optional
        The run's marked values, by name: what marked points (UZ) of observables stand for.
    """
    free = branch.info.free[0]
    stored = float(point.unknowns[-1]) if point.unknowns else float("nan")
    error = float("nan") if point.error is None else float(point.error)
    begun = Comparison(branch.name, point.name, free, stored, stored_error=error)
    why = _not_for_us(branch, point)
    if why:
        return replace(begun, reason=why, verdict=ELSEWHERE if _of_parent(branch, point) else SKIPPED)
    orbit, accuracy = _of_orbits(branch), steps.accuracy
    marked = marks or {}
    begun = replace(begun, method=method or "40 digits")
    if not orbit and _at_given_value(branch, point):
        begun = replace(begun, method="another start")
    try:
        if orbit:
            methods = (method,) if method else other_methods(system, branch, point, steps, marked)
            attempts = [(aim, name) for aim in _aims(point, accuracy) for name in methods]
        else:
            attempts = [(next(_aims(point, accuracy)), begun.method)]
    except outcomes.BREAKDOWNS as failure:
        return replace(begun, verdict=LOST, reason=str(failure))
    lost = None
    for aim, name in attempts:
        result = _attempted(replace(begun, method=name), system, branch, point, accuracy, aim, marked)
        if result.verdict != LOST:
            return result
        lost = lost or result
    return lost or replace(begun, verdict=LOST, reason="there is no other integrator")


def _attempted(
    begun: Comparison,
    system: System,
    branch: Branch,
    point: SpecialPoint,
    accuracy: float,
    aim: float,
    marks: Mapping[str, Sequence[float | str]],
) -> Comparison:
    """The point recomputed by one integrator with one aim; `LOST` where that does not come back to it."""
    try:
        problem, sample = _beside(system, branch, point, Discretization(accuracy=aim, method=begun.method))
        if _at_given_value(branch, point):
            return at_value(begun, branch, problem, sample, point, accuracy)
        found = _found(problem, sample, branch, point, marks)
    except outcomes.BREAKDOWNS as failure:
        return replace(begun, verdict=LOST, reason=str(failure))
    if found is None:
        return replace(begun, verdict=LOST, reason="the search from beside it does not come back to it")
    return judged(begun, branch, problem, sample, point, found, accuracy)


def _not_for_us(branch: Branch, point: SpecialPoint) -> str:
    """Why a point is not recomputed; empty if it is."""
    if point.status != "located":
        return "it was not located in the first place"
    if _of_parent(branch, point):
        return "the branch ends on another one there, whose own point is recomputed"
    return ""


def _of_orbits(branch: Branch) -> bool:
    """Whether a branch is one of orbits, or a curve in two parameters of them."""
    return branch.info.settings.get("of_problem", branch.info.problem) in ORBITS


def _at_given_value(branch: Branch, point: SpecialPoint) -> bool:
    """Whether a point is where the one free parameter has a value: then the solution there is compared."""
    return point.label == MARK and point.kind == "parameter" and branch.info.problem != LOCUS


def _of_parent(branch: Branch, point: SpecialPoint) -> bool:
    """Whether a point is one of the parent, which the branch has become."""
    ends = (end for end in branch.special_points if end.label == END and end.kind == "rejoined")
    return point.label not in (END, MARK) and any(end.s == point.s for end in ends)


# -- the second computation --------------------------------------------------------------------------------


def _aims(point: SpecialPoint, accuracy: float) -> Iterator[float]:
    """Relative accuracies to aim at, from far below the stored error up to what the run asked for.

    An integrator may not reach the first ones: where deviations grow, or the field has rounding errors of its
    own, its error estimate does not fall below those, whatever the steps. How well the point is known then,
    the error of the second computation tells.
    """
    value = abs(float(point.unknowns[-1]))
    relative = accuracy
    if point.error is not None and value > 0.0:
        relative = min(abs(point.error) / value, accuracy)
    aim = max(TIGHTER * relative, TIGHTEST)
    while aim < accuracy:
        yield aim
        aim *= RELAXED
    yield max(accuracy, TIGHTEST)


def _beside(
    system: System, branch: Branch, point: SpecialPoint, steps: Discretization
) -> tuple[Problem, Sample]:
    """The problem on steps of another integrator, and a solution a little along the branch."""
    place, aside = stored_place(branch, point), _aside(branch, point)
    z, tangent, weights = place.z, place.tangent, place.weights
    problem: Problem = problem_of(system, branch.info, z[: len(branch.info.states)], steps)
    problem = at_stored(problem, z, weights)
    if _at_given_value(branch, point):
        normal = parameter_held(weights)
        shift = aside * weights * np.cos(np.arange(1.0, len(z) + 1.0))
        guess = np.append((z + shift)[:-1], z[-1])
        problem = refined(problem, z, weights)
    else:
        normal, guess = tangent / weights**2, z + aside * tangent
    found = correct(problem, guess, normal, weights, iterations=20)
    if not found.ok or found.linearization is None:
        raise ContwalkError(f"There is no solution beside the point: {found.sentence}")
    problem = found.problem
    return problem, problem.examine(found.z, tangent, weights, found.linearization, place.unstable)


def _aside(branch: Branch, point: SpecialPoint) -> float:
    """How far from a point to begin: others of its kind are farther away."""
    others = [abs(each.s - point.s) for each in branch.special_points if each.label == point.label]
    apart = min((distance for distance in others if distance > 0.0), default=np.inf)
    return float(np.clip(NEXT * apart, NEAREST, ASIDE))


def _finest(
    problem: Problem,
    sample: Sample,
    branch: Branch,
    point: SpecialPoint,
    marks: Mapping[str, Sequence[float | str]],
) -> Problem:
    """The finest steps on which a point was located."""
    if _at_given_value(branch, point):
        return refined(problem, sample.z, sample.weights)
    found = _found(problem, sample, branch, point, marks)
    return problem if found is None or found.problem is None else found.problem


def _found(
    problem: Problem,
    sample: Sample,
    branch: Branch,
    point: SpecialPoint,
    marks: Mapping[str, Sequence[float | str]],
) -> Located | None:
    """The special point near a sample."""
    if point.label == MARK:
        name, level = _mark(problem, branch, point, sample, marks)
        if level is None or _touches(problem, sample, point, name, level):
            return _extremum(problem, sample, name)
        located = problem.observed.locate_mark(name, level, sample)
    else:
        kind = defining(problem, point, sample)
        if problem.limited is not None and kind.test is Test.MARGIN:
            which = problem.limited.limit_of(point)
        else:
            which = critical(kind, point, sample)
        located = kind.locate(problem, sample, which)
    return None if located is None else located.settled()


def _touches(problem: Problem, sample: Sample, point: SpecialPoint, name: str, level: float) -> bool:
    """Whether an observable only touches its value at a point: its equations there have a double root.

    Its rate grows from zero then, and from the point to a sample beside it the observable moves by half of
    what its rate at the sample would make of the way.
    """
    apart = float(sample.tangent / sample.weights**2 @ (sample.z - np.array(point.unknowns)))
    moved = observer_of(problem).value(name, sample) - level
    whole = problem.observed.rate(name, sample) * apart
    return whole != 0.0 and moved / whole < HALF


def _mark(
    problem: Problem,
    branch: Branch,
    point: SpecialPoint,
    sample: Sample,
    marks: Mapping[str, Sequence[float | str]],
) -> tuple[str, float | None]:
    """Name and value of the observable that is marked at a point; no value for an extremum."""
    if point.mark:
        return str(point.mark["name"]), point.mark["value"]
    observables, row = branch.info.observables, branch.points["observables"][point.index]
    stored = dict(zip(observables, row, strict=True))
    known = (*observables, quantities.PERIOD) if branch.info.problem in ORBITS else observables
    stored |= {name: float(branch[name][point.index]) for name in marks if quantities.known(name, known)}
    if point.kind == "extremum":
        names = [name for name, values in marks.items() if "extremum" in values and name in stored]
        rates = {
            name: abs(problem.observed.rate(name, sample)) / max(abs(stored[name]), 1e-300) for name in names
        }
        if rates:
            return min(rates, key=lambda name: rates[name]), None
    levels = [
        (
            abs(stored[name] - float(value)) / max(abs(stored[name]), abs(float(value)), 1e-300),
            name,
            float(value),
        )
        for name, values in marks.items()
        for value in values
        if name in stored and value != "extremum"
    ]
    if not levels or point.kind == "extremum":
        raise ContwalkError("The run file in the database does not tell what is marked here.")
    _, name, value = min(levels)
    return name, value


def _extremum(problem: Problem, sample: Sample, name: str) -> Located | None:
    """The point at which the rate of an observable is zero, by the secant method along the branch."""

    def at(position: float) -> tuple[Sample, float]:
        guess = sample.z + position * sample.tangent
        found = correct(problem, guess, sample.tangent / sample.weights**2, sample.weights)
        if not found.ok or found.linearization is None:
            raise ContwalkError(f"There is no solution beside the point: {found.sentence}")
        tangent = _tangent(found.linearization, sample)
        there = found.problem.examine(found.z, tangent, sample.weights, found.linearization, sample.unstable)
        return there, found.problem.observed.rate(name, there)

    low, high = -3.0 * ASIDE, ASIDE
    v0, v1 = at(low)[1], at(high)[1]
    there, moved = sample, high - low
    for _ in range(6):
        if v0 == v1:
            break
        new = high - v1 * (high - low) / (v1 - v0)
        low, v0, moved = high, v1, new - high
        high = new
        there, v1 = at(new)
        if abs(moved) < 1e-9:
            break
    if not abs(moved) < ASIDE:
        return None
    return Located(there.z, abs(moved * sample.tangent[-1]) + float(np.spacing(abs(there.z[-1]))))


def _tangent(linearization: Linearization, near: Sample) -> np.ndarray:
    """Unit tangent at a solution, facing like that of a sample beside it."""
    tangent = linearization.tangent(near.tangent / near.weights**2, near.weights)
    return tangent / np.linalg.norm(tangent / near.weights)
