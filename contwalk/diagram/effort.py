"""What branches may cost: so many times what the first one of their problem did, in right-hand sides.

Right-hand sides are counted, and stored with each point. So what is left for later follows from what is
stored: it is the same whatever the load of a machine, whoever walks, and however often a run was killed.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from contwalk.branch import ORBITS, Branch, BranchInfo, Outcome
from contwalk.continuation.allowance import Bound
from contwalk.continuation.settings import Settings
from contwalk.diagram.branch_in_progress import Start
from contwalk.labels import END

REASON = "effort"
# Keys of notes on what was left for later: of the branches of a run, and of its curves in two parameters.
LEFT_FOR_LATER = ("effort", "effort of curves")


class Efforts:
    """What the branches of a diagram have cost so far, and what others may.

    A branch may cost `effort` times what the first one of the same problem did: equilibria, orbits,
    curves of either. Of one start all orbits of later generations than the first one's may cost as much
    together, too: each doubled branch has doublings of its own, and there is no end of them. For each
    largest step that one of these gets on in the parameter, from the run's third generation on, it may
    cost as many points of the first branch as `effort` says, each as many times as its orbits have
    periods of it; beyond that, all of one start have as many once more. So a cascade that fills the range
    is followed, and one within less than a step of it is begun.

    Parameters
    ----------
    effort : float
        Infinite where nothing is left for later.
    settings : Settings
    command : str
        What goes on with a run without such bounds.
    """

    def __init__(self, effort: float, settings: Settings, command: str = "") -> None:
        self._effort, self._settings, self._command = effort, settings, command
        self._first: dict[tuple[bool, bool], _First] = {}
        self._generation: dict[int | None, int] = {}
        self._deeper: Counter[int | None] = Counter()
        self._beyond: dict[int | None, float] = {}
        self._known: dict[str, tuple[Branch, float]] = {}
        self._stopped: list[str] = []
        self._unbegun: list[str] = []

    def most(self, start: Start, info: BranchInfo) -> Bound:
        """What the branch of a start may cost if no others like it had cost anything."""
        first = self._first.get(_problem(info))
        if first is None:
            return Bound()
        most = self._effort * first.each * first.points
        if not self._is_deeper(start, info) or start.generation < 2:  # a run's answer
            return Bound(most)
        points = self._effort * first.each * self._periods(start)
        step = self._settings.max_share * self._settings.width
        return Bound(most, points, points / step) if math.isfinite(step) else Bound(most)

    def left(self, start: Start, info: BranchInfo) -> Bound:
        """What the branch of a start may cost, with what others like it have."""
        bound, root = self.most(start, info), _root(start)
        if not self._is_deeper(start, info):
            return bound
        part = 1.0 - self._beyond.get(root, 0.0)
        return Bound(bound.most - self._deeper[root], bound.beyond * part, bound.worth)

    def tell(self, start: Start, branch: Branch) -> None:
        """A branch is there."""
        cost, problem, root = int(branch.cost["rhs"]), _problem(branch.info), _root(start)
        if any(point.label == END and point.kind == REASON for point in branch.special_points):
            self._stopped.append(branch.name)
        if self._is_deeper(start, branch.info):
            bound, values = self.most(start, branch.info), branch.points["free"][:, 0]
            over = cost - bound.worth * float(np.ptp(values)) if len(values) else 0.0
            self._deeper[root] += cost
            self._beyond[root] = self._beyond.get(root, 0.0) + max(over, 0.0) / bound.beyond
        self._known[branch.name] = branch, self._periods(start)
        if len(branch) < 2:  # it went nowhere, and is no measure
            return
        # No step moves the parameter by more than `max_share` of its range: a branch that crosses the range
        # has so many points, and one that ended before tells only what each of them costs. What keeps a
        # branch of equilibria from going on is the number of its points, as all of them cost alike.
        whole = 1.0 / self._settings.max_share if problem[1] else self._settings.max_points
        self._first.setdefault(problem, _First(cost / len(branch), max(len(branch), whole)))
        if problem == _FAMILY:
            self._generation.setdefault(root, start.generation)

    def pass_over(self, start: Start) -> None:
        """Nothing is left for a branch, and it is not begun."""
        self._unbegun.append(start.origin)

    def sentence(self) -> str | None:
        """What was left for later, and the command that goes on; None where nothing was."""
        parts = []
        if self._stopped:
            parts.append(f"{', '.join(self._stopped)} stopped")
        if self._unbegun:
            parts.append(f"what begins at {', '.join(self._unbegun)} was not begun")
        if not parts:
            return None
        how = f" To go on: {self._command}" if self._command else ""
        return f"Left for later (`diagram.effort` = {self._effort:g}): {'; '.join(parts)}.{how}"

    def _is_deeper(self, start: Start, info: BranchInfo) -> bool:
        born = start.leaves is not None and start.leaves.births
        generation = self._generation.get(_root(start), math.inf)
        return _problem(info) == _FAMILY and not born and start.generation > generation

    def _periods(self, start: Start) -> float:
        """Of how many periods of the first orbits those of a start are: twice as many if doubled."""
        parent, s = start.parent or ("", 0.0)
        if parent not in self._known or isinstance(start.opening, Outcome):
            return 1.0
        (branch, before), sample = self._known[parent], start.opening.state.sample
        ratio = sample.period / branch.points["period"][branch.points["s"] == s].mean()
        return before * max(1.0, round(ratio)) if math.isfinite(ratio) else before


@dataclass(frozen=True)
class _First:
    """The first branch of a problem: what each of its points has cost, and how many count."""

    each: float
    points: float


_FAMILY = (False, True)


def _problem(info: BranchInfo) -> tuple[bool, bool]:
    """What is solved along a branch: whether it is a curve in two parameters, and whether of orbits."""
    of = info.settings.get("of_problem", info.problem)
    return info.problem == "locus", of in ORBITS


def _root(start: Start) -> int | None:
    """The start that one has grown out of, by its number."""
    return start.number[0] if start.number else None
