"""The branches that leave the special points of a branch, as starts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, repeat

import numpy as np

from contwalk.branch import Outcome, SpecialPoint
from contwalk.continuation import control, outcomes
from contwalk.continuation.correction import Correction
from contwalk.continuation.kinds import kind_of
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin
from contwalk.diagram import not_begun
from contwalk.diagram.branch_in_progress import Start
from contwalk.diagram.events import Plan
from contwalk.diagram.opening import Opening
from contwalk.labels import END, MARK, OF_LOCI
from contwalk.problems.problem import LimitType, PointType, Problem, Seed
from contwalk.problems.unbegun import born_of

# Points of two branches are one where the parameter is the same within so many times their errors, and this
# part of itself: special points that are not the same lie farther apart.
ONE_PLACE, TINY = 100.0, 1e-9
# Frequencies of Hopf points are one to this part of them.
ALIKE = 1e-7


def grown(
    plan: Plan, start: Start, problem: Problem, name: str, special_points: Sequence[SpecialPoint]
) -> Iterator[Start]:
    """Starts for the branches that leave the special points of the branch of a start, which has this name."""
    number = 0
    # Where orbits become those of a branch of less, that may be the one they come from, or one that nobody
    # has followed: a start like others, which is known or not.
    returned = {p.index for p in special_points if p.label == END and p.kind == "rejoined"}
    several: list[SpecialPoint] = []
    for point, kind in leading(plan, start, problem, special_points):
        deeper = not kind.goes_on(point)
        if deeper and start.depth >= plan.depth:
            continue
        if any(_at_once(point, other) for other in several):
            continue  # pairs that a symmetry makes one: the cycles of all of them have left the first
        less = () if point.index not in returned or _left(start, point) else _parent(plan, problem, point)
        below = _openings(plan, problem, kind, point)
        for opening, daughter in chain(zip(below, repeat(True)), zip(less, repeat(False))):
            yield replace(
                start,
                opening=opening,
                origin=f"{name}/{point.name}",
                parent=(name, point.s) if daughter else None,
                depth=start.depth + deeper,
                generation=start.generation + (deeper and not isinstance(kind, LimitType)),
                leaves=kind if daughter else None,
                orbit=start.orbit or problem.meshed is not None or kind.births,
                number=(*start.number, number) if start.number else (),
                above=(*start.above, tuple(special_points)),
                would_be=born_of(problem, point.label) if isinstance(opening, Outcome) else {},
            )
            number += 1
        if "multiplicity" in point.coefficients:
            several.append(point)


def _at_once(point: SpecialPoint, other: SpecialPoint) -> bool:
    """Whether two Hopf points of a branch are one, with one frequency."""
    one, another = (float(p.coefficients.get("omega", np.nan)) for p in (point, other))
    same = np.allclose(point.unknowns, other.unknowns, rtol=TINY, atol=TINY)
    return same and abs(one - another) <= ALIKE * abs(one)


def leading(
    plan: Plan, start: Start, problem: Problem, special_points: Sequence[SpecialPoint]
) -> Iterator[tuple[SpecialPoint, PointType]]:
    """The points of a branch at which others leave that a plan follows, each with its kind."""
    for point in special_points:
        kind = kind_of(problem, point)
        if kind is None or not _followed(plan, kind, point) or point.status != "located":
            continue
        if start.parent is not None and abs(point.s) < 1e-9:
            continue  # the point that this branch itself was born at
        yield point, kind


def _left(start: Start, point: SpecialPoint) -> bool:
    """Whether a branch on the way to this one has a point of its own where this one ends: it has returned."""
    place, error = point.unknowns[-1], point.error or 0.0
    known = (p for points in start.above for p in points if p.label not in (END, MARK))
    return any(
        abs(p.unknowns[-1] - place) <= ONE_PLACE * ((p.error or 0.0) + error) + TINY * abs(place)
        for p in known
        if p.status == "located"
    )


def _followed(plan: Plan, kind: PointType, point: SpecialPoint) -> bool:
    """Whether the branches that leave a point are wanted.

    A kind may tell its points by other labels: a crossing of two curves is the point that it is on both.
    """
    if kind.goes_on(point):
        return True
    if isinstance(kind, LimitType) and not kind.declared and kind.label not in OF_LOCI:
        return plan.settings.events.get(kind.label) == "switch"
    return kind.label in plan.follow or point.label in plan.follow


def _openings(
    plan: Plan, problem: Problem, kind: PointType, point: SpecialPoint
) -> Iterator[Opening | Outcome]:
    """The branches that leave a point; of one that cannot be begun, why."""
    try:
        for seed in kind.seeds(problem, point):
            state = _begun(seed, plan.settings)
            if isinstance(state, ContinuationState):
                yield Opening(seed.problem, _counted(state, seed, point), one_sided=seed.one_sided)
            else:
                yield not_begun.no_start(state.reason, state.sentence)
    except outcomes.BREAKDOWNS as error:
        yield not_begun.broken_by(error, f"The branch that leaves {point.name} cannot be begun")


def _parent(plan: Plan, problem: Problem, point: SpecialPoint) -> Iterator[Opening | Outcome]:
    """The branch that one has returned to at a point."""
    try:
        found = plan.parent(problem, point, plan.settings)
    except outcomes.BREAKDOWNS as error:
        found = not_begun.broken_by(
            error, f"The branch that has been returned to at {point.name} cannot be begun"
        )
    if found is not None:
        yield found


def _begun(seed: Seed, settings: Settings) -> ContinuationState | Correction:
    """The first solution of a branch, inside the range if that of either side of its point is."""
    first = begin(seed.problem, seed.z, settings, seed.tangent, seed.reach)
    if seed.other_side is None or _inside(first, settings):
        return first
    other = begin(seed.problem, seed.other_side, settings, seed.tangent, seed.reach)
    return other if _inside(other, settings) else first


def _counted(state: ContinuationState, seed: Seed, point: SpecialPoint) -> ContinuationState:
    """The first solution of a branch of orbits, counted as those beside it by its point's criticality.

    At the point itself its multiplier is one. Beside it, where a cycle explodes, it may differ from one by
    less than it is known to.
    """
    # Doublings and pitchforks have a criticality, which one multiplier passes, and Hopf points, which a pair.
    before, after = point.unstable_before, point.unstable_after
    if seed.problem.meshed is None or seed.tangent is None or point.criticality is None:
        return state
    if before is None or after is None or abs(after - before) not in (1, 2):
        return state
    least = min(before, after)
    count = least + (point.criticality == "subcritical")
    return replace(state, sample=state.sample.counted(count))


def _inside(state: ContinuationState | Correction, settings: Settings) -> bool:
    return isinstance(state, ContinuationState) and control.inside(state.sample.z, settings.bounds)
