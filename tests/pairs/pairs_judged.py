"""What a walk tells of two crossings, against what lies there."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass

import numpy as np
from hybrid_runs import diagram
from pairs_form import FREE, Case, Crossing

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint

EPS = float(np.finfo(float).eps)
# What an error is an estimate to, and roundings of the parameter and of its place in the range.
ESTIMATED, ROUNDINGS = 4.0, 32.0
# How the note of an unlocated point names an interval of the parameter.
BETWEEN = re.compile(r"between (\S+) and (\S+?)\.?(?:;|$)")


@dataclass(frozen=True)
class Verdict:
    """Whether both crossings were `located`, some `unlocated` within their interval, or one `lost`.

    Of a near miss: `nothing` is right, `undecided` if told as unlocated. What is told of no crossing is
    `false`, and a walk that ends before the end of its range `stopped`.
    """

    kind: str
    seed: int
    distance: float
    outcome: str
    points: int
    text: str = ""

    def record(self) -> dict[str, object]:
        """As it is stored."""
        return asdict(self)


def judged(case: Case, branch: Branch) -> Verdict:
    """The verdict on a branch."""
    told = [point for point in branch.special_points if point.label != "EP"]
    slack = ROUNDINGS * EPS * (max(map(abs, case.range)) + case.range[1] - case.range[0])
    left = list(case.crossings)
    stray, sure = [], True
    for point in sorted(told, key=lambda p: p.status != "located"):
        place = point.parameters[FREE]
        near = [c for c in left if _names(point, c, slack)]
        if point.status != "located":
            sure = False
        elif near:
            near = [min(near, key=lambda c: abs(c.place - place))]
        # An unlocated one may be of what has been located as well.
        known = any(_names(point, c, slack) for c in case.crossings)
        if not known:
            stray.append(point)
        for crossing in near:
            left.remove(crossing)
    reason = branch.outcome.reason
    lines = [f"{p.label} {p.status} {p.parameters[FREE]!r} +- {p.error}" for p in told]
    return Verdict(
        case.kind,
        case.seed,
        case.distance,
        _outcome(case, stray, left, sure, reason),
        len(branch.points),
        "; ".join([reason, *lines, *(f"true: {c.label} {c.place!r}" for c in case.crossings)]),
    )


def _names(point: SpecialPoint, crossing: Crossing, slack: float) -> bool:
    """Whether a point tells of a crossing: an unlocated one by its interval."""
    slack += crossing.rounding
    if point.status != "located":
        named = BETWEEN.search(point.note or "")
        return named is not None and float(named[1]) - slack <= crossing.place <= float(named[2]) + slack
    apart = abs(crossing.place - point.parameters[FREE])
    return point.label == crossing.label and apart <= ESTIMATED * (point.error or 0.0) + slack


def _outcome(case: Case, stray: list[SpecialPoint], left: list[object], sure: bool, reason: str) -> str:
    if any(point.status == "located" for point in stray):
        return "false"
    if left:
        return "lost" if reason in ("bound", "closed") else "stopped"
    if not case.crossings:
        return "undecided" if stray else ("nothing" if reason in ("bound", "closed") else "stopped")
    return "unlocated" if stray or not sure else "located"


def walked(case: Case) -> Branch:
    """The branch of a case, in both directions of its range."""
    if case.machine is not None:
        given = case.machine | {"accuracy": 1e-8, "max_points": 1000}
        (branch,) = diagram(case.system, FREE, case.range, case.state, {FREE: case.start}, **given)
        return branch
    values = case.system.defaults() | {FREE: case.start}
    if case.period is None:
        problem: cw.Equilibrium | cw.PeriodicOrbit = cw.Equilibrium(case.system, values, FREE)
    else:
        problem = cw.PeriodicOrbit(case.system, values, FREE, discretization=cw.Discretization(accuracy=1e-8))
    return cw.continue_branch(problem, case.state, case.range, period=case.period, **case.options)
