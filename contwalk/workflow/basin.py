"""The basin of a solution on a plane of two states: what motions come to, refined where that differs."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.flow.hybrid.motion_events import Standpoint
from contwalk.storage import open_database
from contwalk.storage.journal import Journal
from contwalk.studies.margins.refinement import Cell, Vertex, refined
from contwalk.studies.margins.solution import Instant, solution_at
from contwalk.studies.margins.survival import FALLEN, SURVIVED
from contwalk.workflow.basin_points import UNKNOWN, Attractors, BasinStudy
from contwalk.workflow.many_runs import Runs
from contwalk.workflow.margin_rays import Study, survival_of
from contwalk.workflow.margin_study import changed_on_plane
from contwalk.workflow.run_file.margins import MarginsFile

# How near a motion must be to a solution to have come to it, in units of the magnitudes, where nobody says.
NEARNESS = 0.1
# Parameters are the same within this part of their size.
SAME = 1e-9
MOST_NEW = 8  # attractors that no stored solution is; what comes to more of them stays unknown
SAMPLES = 400  # states on each of them, over the time of survival
UNSTABLE = "unstable"  # names of places where motions rest that begin on a border of basins
BESIDE = 1e-3  # of the nearness: how far beside such a place others begin, and how still it is
SETTLING = 2.0  # of these times that one is followed for before


@dataclass(frozen=True, eq=False)
class BasinResult:
    """A basin.

    Parameters
    ----------
    states : tuple of str
        The two that are pushed.
    places : ndarray, shape (k, 2)
        Their values.
    labels : tuple of str
        What each comes to: the name of a stored solution, `new1`, .. of another one, `unstable1`, ..
        of a place of rest that attracts nothing, or the code of how it ends.
    cells : ndarray, shape (c, 3)
        Squares in the end: their lower left values, and their part of the ranges.
    cell_labels : tuple of str
        Theirs; empty where their corners differ.
    own : tuple of float
        Values of the two at the instant of the solution.
    notes : list of str
    """

    states: tuple[str, str]
    places: np.ndarray
    labels: tuple[str, ...]
    cells: np.ndarray
    cell_labels: tuple[str, ...]
    own: tuple[float, float]
    notes: list[str] = field(default_factory=list)


def basin_study(run: MarginsFile, study: Study) -> BasinStudy:
    """What all points of the plane that a run file asks for share."""
    assert run.margins.basin is not None
    return BasinStudy(study, known_attractors(run, study), run.margins.basin.instant)


def known_attractors(run: MarginsFile, study: Study) -> Attractors:
    """The solutions of the database at the parameters of the one that is pushed, without unstable ones."""
    wanted, values = run.margins, study.solution.parameters
    courses = {wanted.of.point: study.solution.course}
    with open_database(run.database) as db:
        for name in db.branch_names():
            branch = db.branch(name)
            places: list[SpecialPoint | int] = [*range(len(branch)), *branch.special_points]
            for place in places:
                called = f"{name}/{place if isinstance(place, int) else place.name}"
                if called == wanted.of.point or not _stands_there(branch, place, values):
                    continue
                course = solution_at(run.system, branch, place, (0.0,)).course
                if all(not _same_course(study, course, other) for other in courses.values()):
                    courses[called] = course
    return Attractors(courses, wanted.survive.returns or NEARNESS)


def _stands_there(branch: Any, place: SpecialPoint | int, values: dict[str, float]) -> bool:
    """Whether a point is not known to be unstable, and its parameters are these."""
    if branch.info.problem not in ("equilibrium", "periodic_orbit", "hybrid_orbit"):
        return False
    if isinstance(place, int):
        unstable = int(branch["unstable"][place]) > 0
        own = branch.parameters_at(place)
    else:
        unstable = bool(place.unstable_before or place.unstable_after)
        own = dict(place.parameters)
    return not unstable and all(
        abs(float(own.get(name, value)) - value) <= SAME * abs(value) for name, value in values.items()
    )


def _same_course(study: Study, course: np.ndarray, other: np.ndarray) -> bool:
    """Whether a course is, at its first state, on another one."""
    first = np.where(np.isfinite(course[0]), course[0], 0.0)
    return survival_of(study).distance(first, other) <= 1e-3


def basin_of(
    run: MarginsFile,
    basin: BasinStudy,
    journal: Journal,
    kept: Sequence[dict[str, Any]],
    runs: Runs[BasinStudy, tuple[float, ...], dict[str, Any]],
) -> BasinResult:
    """The labels of a plane of pushes; those in `kept` are taken, new ones are added to the journal."""
    wanted = run.margins.basin
    assert wanted is not None
    (first, second), solution = wanted.states, basin.study.solution
    names, steps = run.system.state_names, wanted.cells * 2**wanted.levels
    low, high = (
        np.array([wanted.states[name][k].value(solution.parameters) for name in (first, second)])
        for k in (0, 1)
    )
    places = [names.index(first), names.index(second)]
    # Where motions keep what they begin with each comes to a solution of its own.
    most = 0 if changed_on_plane(run, basin.study) else MOST_NEW
    base, done, named = solution.instants[wanted.instant].state, list(kept), _NewAttractors(basin, most)

    def value(vertex: Vertex) -> np.ndarray:
        return np.asarray(low + (high - low) * np.array(vertex) / steps)

    def push(vertex: Vertex) -> tuple[float, ...]:
        along = np.zeros(len(names))
        along[places] = value(vertex) - base[places]
        return tuple(along.tolist())

    def label(vertices: Sequence[Vertex]) -> list[str]:
        found, there = [], min(len(done), len(vertices))
        entries = done[:there]
        del done[:there]
        for entry in entries:
            found.append(named.name(entry))
        for entry in runs.in_order([push(v) for v in vertices[there:]]):
            journal.add(entry)
            found.append(named.name(entry))
        return found

    labels, cells = refined(label, wanted.cells, wanted.levels)
    return BasinResult(
        states=(first, second),
        places=np.array([value(vertex) for vertex in labels]),
        labels=tuple(labels.values()),
        cells=np.array([[*value((c.i, c.j)), c.size / steps] for c in cells]),
        cell_labels=tuple(labels[c.i, c.j] if _even(c, labels) else "" for c in cells),
        own=(float(base[places[0]]), float(base[places[1]])),
        notes=named.notes,
    )


def _even(cell: Cell, labels: dict[Vertex, str]) -> bool:
    return len({labels[corner] for corner in cell.corners}) == 1


class _NewAttractors:
    """Names what is none of the stored solutions: new1, new2, .. in the order in which motions come to
    them."""

    def __init__(self, basin: BasinStudy, most: int) -> None:
        self._basin, self._most, self._new = basin, most, Attractors({}, basin.attractors.nearness)
        self.notes: list[str] = []

    def name(self, entry: dict[str, Any]) -> str:
        if entry["label"] != UNKNOWN:
            return str(entry["label"])
        state, courses = np.array(entry["state"]), self._new.courses
        if courses:
            known = self._new.nearest(self._basin.study, state)
            if known != UNKNOWN:
                return known
        if len(courses) >= self._most:
            return UNKNOWN
        course = self._course(Standpoint(entry["time"], entry["mode"], state))
        if course is None:
            return UNKNOWN
        # What had not settled when it counted as having survived may have come to what is known.
        for attractors in (self._basin.attractors, self._new):
            if attractors.courses and (known := attractors.nearest(self._basin.study, course[-1])) != UNKNOWN:
                return known
        survival = survival_of(self._basin.study)
        names = survival.system.state_names
        where = ", ".join(f"{name} {value:.6g}" for name, value in zip(names, course[-1], strict=True))
        if self._leaves(survival.end, course):
            named = _next_of(UNSTABLE, courses)
            self.notes.append(
                f"{named} attracts nothing: motions on borders of basins come to rest at {where}."
            )
        else:
            named = _next_of("new", courses)
            self.notes.append(f"{named} is none of the stored solutions: motions come to {where}.")
        self._new = replace(self._new, courses={**courses, named: course})
        return named

    def _leaves(self, at: Standpoint, course: np.ndarray) -> bool:
        """Whether a motion has come to rest, all over its course, shape (k, n), and motions from beside that
        place go away from it: the lattice has met the border of a basin."""
        survival = survival_of(self._basin.study)
        magnitudes, near = survival.solution.magnitudes, self._basin.attractors.nearness
        if (np.ptp(course, axis=0) > BESIDE * near * magnitudes).any():
            return False
        exists = list(survival.system.states_of(at.mode))
        push = np.zeros(len(magnitudes))
        push[exists] = BESIDE * near * (magnitudes * np.cos(1.0 + np.arange(len(push))))[exists]
        instant = Instant(0.0, at.time, at.mode, at.state, tuple(exists), at.last or "")
        for side in (push, -push):
            ended, _ = survival.followed(instant, side)
            away = ended == SURVIVED and survival.distance(survival.end.state, course) > near
            if away or ended == FALLEN:
                return True
        return False

    def _course(self, begin: Standpoint) -> np.ndarray | None:
        """States on what a motion has come to, shape (k, n); None where it ends."""
        survival, states, at = survival_of(self._basin.study), [], begin
        duration = survival.rule.duration
        for part in (SETTLING, *[1.0 / SAMPLES] * SAMPLES):
            ended, _ = survival.moved(at, part * duration)
            if ended != SURVIVED:
                return None
            at = survival.end
            states.append(at.state)
        return np.array(states)


def _next_of(word: str, names: Collection[str]) -> str:
    """The next of the names that are a word and a number."""
    return f"{word}{sum(name.startswith(word) for name in names) + 1}"
