"""The diagram: a queue of starts, each walked to its ends, and the branches that leave what is found.

The queue is not stored. Starts come from the run and from special points in a fixed order, so that replaying
the stored branches rebuilds it exactly; a branch that is stored half is walked on from its last point.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from contwalk.branch import ORBITS, Branch, BranchInfo, Outcome
from contwalk.continuation import outcomes
from contwalk.continuation.allowance import Bound
from contwalk.diagram.ahead import Ahead, Task, UpTo, taken_over
from contwalk.diagram.beyond_depth import BeyondDepth
from contwalk.diagram.born_there import born_there
from contwalk.diagram.branch_in_progress import (
    BranchInProgress,
    Start,
    Stored,
    check_columns,
    closed,
    combined,
    outdated,
)
from contwalk.diagram.branch_walk import BranchWalk
from contwalk.diagram.effort import LEFT_FOR_LATER, Efforts
from contwalk.diagram.events import Began, Dropped, Ended, Event, Noted, Plan
from contwalk.diagram.growing import grown, leading
from contwalk.diagram.opening import Opening
from contwalk.diagram.recognition import Known, known_branch
from contwalk.labels import END
from contwalk.problems.problem import Problem, Sample


class Diagram:
    """The branches of a run, one after the other.

    Parameters
    ----------
    starts : iterable of Start
        Opened lazily, one when its turn comes.
    plan : Plan
    restore : callable, optional
        What is stored already of the branch of a name, or None.
    claim : callable, optional
        The name under which the branch of a start is stored, or None. Without it, branches are stored in the
        order in which they are walked.
    taken : sequence of str
        Names that only `claim` may give.
    ahead : Ahead, optional
        Who walks branches ahead of their turn. What is found is the same without.
    """

    def __init__(
        self,
        starts: Iterable[Start],
        plan: Plan,
        restore: Callable[[str], Stored | None] = lambda name: None,
        claim: Callable[[Start], str | None] = lambda start: None,
        taken: Sequence[str] = (),
        ahead: Ahead | None = None,
    ) -> None:
        self._claim = claim
        self._taken = set(taken)
        self._starts = iter(starts)
        self._seeds: deque[Start] = deque()
        self._plan, self._beyond = plan, BeyondDepth(plan.depth)
        self._efforts = Efforts(plan.effort, plan.settings, plan.command)
        self._restore = restore
        self.branches: list[Branch] = []
        self._walk = BranchWalk(plan)
        self._ahead = ahead

    def events(self) -> Iterator[Event]:
        """Everything that happens, as it happens."""
        for start in self._queue():
            if self._used_up(start):
                continue
            stored = self._claim(start)
            known = self._known(start)
            if known is not None:
                if stored:  # begun when the other one had not yet come so far
                    yield Dropped(stored, known.branch)
                self._drop(start)
                yield Noted(f"skipped {start.origin}", known.sentence(start.origin))
                continue
            yield from self._branch(start, stored or self._next_name())
        missing, later = self._beyond.sentence(), self._efforts.sentence()
        if missing is not None:
            yield Noted("depth", missing)
        if later is not None:
            yield Noted(LEFT_FOR_LATER[self._plan.by_generation], later)

    def _used_up(self, start: Start) -> bool:
        """Whether others like it have cost what all of them may; then it is left for later."""
        if not self._efforts.left(start, self._walk.info(start, "")).nothing:
            return False
        self._efforts.pass_over(start)
        self._drop(start)
        return True

    def _drop(self, start: Start) -> None:
        """The branch of a start is not asked for."""
        if self._ahead is not None:
            for task in self._tasks(start):
                self._ahead.drop(task)

    def _next_name(self) -> str:
        names = itertools.count(len(self.branches) + 1)
        used = self._taken | {branch.name for branch in self.branches}
        return next(name for name in (f"b{number}" for number in names) if name not in used)

    def _queue(self) -> Iterator[Start]:
        """Starts in their order, each followed by all that grows out of it, or all of them before that."""
        for start in self._starts:
            yield start
            while self._seeds and not self._plan.by_generation:
                yield self._seeds.popleft()
        while self._seeds:
            yield self._seeds.popleft()

    def _known(self, start: Start) -> Known | None:
        try:
            return self._recognised(start)
        except outcomes.BREAKDOWNS:  # then the walk itself tells what is wrong
            return None

    def _recognised(self, start: Start) -> Known | None:
        """The known branch that a start, or its image, lies on."""
        if isinstance(start.opening, Outcome):
            return None
        opening, problem, state = start.opening, start.opening.problem, start.opening.state
        if start.parent is None:
            return known_branch(problem, state.sample, self.branches)
        twin = self._twin(start)
        if twin is not None:
            return twin
        before = born_there(start, opening, self.branches)
        if before is not None:
            return Known(before.name)
        ended, leaves = list[Branch](), start.leaves
        if leaves is not None and leaves.births:
            reported = problem.observed.reported(state.sample.z)
            ended += [b for b in self.branches if _ends_at_point(b, state.sample, reported)]
        if leaves is not None and leaves.daughters == 1:
            siblings = (b for b in self.branches if b.info.parent and b.info.parent[0] == start.parent[0])
            ended += [b for b in siblings if _comes_back_at(b, state.sample)]
        if ended:
            return Known(ended[0].name)
        # A branch point lies on the parent anyway: look at the first points away from it.
        mirrored = self._walk.mirror(opening, start) is not None
        signs = self._walk.signs(start)[: 1 if mirrored else 2]
        beside = [found for sign in signs if (found := self._walk.beside(start, opening, sign)) is not None]
        names = [known_branch(problem, sample, self.branches) for sample in beside]
        return names[0] if names and None not in names else None

    def _twin(self, start: Start) -> Known | None:
        """The branch that leaves the image of a start's point, on the other half of its parent."""
        assert start.parent is not None
        name, s = start.parent
        parent = next((branch for branch in self.branches if branch.name == name), None)
        mirror = None if parent is None else parent.info.settings.get("mirror")
        if not mirror or start.leaves is None or start.leaves.daughters != 1:
            return None
        leaving = [b for b in self.branches if b.info.parent == (name, -s) and len(b) > 1]
        return Known(leaving[0].name, tuple(mirror)) if len(leaving) == 1 else None

    def _branch(self, start: Start, name: str) -> Iterator[Event]:
        work = BranchInProgress(self._walk.info(start, name))
        stored, allowed = self._restore(work.info.name), self._efforts.left(start, work.info)
        if stored is not None and self._is_whole(start, stored, work.info, allowed):
            assert stored.outcome is not None
            work.rows, work.special_points = [stored.rows], list(stored.special_points)
            branch = work.branch(stored.outcome)
        elif isinstance(start.opening, Outcome):
            yield Began(work.info)
            branch = work.branch(start.opening)
            yield Ended(branch)
        else:
            if stored is not None:
                check_columns(stored, work.info)
            yield from self._happening(start, start.opening, work, stored, allowed)
            branch = work.branch(combined(work.outcomes, start.opening.message))
            yield Ended(branch)
        self.branches.append(branch)
        self._efforts.tell(start, branch)
        if not isinstance(start.opening, Outcome):
            self._grow(start, start.opening.problem, branch)

    def _happening(
        self, start: Start, opening: Opening, work: BranchInProgress, stored: Stored | None, allowed: Bound
    ) -> Iterator[Event]:
        """All that happens on a branch, walked here or by others ahead of its turn."""
        if self._ahead is None or stored is not None or not start.number:
            yield from self._walk.events(start, opening, work, stored, allowed=allowed)
            return
        for task in self._tasks(start):
            if closed(work) or work.broken:  # then there is no other side
                self._ahead.drop(task)
            else:
                each, begins = self._walk.each(start, allowed), opening.state.sample.parameter
                heard = UpTo(self._ahead.messages(task), each, begins)
                yield from taken_over(heard, work)
                if heard.cut:
                    self._ahead.drop(task)
                    yield from self._walk.rest(start, opening, work, task.side, allowed)

    def _grow(self, start: Start, problem: Problem, branch: Branch) -> None:
        """Put the branches that leave a branch into the queue."""
        if self._plan.by_generation:
            leave = leading(self._plan, start, problem, branch.special_points)
            away = [point for point, kind in leave if not kind.goes_on(point)]
            self._beyond.tell(branch.name, away, start.depth)
        seeds = list(grown(self._plan, start, problem, branch.name, branch.special_points))
        self._seeds.extend(seeds)
        if self._ahead is not None and start.number:
            self._ahead.expect([task for seed in seeds for task in self._tasks(seed)])

    def _tasks(self, start: Start) -> list[Task]:
        """What there is to walk of the branch of a start."""
        if isinstance(start.opening, Outcome):
            return []
        allowed = self._efforts.most(start, self._walk.info(start, ""))
        sides = self._walk.sides(start, start.opening)
        return [Task(start.number, side, start.above, allowed) for side in sides]

    def _is_whole(self, start: Start, stored: Stored, info: BranchInfo, allowed: Bound) -> bool:
        """Whether nothing is to be added to a stored branch."""
        if stored.outcome is None or stored.outcome.reason == "interrupted":
            return False
        return not outdated(stored, self._plan.settings, info, self._walk.each(start, allowed))


# Parameter and period of a child's end agree to this, relatively, with those of the point of its parent's at
# which it comes back: two points of a branch that are one, however their orbits' first states are chosen.
COMES_BACK = 1e-7


def _ends(branch: Branch, kind: str) -> Iterator[np.void]:
    """Rows at which a branch ends in some way."""
    ends = (point for point in branch.special_points if point.label == END and point.kind == kind)
    return (branch.points[point.index] for point in ends)


def _comes_back_at(branch: Branch, sample: Sample) -> bool:
    """Whether a child ends at the very point of its parent's that another one is to leave: it is that one."""
    place = sample.parameter, sample.period
    ends = ((float(row["free"][0]), float(row["period"])) for row in _ends(branch, "rejoined"))
    return any(np.allclose(end, place, rtol=COMES_BACK, atol=0.0) for end in ends)


# How near the last orbit of a family is to the Hopf point that it ends at, in parameter, period and state.
NEAR_PARAMETER, NEAR_PERIOD, NEAR_STATE = 0.05, 0.1, 0.5


def _ends_at_point(branch: Branch, sample: Sample, reported: np.ndarray) -> bool:
    """Whether a family of orbits ends at the Hopf point that another one is to begin at.

    The state that is reported of it has the shape (n,).
    """
    if branch.info.problem not in ORBITS or sample.sizes is None:
        return False
    return any(
        abs(float(row["free"][0]) - sample.parameter) < NEAR_PARAMETER * sample.weights[-1]
        and abs(float(row["period"]) - sample.period) < NEAR_PERIOD * sample.period
        and np.max(np.abs(row["state"] - reported) / row["weights"][: len(reported)]) < NEAR_STATE
        for row in _ends(branch, "shrunk")
    )
