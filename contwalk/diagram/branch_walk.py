"""One branch: both directions from its start, or what is missing of them."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace

import numpy as np

from contwalk.branch import BranchInfo, Outcome
from contwalk.continuation import outcomes
from contwalk.continuation.allowance import UNBOUNDED, Bound
from contwalk.continuation.ends import Crowd
from contwalk.continuation.marks import Observer, observer_of
from contwalk.continuation.pseudo_arclength import Earlier, End, walk
from contwalk.diagram import mirror_images, not_begun
from contwalk.diagram.branch_in_progress import (
    BranchInProgress,
    Start,
    Stored,
    allowance_of,
    closed,
    info_of,
    outdated,
    resumed,
    spent,
)
from contwalk.diagram.events import Began, Cut, Event, Found, Noted, Plan
from contwalk.diagram.first_steps import Beginning, FirstSteps, Place
from contwalk.diagram.opening import Opening
from contwalk.diagram.rows import from_row, to_row
from contwalk.diagram.standing_still import with_what_stands_still
from contwalk.diagram.start_marks import marks_at, place_error, start_record, start_refined
from contwalk.labels import END, RANGES
from contwalk.problems.problem import Mirror, Problem, Sample
from contwalk.signatures import is_iterated

# Where each direction sets out, by its sign.
Places = dict[float, Place]


class BranchWalk:
    """How the branches of a plan are walked. What is found depends on the start alone.

    Parameters
    ----------
    plan : Plan
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._mirrored: tuple[Opening, Mirror | None] | None = None
        self._begun: Beginning | None = None

    def signs(self, start: Start) -> tuple[float, ...]:
        """The directions that the branch of a start is walked in, the first one first."""
        if start.parent is None:
            return self._plan.directions if start.depth == 0 else (1.0, -1.0)
        one_sided = isinstance(start.opening, Opening) and start.opening.one_sided
        return (1.0,) if one_sided else (1.0, -1.0)

    def sides(self, start: Start, opening: Opening) -> tuple[float | None, ...]:
        """The directions that can be walked independently of each other; None for all that there are.

        Where one half is the image of the other, it follows from that one.
        """
        signs = self.signs(start)
        try:
            mirrored = self.mirror(opening, start) is not None
        except outcomes.BREAKDOWNS:  # then the walk itself tells what is wrong
            mirrored = True
        return (None,) if mirrored or len(signs) == 1 else signs

    def mirror(self, opening: Opening, start: Start) -> Mirror | None:
        """What takes one half of a branch to the other, so that one of them is known."""
        both = start.parent is not None and len(self.signs(start)) == 2
        if not both or self._plan.settings.mirror_images == "walked":
            return None
        if self._mirrored is None or self._mirrored[0] is not opening:  # asked several times of one start
            self._mirrored = opening, opening.problem.equivalence.mirror(opening.state.sample)
        return self._mirrored[1]

    def info(self, start: Start, name: str) -> BranchInfo:
        """What is true of the whole branch of a start, its symmetry among it, and where it is looked for."""
        info = self._within(info_of(start, name))
        try:
            mirror = None if isinstance(start.opening, Outcome) else self.mirror(start.opening, start)
        except outcomes.BREAKDOWNS:  # then the walk itself tells what is wrong
            mirror = None
        return info if mirror is None else replace(info, settings={**info.settings, "mirror": mirror.names})

    def _within(self, info: BranchInfo) -> BranchInfo:
        """With the ranges of both parameters, where there are two and they have ends."""
        settings = self._plan.settings
        if settings.second_range is None or len(info.free) != 2:
            return info
        ranges = zip(info.free, (settings.range, settings.second_range), strict=True)
        found = {free: list(ends) for free, ends in ranges if np.all(np.isfinite(ends))}
        return replace(info, settings={**info.settings, RANGES: found})

    def beside(self, start: Start, opening: Opening, sign: float) -> Sample | None:
        """The first point away from a start, or half way to where the branch ends before it.

        The steps to that point are not taken again where the branch is walked.
        """
        settings = self._plan.settings
        if self._begun is None or self._begun.opening is not opening:
            row = to_row(self.info(start, ""), opening.problem, opening.state, 1.0, None)
            self._begun = Beginning(opening, row)
        problem, state = from_row(opening.problem, self._begun.row[0], sign, start.parent is not None)
        # The start is one of the points that a branch may have, but one step is looked at in any case.
        observer, points = observer_of(opening.problem), max(settings.max_points - 1, 1)
        steps = FirstSteps((problem, state), settings, observer, sign, points)
        self._begun.steps[sign] = steps
        event = steps.first()
        if isinstance(event, End) and event.special.s != state.s:
            state = replace(state, step=0.5 * abs(event.special.s - state.s))
            event = FirstSteps((problem, state), settings, observer, sign, points).first()
        return None if isinstance(event, End) else event.state.sample

    def events(
        self,
        start: Start,
        opening: Opening,
        work: BranchInProgress,
        stored: Stored | None,
        side: float | None = None,
        allowed: Bound = UNBOUNDED,
    ) -> Iterator[Event]:
        """All that happens on a branch, which `work` is told of; an error ends it with an outcome.

        With a `side`, one of `sides`, what happens on that one; what happens at the start belongs to the
        first one. Each direction may cost an equal part of what is `allowed`.
        """
        try:
            signs = self.signs(start)
            allowed = self.each(start, allowed)
            beginning = self._beginning(opening, work, stored, signs, allowed)
            places = (yield from beginning) if side in (None, signs[0]) else _silently(beginning)
            places = {sign: places[sign] for sign in places if side in (None, sign)}
            yield from self._walked(start, opening, work, places, allowed)
        except outcomes.BREAKDOWNS as error:
            work.broken = True
            work.outcomes.append((1.0, not_begun.broken_by(error, "The branch cannot be followed")))

    def each(self, start: Start, allowed: Bound) -> Bound:
        """What each direction of a branch may cost, of what all may."""
        return allowed.part(len(self.signs(start)))

    def rest(
        self, start: Start, opening: Opening, work: BranchInProgress, side: float | None, allowed: Bound
    ) -> Iterator[Event]:
        """What is missing of a side that others have walked up to what it may cost."""
        signs = self.signs(start) if side is None else (side,)
        so_far = Stored(np.concatenate(work.rows), work.special_points, None)
        places, _ = resumed(opening.problem, work, so_far, signs, self._plan.settings.events)
        yield from self._walked(start, opening, work, places, self.each(start, allowed))

    def _beginning(
        self,
        opening: Opening,
        work: BranchInProgress,
        stored: Stored | None,
        signs: tuple[float, ...],
        allowed: Bound,
    ) -> Generator[Event, None, Places]:
        """What happens at the start of a branch, new or taken up again; where each direction sets out."""
        problem, settings = opening.problem, self._plan.settings
        if stored is None or not len(stored.rows):
            if stored is None:
                yield Began(work.info)
                if problem.meshed is not None and not is_iterated(work.info.signature):
                    text = f"{work.info.name}: integrated by {problem.meshed.method}."
                    yield Noted(f"method {work.info.name}", text)
            yield from self._kinks(problem, work, opening.state.sample, opening.state.sample)
            begun = self._begun if self._begun is not None and self._begun.opening is opening else None
            row = to_row(work.info, problem, opening.state, 1.0, None) if begun is None else begun.row
            work.rows, steps = [row], {} if begun is None else begun.steps
            yield Found(work.info, work.rows[0], None)
            # The walk sets out from what the row tells, as it would when taken up again.
            born = work.info.parent is not None
            places = {
                sign: steps[sign].place if sign in steps else from_row(problem, row[0], sign, born)
                for sign in signs
            }
        else:
            without = outdated(stored, settings, work.info, allowed)
            places, points = resumed(problem, work, stored, signs, settings.events, without)
            yield Cut(work.info, len(work.rows), points)
        if len(work.rows) == 1:
            yield from self._start_marks(work, opening, observer_of(problem))
        return places

    def _walked(
        self, start: Start, opening: Opening, work: BranchInProgress, places: Places, allowed: Bound
    ) -> Iterator[Event]:
        """The directions of a branch, or what is missing of them."""
        problem, observer = opening.problem, observer_of(opening.problem)
        for sign, place in places.items():
            if closed(work):
                continue
            if sign < 0.0 and (mirror := self.mirror(opening, start)) is not None:
                ended = yield from self._imaged(mirror, problem, work)
                if ended:
                    continue
                side = [row[0] for row in work.rows if row["s"][0] < 0.0]
                if side:
                    place = from_row(problem, side[-1], sign, work.info.parent is not None)
            yield from self._direction(problem, work, place, sign, observer, allowed)
        yield from self._closed_alone(work)

    def _closed_alone(self, work: BranchInProgress) -> Iterator[Event]:
        """Leave out what was walked the other way, with fewer points, before a branch has closed."""
        sign = next((sign for sign, outcome in work.outcomes if outcome.reason == "closed"), 0.0)
        other = [number for number, row in enumerate(work.rows) if row["s"][0] * sign < 0.0]
        if not other:
            return
        first = work.rows[: other[0]]
        before = {row["s"][0] for row in first}
        kept = [n for n, p in enumerate(work.special_points) if p.s in before and p.label != END]
        later = [p for n, p in enumerate(work.special_points) if p.s * sign > 0.0 and n not in kept]
        rows = [row for row in work.rows[other[0] :] if row["s"][0] * sign > 0.0]
        work.rows, work.special_points = first + rows, [work.special_points[n] for n in kept] + later
        work.outcomes = [(side, outcome) for side, outcome in work.outcomes if side == sign]
        yield Cut(work.info, len(first), tuple(kept))
        left = iter(later)
        for row in rows:
            yield Found(work.info, row, next(left) if row["special"][0] else None)
        for point in left:
            yield Found(work.info, None, point)

    def _direction(
        self,
        problem: Problem,
        work: BranchInProgress,
        place: Place,
        sign: float,
        observer: Observer,
        allowed: Bound,
    ) -> Iterator[Event]:
        """One direction of a branch, walked from a place to its end."""
        settings, last = self._plan.settings, place[1].sample
        done = any(row["s"][0] * sign > 0.0 for row in work.rows)
        begun = from_row(problem, work.rows[0][0], sign, work.info.parent is not None)[1] if done else None
        left = settings.max_points - spent(work, sign)
        first = None if self._begun is None else self._begun.steps.pop(sign, None)
        if first is not None and first.place is place and first.points == left:
            first.allowance.bound = allowed
            events = first.whole()
        else:
            earlier = Earlier(begun, _crowd(work, sign))
            allowance = allowance_of(allowed, work.rows, sign)
            events = walk(*place, settings, observer, sign, left, earlier=earlier, allowance=allowance)
        for event in events:
            if isinstance(event, End):
                outcome = with_what_stands_still(event.outcome, work.rows, sign, problem.line.free)
                end = replace(event.special, note=outcome.message)
                work.outcomes.append((sign, outcome))
                work.special_points.append(end)
                yield Found(work.info, None, end)
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
        own, begun = opening.problem, opening.state
        for kind, mark in marks_at(own, begun.sample, self._plan.settings.marks, observer):
            error = place_error(own, begun.sample, mark)
            problem, state = own, begun
            if kind == "parameter":
                problem, sample = start_refined(own, begun.sample)
                state = replace(begun, sample=sample)
            record = start_record(problem, state, kind, mark, error)
            row = to_row(work.info, problem, state, 1.0, record)
            work.rows.append(row)
            work.special_points.append(record)
            yield Found(work.info, row, record)


def _crowd(work: BranchInProgress, sign: float) -> Crowd:
    """What the special points of a direction have told that is taken up again."""
    errors = {float(row["s"][0]): float(row["error"][0]) for row in work.rows if row["special"][0]}
    own = (point for point in work.special_points if point.s * sign > 0.0 and point.label != END)
    passed = (row for row in work.rows if row["s"][0] * sign > 0.0 and not row["special"][0])
    return Crowd(
        ((point.status == "located", point.s, errors.get(point.s, 0.0)) for point in own),
        ((float(row["s"][0]), float(row["error"][0])) for row in passed),
    )


def _silently(beginning: Generator[Event, None, Places]) -> Places:
    """Where each direction sets out, without telling what happens at the start."""
    while True:
        try:
            next(beginning)
        except StopIteration as end:
            places: Places = end.value
            return places
