"""The diagram: a queue of starts, each walked to its ends, and the branches that leave what is found.

The queue is not stored. Starts come from the run and from special points in a fixed order, so that replaying
the stored branches rebuilds it exactly; a branch that is stored half is walked on from its last point.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint
from contwalk.continuation import mirror_images, outcomes
from contwalk.continuation.branch_in_progress import (
    BranchInProgress,
    Start,
    Stored,
    check_columns,
    closed,
    combined,
    info_of,
    outdated,
    resumed,
    spent,
)
from contwalk.continuation.kinds import kind_of
from contwalk.continuation.marks import Observer, marks_at, observer_of
from contwalk.continuation.opening import Opening
from contwalk.continuation.pseudo_arclength import End, Point, walk
from contwalk.continuation.recognition import Known, known_branch
from contwalk.continuation.records import start_record
from contwalk.continuation.rows import from_row, to_row
from contwalk.continuation.settings import Settings
from contwalk.continuation.state import ContinuationState, begin, turned
from contwalk.errors import ContwalkError
from contwalk.labels import END, FOLLOWED
from contwalk.problems.problem import LimitType, Mirror, PointType, Problem, Sample


@dataclass(frozen=True)
class Plan:
    """What a diagram covers: the labels that are followed, how deep, and the directions from a start."""

    settings: Settings
    follow: frozenset[str] = FOLLOWED
    depth: int = 5
    directions: tuple[float, ...] = (1.0, -1.0)


@dataclass(frozen=True)
class Began:
    """A branch begins."""

    info: BranchInfo


@dataclass(frozen=True)
class Found:
    """A point of the current branch, with its row; `special` where it is a special point.

    An end point has no row of its own (`row` is None): it is the last point's.
    """

    info: BranchInfo
    row: np.ndarray | None
    special: SpecialPoint | None


@dataclass(frozen=True)
class Cut:
    """A branch that is stored goes on: keep so many rows, and the special points of these numbers."""

    info: BranchInfo
    rows: int
    special_points: tuple[int, ...]


@dataclass(frozen=True)
class Ended:
    """The current branch ended."""

    branch: Branch


@dataclass(frozen=True)
class Noted:
    """Something about the diagram as a whole, under a key."""

    key: str
    text: str


Event = Began | Found | Cut | Ended | Noted


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
    """

    def __init__(
        self,
        starts: Iterable[Start],
        plan: Plan,
        restore: Callable[[str], Stored | None] = lambda name: None,
        claim: Callable[[Start], str | None] = lambda start: None,
        taken: Sequence[str] = (),
    ) -> None:
        self._claim = claim
        self._taken = set(taken)
        self._starts = iter(starts)
        self._seeds: deque[Start] = deque()
        self._plan = plan
        self._restore = restore
        self.branches: list[Branch] = []
        self._mirrored: tuple[Opening, Mirror | None] | None = None

    def events(self) -> Iterator[Event]:
        """Everything that happens, as it happens."""
        for start in self._queue():
            stored = self._claim(start)
            known = None if stored else self._known(start)
            if known is not None:
                yield Noted(f"skipped {start.origin}", known.sentence(start.origin))
                continue
            yield from self._branch(start, stored or self._next_name())

    def _next_name(self) -> str:
        names = itertools.count(len(self.branches) + 1)
        used = self._taken | {branch.name for branch in self.branches}
        return next(name for name in (f"b{number}" for number in names) if name not in used)

    def _queue(self) -> Iterator[Start]:
        """Starts in their order, each followed by all that grows out of it."""
        for start in self._starts:
            yield start
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
        problem, state = start.opening.problem, start.opening.state
        if start.parent is None:
            return known_branch(problem, state.sample, self.branches)
        twin = self._twin(start)
        if twin is not None:
            return twin
        if start.leaves is not None and start.leaves.births:
            family = next((b.name for b in self.branches if _ends_at_point(b, state)), None)
            if family is not None:
                return Known(family)
        # A branch point lies on the parent anyway: look at the first points away from it.
        mirrored = self._mirror(start.opening, start) is not None
        facing = (state if sign > 0 else turned(state) for sign in self._signs(start)[: 1 if mirrored else 2])
        beside = [sample for place in facing if (sample := self._beside(problem, place)) is not None]
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

    def _beside(self, problem: Problem, state: ContinuationState) -> Sample | None:
        """The first point away from a start, or half way to where the branch ends before it."""
        settings, observer = self._plan.settings, observer_of(problem)
        for _ in range(2):
            for event in walk(problem, state, settings, observer, 1.0, settings.max_points):
                if isinstance(event, Point) and event.special is None:
                    return event.state.sample
            if event.special is None or event.special.s == state.s:
                return None
            state = replace(state, step=0.5 * (event.special.s - state.s))
        return None

    def _signs(self, start: Start) -> tuple[float, ...]:
        if start.parent is None:
            return self._plan.directions
        one_sided = isinstance(start.opening, Opening) and start.opening.one_sided
        return (1.0,) if one_sided else (1.0, -1.0)

    def _mirror(self, opening: Opening, start: Start) -> Mirror | None:
        """What takes one half of a branch to the other, so that one of them is known."""
        both = start.parent is not None and len(self._signs(start)) == 2
        if not both or self._plan.settings.mirror_images == "walked":
            return None
        if self._mirrored is None or self._mirrored[0] is not opening:  # asked several times of one start
            self._mirrored = opening, opening.problem.equivalence.mirror(opening.state.sample)
        return self._mirrored[1]

    def _info(self, start: Start, name: str) -> BranchInfo:
        """What is true of the whole branch of a start, its symmetry among it."""
        info = info_of(start, name)
        try:
            mirror = None if isinstance(start.opening, Outcome) else self._mirror(start.opening, start)
        except outcomes.BREAKDOWNS:  # then the walk itself tells what is wrong
            mirror = None
        return info if mirror is None else replace(info, settings={**info.settings, "mirror": mirror.names})

    def _branch(self, start: Start, name: str) -> Iterator[Event]:
        work = BranchInProgress(self._info(start, name))
        stored = self._restore(work.info.name)
        if stored is not None and stored.outcome is not None and self._is_whole(stored, stored.outcome):
            work.rows, work.special_points = [stored.rows], list(stored.special_points)
            branch = work.branch(stored.outcome)
        elif isinstance(start.opening, Outcome):
            yield Began(work.info)
            branch = work.branch(start.opening)
            yield Ended(branch)
        else:
            if stored is not None:
                check_columns(stored, work.info)
            try:
                yield from self._walked(start, start.opening, work, stored)
            except outcomes.BREAKDOWNS as error:
                work.outcomes.append((1.0, _broken(error, "The branch cannot be followed")))
            branch = work.branch(combined(work.outcomes, start.opening.message))
            yield Ended(branch)
        self.branches.append(branch)
        if not isinstance(start.opening, Outcome) and start.depth < self._plan.depth:
            self._seeds.extend(self._grown(start, start.opening.problem, branch))

    def _is_whole(self, stored: Stored, outcome: Outcome) -> bool:
        """Whether nothing is to be added to a stored branch."""
        return outcome.reason != "interrupted" and not outdated(stored, self._plan.settings)

    def _walked(
        self, start: Start, opening: Opening, work: BranchInProgress, stored: Stored | None
    ) -> Iterator[Event]:
        """Both directions of a branch, or what is missing of them."""
        problem, settings, signs = opening.problem, self._plan.settings, self._signs(start)
        observer = observer_of(problem)
        if stored is None or not len(stored.rows):
            if stored is None:
                yield Began(work.info)
                if problem.meshed is not None:
                    text = f"{work.info.name}: integrated by {problem.meshed.method}."
                    yield Noted(f"method {work.info.name}", text)
            yield from self._kinks(problem, work, opening.state.sample, opening.state.sample)
            work.rows = [to_row(work.info, problem, opening.state, 1.0, None)]
            yield Found(work.info, work.rows[0], None)
            # The walk sets out from what the row tells, as it would when taken up again.
            born = work.info.parent is not None
            places = {sign: from_row(problem, work.rows[0][0], sign, born) for sign in signs}
        else:
            without = outdated(stored, settings)
            places, points = resumed(problem, work, stored, signs, settings.events, without)
            yield Cut(work.info, len(work.rows), points)
        if len(work.rows) == 1:
            yield from self._start_marks(work, opening, observer)
        for sign in signs:
            if sign not in places or closed(work):
                continue
            if sign < 0.0 and (mirror := self._mirror(opening, start)) is not None:
                ended = yield from self._imaged(mirror, problem, work)
                if ended:
                    continue
                side = [row[0] for row in work.rows if row["s"][0] < 0.0]
                if side:
                    places[sign] = from_row(problem, side[-1], sign, work.info.parent is not None)
            yield from self._direction(problem, work, places[sign], sign, observer)

    def _direction(
        self,
        problem: Problem,
        work: BranchInProgress,
        place: tuple[Problem, ContinuationState],
        sign: float,
        observer: Observer,
    ) -> Iterator[Event]:
        """One direction of a branch, walked from a place to its end."""
        settings, last = self._plan.settings, place[1].sample
        for event in walk(*place, settings, observer, sign, settings.max_points - spent(work, sign)):
            if isinstance(event, End):
                work.outcomes.append((sign, event.outcome))
                work.special_points.append(event.special)
                yield Found(work.info, None, event.special)
                continue
            # Before the point itself is: a run that is killed between the two tells it again.
            yield from self._kinks(problem, work, last, event.state.sample)
            last = event.state.sample
            row = to_row(work.info, problem, event.state, sign, event.special)
            work.rows.append(row)
            if event.special is not None:
                work.special_points.append(event.special)
            yield Found(work.info, row, event.special)

    def _imaged(
        self, mirror: Mirror, problem: Problem, work: BranchInProgress
    ) -> Generator[Event, None, bool]:
        """What is missing of the half towards negative s, as images; whether it is whole then."""
        half = mirror_images.Half.of(work.rows, work.special_points, 1.0)
        if half is None:
            return False
        key, done = f"images {work.info.name}", [row for row in work.rows if row["s"][0] < 0.0]
        numbers = mirror_images.watched(self._plan.settings, problem.line.free, work.info.observables)
        other = mirror_images.differing(mirror, half, numbers)
        if other is not None:
            why = f"'{work.info.observables[other]}', which is looked for, is not the same there"
            yield Noted(key, mirror_images.walked_sentence(work.info, mirror, 0, why))
            return False
        if not mirror_images.continues(mirror, half, done):
            return False
        before = [half.start, *(row for row in done if not row["special"][0])][-1]
        last = mirror.sample(before[0])
        for step in half.after(len(done)):
            images = mirror_images.imaged(mirror, step, before)
            if isinstance(images, str):
                value = float(step[-1].row["free"][0, 0])
                count = sum(1 for row in work.rows if row["s"][0] < 0.0)
                why = f"at {problem.line.free} = {value:.10g} {images}"
                yield Noted(key, mirror_images.walked_sentence(work.info, mirror, count, why))
                return False
            for row, point in images:
                sample = mirror.sample(row[0])
                yield from self._kinks(problem, work, last, sample)
                last = sample
                work.rows.append(row)
                if point is not None:
                    work.special_points.append(point)
                yield Found(work.info, row, point)
            before = images[-1][0]
        outcome = next(outcome for sign, outcome in work.outcomes if sign > 0.0)
        outcome, end = mirror_images.end_of_image(work.info, mirror, half.end, outcome, work.rows[-1])
        # Before the end itself is: a run that is killed between the two tells it again.
        yield Noted(key, mirror_images.image_sentence(work.info, mirror, sum(map(len, half.steps))))
        work.outcomes.append((-1.0, outcome))
        work.special_points.append(end)
        yield Found(work.info, None, end)
        return True

    def _kinks(self, problem: Problem, work: BranchInProgress, a: Sample, b: Sample) -> Iterator[Noted]:
        """Once a branch, that the equations of its solutions are smooth by pieces only at a plugin's line."""
        of = "equilibria" if problem.meshed is None else "orbits"
        for kink in problem.diagnosis.kinks_between(a, b):
            key = f"kink {work.info.name} {kink.order} {kink.where}"
            if key not in work.noted:
                work.noted.add(key)
                yield Noted(key, f"{work.info.name}: {kink.sentence(of)}")

    def _start_marks(self, work: BranchInProgress, opening: Opening, observer: Observer) -> Iterator[Found]:
        """Marks that the start of a branch has itself."""
        problem, state = opening.problem, opening.state
        for kind in marks_at(state.sample, self._plan.settings.marks, observer):
            record = start_record(problem, state, kind)
            row = to_row(work.info, problem, state, 1.0, record)
            work.rows.append(row)
            work.special_points.append(record)
            yield Found(work.info, row, record)

    def _followed(self, kind: PointType) -> bool:
        """Whether the branches that leave points of a kind are wanted."""
        if isinstance(kind, LimitType) and not kind.declared:
            return self._plan.settings.events.get(kind.label) == "switch"
        return kind.label in self._plan.follow

    def _grown(self, start: Start, problem: Problem, branch: Branch) -> Iterator[Start]:
        """Starts for the branches that leave a branch's special points."""
        for point in branch.special_points:
            kind = kind_of(problem, point)
            if kind is None or not self._followed(kind) or point.status != "located":
                continue
            if start.parent is not None and abs(point.s) < 1e-9:
                continue  # the point that this branch itself was born at
            for opening in self._openings(problem, kind, point):
                yield replace(
                    start,
                    opening=opening,
                    origin=f"{branch.name}/{point.name}",
                    parent=(branch.name, point.s),
                    depth=start.depth + 1,
                    leaves=kind,
                    orbit=start.orbit or problem.meshed is not None or kind.births,
                )

    def _openings(
        self, problem: Problem, kind: PointType, point: SpecialPoint
    ) -> Iterator[Opening | Outcome]:
        """The branches that leave a point; of one that cannot be begun, why."""
        try:
            for seed in kind.seeds(problem, point):
                state = begin(seed.problem, seed.z, self._plan.settings, seed.tangent, seed.reach)
                if isinstance(state, ContinuationState):
                    yield Opening(seed.problem, state, one_sided=seed.one_sided)
                else:
                    yield outcomes.no_start(state.reason, state.sentence)
        except outcomes.BREAKDOWNS as error:
            yield _broken(error, f"The branch that leaves {point.name} cannot be begun")


def _broken(error: ContwalkError | np.linalg.LinAlgError, what: str) -> Outcome:
    """The outcome of a branch that an error ended."""
    if isinstance(error, ContwalkError):
        return outcomes.broken(f"{what}: {error.sentence}", error.remedy)
    return outcomes.broken(f"{what}: its equations are singular ({error}).", "Start elsewhere.")


# How near the last orbit of a family is to the Hopf point that it ends at, in parameter, period and state.
NEAR_PARAMETER, NEAR_PERIOD, NEAR_STATE = 0.05, 0.1, 0.5


def _ends_at_point(branch: Branch, state: ContinuationState) -> bool:
    """Whether a family of orbits ends at the Hopf point that another one is to begin at."""
    if branch.info.problem != "periodic_orbit" or state.sample.sizes is None:
        return False
    sample, n = state.sample, len(branch.info.states)
    for point in branch.special_points:
        if point.label != END or point.kind != "shrunk":
            continue
        row = branch.points[point.index]
        weights = row["weights"]
        apart = np.abs(row["state"] - sample.z[:n]) / weights[:n]
        if (
            abs(float(row["free"][0]) - sample.parameter) < NEAR_PARAMETER * sample.weights[-1]
            and abs(float(row["period"]) - sample.period) < NEAR_PERIOD * sample.period
            and float(apart.max()) < NEAR_STATE
        ):
            return True
    return False
