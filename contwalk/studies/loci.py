"""Curves in two parameters, begun at special points of branches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from contwalk.branch import ORBITS, Branch, Outcome, SpecialPoint
from contwalk.continuation import outcomes
from contwalk.continuation.metric import parameter_weight
from contwalk.continuation.newton import correct
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.diagram import Diagram
from contwalk.diagram.events import Plan
from contwalk.diagram.opening import Opening
from contwalk.diagram.reopening import stored_place
from contwalk.errors import StartError, interruptible
from contwalk.numerics.threads import one_thread
from contwalk.problems.locus.persistence import not_persistent
from contwalk.problems.locus.starts import locus_at
from contwalk.problems.problem import Problem
from contwalk.problems.restoring import Facts, pins_of
from contwalk.studies.verbs import direction_signs, marks_of
from contwalk.system import System
from contwalk.system.declarations import nearest

Range = tuple[float, float]


@interruptible()
@one_thread()
def continue_locus(
    system: System,
    branch: Branch,
    point: str | SpecialPoint,
    ranges: Mapping[str, Range],
    direction: str = "both",
    discretization: Any = None,
    marks: Mapping[str, Sequence[float | str]] | None = None,
    **settings: Any,
) -> Branch:
    """The curve in two parameters through a located special point of a branch.

    Of equilibria it is a fold, a Hopf point, a branch point or a marked value; of orbits a fold, a period
    doubling, a Neimark-Sacker point, and of those through events a limit (GR, OC, AZ) as well.

    Parameters
    ----------
    system : System
        The one that the branch was computed with.
    branch : Branch
    point : str or SpecialPoint
        A special point of it, as `HB1`.
    ranges : mapping
        The two parameters with the values at which the curve ends: `{"c": (0.1, 6), "delta": (0, 0.006)}`.
        Errors of special points are those of the first one.
    direction : str
        `both`, or `forward` or `backward` as the first parameter grows.
    discretization : Discretization, optional
        How finely orbits are computed.
    marks : mapping, optional
        `{"c": [1.0], "speed": [0.5, "extremum"]}`: values and extrema of both parameters and of observables.
    **settings
        Further fields of `continuation.settings.Settings`, such as `max_points`.

    Raises
    ------
    StartError
        If no curve begins at that point, or it lies outside the ranges.
    """
    if len(ranges) != 2:
        raise StartError(
            f"A curve needs two parameters, and {len(ranges)} are given.",
            'Give both with their ranges: {"c": (0.1, 6), "delta": (0, 0.006)}.',
        )
    special = branch.special(point) if isinstance(point, str) else point
    first, second = ranges
    chosen = Settings(range=ranges[first], second_range=ranges[second], marks=marks_of(marks), **settings)
    opening = opened_locus(system, branch, special, (first, second), chosen, discretization)
    if isinstance(opening, Outcome):
        raise StartError(opening.message)
    _check_watched(opening.problem, chosen)
    origin = f"{branch.name}/{special.name}"
    start = Start(system, first, dict(opening.problem.line.parameters), opening, origin)
    diagram = Diagram([start], Plan(chosen, frozenset(), 0, direction_signs(direction)))
    for _ in diagram.events():
        pass
    return diagram.branches[0]


def _check_watched(problem: Problem, settings: Settings) -> None:
    """Refuse marks of what is not watched along a curve."""
    watched = [*problem.line.names, *problem.observed.observable_names]
    for name in (*[mark.name for mark in settings.marks], *settings.stop_at):
        if name not in watched:
            raise StartError(
                f"'{name}' is not watched along the curve, so it cannot be marked.",
                f"Known: {', '.join(watched)}. {nearest(name, watched)}".strip(),
            )


def opened_locus(
    system: System,
    branch: Branch,
    point: SpecialPoint,
    free: tuple[str, str],
    settings: Settings,
    discretization: Any = None,
) -> Opening | Outcome:
    """The curve through a stored special point of a branch, or why there is none.

    Raises
    ------
    StartError
        If no curve begins at points of its kind, or it lies outside the ranges.
    """
    if branch.info.problem not in ("equilibrium", *ORBITS):
        raise StartError(
            f"No curve in two parameters can be followed from {point.name}, a special point of such a curve.",
            "Start at a located special point of equilibria or orbits.",
        )
    for name, (low, high) in zip(free, settings.bounds.values(), strict=True):
        system.require_parameter(name)
        value = point.parameters[name]
        # A point at an end of the range is there to its error.
        known_to = (point.error or 0.0) if name in branch.info.free else 0.0
        if not low - known_to <= value <= high + known_to:
            raise StartError(
                f"{point.name} has {name} = {value:.10g}, outside the range [{low:g}, {high:g}].",
                "Widen the range, or start from another point.",
            )
    known = {name: float(point.parameters[name]) for name in system.parameter_names}
    try:
        problem, z = _problem(system, branch, point, known, settings, free, discretization)
        state = begin(problem, z, settings)
    except StartError:
        raise
    except outcomes.BREAKDOWNS as error:
        return not_begun.no_start("no_convergence", str(error), "the special point")
    if not isinstance(state, ContinuationState):
        return not_begun.no_start(state.reason, state.sentence, "the special point")
    if not _persists(problem, state):
        raise StartError(
            f"No curve in two parameters can be followed from {point.name}. "
            f"{not_persistent(problem, state.sample.z)}"
        )
    return Opening(problem, state)


def _typical(free: tuple[str, str], known: Mapping[str, float], settings: Settings) -> dict[str, float]:
    """Typical magnitudes of both parameters, by name."""
    ends = settings.bounds.values()
    return {name: parameter_weight(np.nan, own, known[name]) for name, own in zip(free, ends, strict=True)}


def _problem(
    system: System,
    branch: Branch,
    point: SpecialPoint,
    known: dict[str, float],
    settings: Settings,
    free: tuple[str, str],
    discretization: Any,
) -> tuple[Problem, np.ndarray]:
    """The equations of the curve through a special point, and its unknowns there."""
    info = branch.info
    if info.problem == "equilibrium":
        ranges = dict(zip(free, settings.bounds.values(), strict=True))
        own = system.beginning_in(info.settings.get("mode"))
        return locus_at(own, point, known, free, pins_of(system, info), discretization, ranges)
    from contwalk.problems.locus import orbit_starts  # orbits need compiled flows

    place = stored_place(branch, point)
    state = place.z[: len(info.states)]
    facts = Facts(system, info, known, None, pins_of(system, info), state, discretization)
    return orbit_starts.locus_at(facts, point, place.weights, _typical(free, known, settings))


def _persists(problem: Any, state: ContinuationState) -> bool:
    """Whether what a curve is of is there on both sides of its start as well."""
    sample = state.sample
    for side in (state.step, -state.step):
        guess = sample.z + side * sample.tangent
        try:
            beside = correct(problem, guess, sample.tangent / sample.weights**2, sample.weights)
        except outcomes.BREAKDOWNS:
            return True  # the walk tells
        if not beside.ok or not problem.diagnosis.unfolded(beside.z):
            return True  # where it is not known, the walk tells
    return False
