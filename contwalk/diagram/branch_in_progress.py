"""A branch in the making: what is known of it so far, new or taken over from a database."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint, along, named, narrowed
from contwalk.continuation.allowance import Allowance, Bound
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState
from contwalk.diagram.opening import Opening
from contwalk.diagram.rows import from_row
from contwalk.errors import DatabaseError
from contwalk.labels import END
from contwalk.problems.problem import MAX_ABS, MAX_RE, LimitType, PointType, Problem
from contwalk.system import System

# Reason codes of ends that are complete, and of those that failed.
_COMPLETE = ("bound", "closed", "shrunk", "rejoined", "unbounded")
_FAILED = ("step_too_small", "no_convergence", "not_finite", "plugin_error")


@dataclass(frozen=True)
class Start:
    """One entry of the queue.

    `opening` is an `Outcome` where the start failed; `generation`: as `depth`, but that what goes on beyond a
    limit, as the same family of another itinerary, is of the generation that came to it; `orbit`: of an
    orbit; `leaves`: the kind of special point that it leaves; `number`: which start of a run it is, counted
    from 0, then which of those that grow out of that one's branch, and so on, where others can make it from
    that; `above`: of each branch on the way to it, the first one's first, its special points; `would_be`: of
    a start that failed, what is true of its branch beside what all failed ones have.
    """

    system: System
    free: str
    parameters: dict[str, float]
    opening: Opening | Outcome
    origin: str
    parent: tuple[str, float] | None = None
    depth: int = 0
    generation: int = 0
    orbit: bool = False
    leaves: PointType | None = None
    number: tuple[int, ...] = ()
    above: tuple[tuple[SpecialPoint, ...], ...] = ()
    would_be: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Stored:
    """What a database holds of a branch: rows, shape (k,), and special points in the order of appending.

    `observables` are the names of what its rows have; None where they are known to be today's.
    """

    rows: np.ndarray
    special_points: list[SpecialPoint]
    outcome: Outcome | None
    observables: tuple[str, ...] | None = None


@dataclass
class BranchInProgress:
    """A branch in the making, its rows of shape (1,) each; `broken` where an error has ended it."""

    info: BranchInfo
    rows: list[np.ndarray] = field(default_factory=list)
    special_points: list[SpecialPoint] = field(default_factory=list)
    outcomes: list[tuple[float, Outcome]] = field(default_factory=list)
    noted: set[str] = field(default_factory=set)
    broken: bool = False

    def branch(self, outcome: Outcome) -> Branch:
        """The branch as it stands, ended like this."""
        rows = np.concatenate(self.rows) if self.rows else np.zeros(0, dtype=self.info.point_dtype())
        info, points = narrowed(self.info, along(rows))
        cost = {"seconds": float(rows["seconds"].sum()), "rhs": int(rows["rhs"].sum())}
        return Branch(info, points, named(self.special_points, points), outcome, cost)


def info_of(start: Start, name: str) -> BranchInfo:
    """What is true of the whole branch of a start."""
    return BranchInfo(
        name=name,
        states=start.system.state_names,
        parameters=start.parameters,
        parent=start.parent,
        origin=start.origin,
        **{"free": (start.free,), **_facts(start)},
    )


def _facts(start: Start) -> dict[str, Any]:
    """What the problem says of its branches; of a start that failed, what would have been."""
    if isinstance(start.opening, Opening):
        return start.opening.problem.branch_facts()
    system, n = start.system, len(start.system.states)
    kind, largest = ("equilibrium", MAX_RE) if system.period is None else ("periodic_orbit", MAX_ABS)
    if start.orbit:
        kind, largest = "hybrid_orbit" if system.has_events else "periodic_orbit", MAX_ABS
    observables = (*[o.name for o in system.observables], largest)
    return {"problem": kind, "observables": observables, "unknowns": n, "spectrum": n, **start.would_be}


def check_columns(stored: Stored, info: BranchInfo) -> None:
    """Refuse to append points to rows that have other observables than points have now.

    Raises
    ------
    DatabaseError
    """
    if stored.observables is None or stored.observables == info.observables:
        return
    lacking = [name for name in info.observables if name not in stored.observables]
    which = f"have no {', '.join(lacking)}" if lacking else f"have {', '.join(stored.observables)}"
    raise DatabaseError(
        f"Branch {info.name} cannot be gone on with: its stored points {which}. Another version of contwalk "
        "began it.",
        "Go on with that version, give another --output, or --force to start anew.",
    )


def closed(work: BranchInProgress) -> bool:
    """Whether a direction has come back to the start, so that the other one is known."""
    return any(outcome.reason == "closed" for _, outcome in work.outcomes)


def spent(work: BranchInProgress, sign: float) -> int:
    """How many of the points that a direction may have are there: those at the start, and its own."""
    return sum(1 for row in work.rows if row["s"][0] * sign >= 0.0)


def outdated(stored: Stored, settings: Settings, info: BranchInfo, allowed: Bound) -> frozenset[int]:
    """Special points that are no ends any more, by their numbers.

    They were ends where fewer points, a narrower range or fewer right-hand sides than `allowed` were allowed
    than are now. Images of a half cost nothing: they end where that one does.
    """
    found = set()
    for number, point in enumerate(stored.special_points):
        if point.label != END:
            continue
        values = stored.rows["free"][stored.rows["s"] == point.s]
        own = int(np.sum(stored.rows["s"] * (1.0 if point.s > 0 else -1.0) >= 0.0))
        within = [
            low < v[-1 - place] < high for v in values for place, (low, high) in settings.bounds.items()
        ]
        widened = point.kind == "bound" and all(within)
        walked = 1.0 if point.s > 0.0 or info.settings.get("mirror") else -1.0
        cheaper = point.kind == "effort" and not allowance_of(allowed, stored.rows[:, None], walked).used_up
        if widened or cheaper or (point.kind == "max_points" and own < settings.max_points):
            found.add(number)
    return frozenset(found)


def resumed(
    problem: Problem,
    work: BranchInProgress,
    stored: Stored,
    signs: tuple[float, ...],
    events: Mapping[str, str],
    without: frozenset[int] = frozenset(),
) -> tuple[dict[float, tuple[Problem, ContinuationState]], tuple[int, ...]]:
    """Where each direction goes on; those that have ended are left out and their outcomes taken over.

    The second value tells the numbers of the special points that are kept; those of `without` are not.
    """
    rows = stored.rows
    regular = np.flatnonzero(~rows["special"])
    kept = rows[: regular[-1] + 1]
    work.rows = [kept[i : i + 1] for i in range(len(kept))]
    # A mark of the start has a row of its own at the start's place: it is kept only if that row is.
    regular_s, special_s = set(kept["s"].tolist()), set(kept["s"][kept["special"]].tolist())
    points = tuple(
        number
        for number, p in enumerate(stored.special_points)
        if number not in without and p.s in (regular_s if p.label == END else special_s)
    )
    work.special_points = [stored.special_points[number] for number in points]
    ends = _ends(work.special_points, kept["s"], signs)
    born = work.info.parent is not None
    places: dict[float, tuple[Problem, ContinuationState]] = {}
    for sign in signs:
        if sign in ends:
            end = ends[sign]
            outcome = restored(end, goes_on(problem.point_types, end, events))
            work.outcomes.append((sign, outcome))
            continue
        side = kept[(np.sign(kept["s"]) == sign) & ~kept["special"]]
        if len(side):
            places[sign] = from_row(problem, side[-1], sign, born)
        else:
            places[sign] = from_row(problem, kept[0], sign, born)
    return places, points


def _ends(
    special_points: Sequence[SpecialPoint], s: np.ndarray, signs: tuple[float, ...]
) -> dict[float, SpecialPoint]:
    """The ends of directions; `s` are the places of all rows.

    A direction that ended where it began, as at an end of the range, has no row of its own.
    """
    own = [point for point in special_points if point.label == END]
    ends = {float(np.sign(point.s)): point for point in own if point.s}
    short = [sign for sign in signs if sign not in ends and not np.any(s * sign > 0.0)]
    return ends | dict(zip(short, [point for point in own if not point.s], strict=False))


_ORDER = {"complete": 0, "stopped": 1, "failed": 2}


def combined(ends: list[tuple[float, Outcome]], message: str) -> Outcome:
    """One outcome for both ends: the worse one decides, of equal ones what is not the range's end; each is
    told.
    """
    ends = sorted(ends, key=lambda end: -end[0])  # whichever was known first
    worst = max((outcome for _, outcome in ends), key=lambda o: (_ORDER[o.status], o.reason != "bound"))
    texts = [o.message for _, o in ends]
    if len(texts) == 2 and texts[0] == texts[1]:
        texts = [f"Both directions: {texts[0]}"]
    elif [o.reason for _, o in ends] == ["bound", "bound"]:
        texts = ["Both directions reached an end of the range. Widen `range` to go on."]
    elif len(texts) == 2:
        names = {1.0: "Forward", -1.0: "Backward"}
        texts = [f"{names[sign]}: {o.message}" for sign, o in ends]
    return replace(worst, message=" ".join([*texts, message]).strip())


def allowance_of(bound: Bound, rows: Iterable[np.ndarray], sign: float) -> Allowance:
    """What a direction has of its bound, by the rows of its branch, each of shape (1,)."""
    found = Allowance(bound)
    for row in rows:
        side = row["s"][0] * sign
        if side >= 0.0:
            found.tell(row["free"][0, 0], int(row["rhs"][0]) if side > 0.0 else 0)
    return found


def restored(end: SpecialPoint, goes_on: bool) -> Outcome:
    """The outcome of an end point that is stored; `goes_on`: other branches leave the limit there."""
    reason = str(end.kind)
    status = "complete" if goes_on or reason in _COMPLETE else "failed" if reason in _FAILED else "stopped"
    return Outcome(status, reason, end.note or f"Ended with {reason}. Nothing more is known.")


def goes_on(kinds: Sequence[PointType], end: SpecialPoint, events: Mapping[str, str]) -> bool:
    """Whether an end point is a limit, of some kinds, at which the diagram goes over to other branches."""
    limits = (kind for kind in kinds if isinstance(kind, LimitType))
    return any(end.kind == kind.reason and events.get(kind.label) == "switch" for kind in limits)
