"""Curves in two parameters, begun at special points of branches."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint
from contwalk.continuation import outcomes
from contwalk.continuation.branch_in_progress import Start
from contwalk.continuation.diagram import Diagram
from contwalk.continuation.events import Plan
from contwalk.continuation.opening import Opening
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.errors import StartError
from contwalk.numerics.threads import one_thread
from contwalk.problems.locus.equilibrium_locus import CURVES
from contwalk.problems.locus.starts import locus_at
from contwalk.problems.restoring import pins_of
from contwalk.studies.verbs import direction_signs
from contwalk.system import System

Range = tuple[float, float]


@one_thread()
def continue_locus(
    system: System,
    branch: Branch,
    point: str | SpecialPoint,
    ranges: Mapping[str, Range],
    direction: str = "both",
    **settings: Any,
) -> Branch:
    """The curve in two parameters through a fold or a Hopf point of a branch of equilibria.

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
    chosen = Settings(range=ranges[first], second_range=ranges[second], **settings)
    opening = opened_locus(system, branch.info, special, (first, second), chosen)
    if isinstance(opening, Outcome):
        raise StartError(opening.message)
    origin = f"{branch.name}/{special.name}"
    start = Start(system, first, dict(opening.problem.line.parameters), opening, origin)
    diagram = Diagram([start], Plan(chosen, frozenset(), 0, direction_signs(direction)))
    for _ in diagram.events():
        pass
    return diagram.branches[0]


def opened_locus(
    system: System,
    info: BranchInfo,
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
    if info.problem != "equilibrium":
        raise StartError(
            f"No curve in two parameters can be followed from {point.name}, a special point of orbits.",
            f"Start at a located special point of equilibria: {', '.join(sorted(CURVES))}.",
        )
    for name, (low, high) in zip(free, settings.bounds.values(), strict=True):
        system.require_parameter(name)
        if not low <= point.parameters[name] <= high:
            value = point.parameters[name]
            raise StartError(
                f"{point.name} has {name} = {value:.10g}, outside the range [{low:g}, {high:g}].",
                "Widen the range, or start from another point.",
            )
    known = {name: float(point.parameters[name]) for name in system.parameter_names}
    try:
        problem, z = locus_at(system, point, known, free, pins_of(system, info), discretization)
        state = begin(problem, z, settings)
    except StartError:
        raise
    except outcomes.BREAKDOWNS as error:
        return outcomes.no_start("no_convergence", str(error), "the special point")
    if not isinstance(state, ContinuationState):
        return outcomes.no_start(state.reason, state.sentence, "the special point")
    return Opening(problem, state)
