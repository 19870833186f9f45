"""Running a study: diagram events into the database as they happen, then the figures."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from contwalk.branch import Branch, BranchInfo, SpecialPoint
from contwalk.branch_words import told_branch
from contwalk.diagram import not_begun
from contwalk.diagram.ahead import Ahead
from contwalk.diagram.branch_in_progress import Stored
from contwalk.diagram.diagram import Diagram
from contwalk.diagram.effort import LEFT_FOR_LATER
from contwalk.diagram.events import Began, Cut, Dropped, Ended, Event, Found, Noted
from contwalk.errors import DatabaseError, interruptible
from contwalk.numerics.threads import one_thread
from contwalk.special_point import allowed_error
from contwalk.storage.backends import backend_of
from contwalk.storage.database import Database, RunHeader
from contwalk.storage.file_database import FileDatabase
from contwalk.system.loading import files_of
from contwalk.workflow.equations import equations_hash, equations_text
from contwalk.workflow.figures_of_run import check_figures, drawn
from contwalk.workflow.going_on import claims_of, differences, header_of_both
from contwalk.workflow.machine import made_elsewhere, name_of_machine, versions_and_processor
from contwalk.workflow.notebook_line import watcher
from contwalk.workflow.plans import (
    Study,
    all_starts,
    coverage_of,
    discretization_of,
    first_tasks,
    settings_of,
    studies_of,
)
from contwalk.workflow.reporter import Reporter
from contwalk.workflow.run_file.reading import RunFile
from contwalk.workflow.sweep_notes import lost_values
from contwalk.workflow.without_value import notes_of

NO_CURVE = (
    "There is no curve in two parameters: no special point of the kinds that `loci` asks for was found where "
    "one can be followed."
)


@dataclass
class RunResult:
    """What a run left behind."""

    path: Path
    branches: list[Branch] = field(default_factory=list)
    figures: list[Path] = field(default_factory=list)
    interrupted: bool = False

    def __repr__(self) -> str:
        how = "interrupted, run(..., resume=True) goes on" if self.interrupted else "finished"
        return "\n".join([f"run into {self.path}, {how}", *map(told_branch, self.branches)])


def run(
    run_file: RunFile,
    *,
    resume: bool = False,
    force: bool = False,
    figures: bool = True,
    reporter: Reporter | None = None,
    jobs: int = 1,
    executor: Any = None,
) -> RunResult:
    """Compute the diagram that a run file describes.

    Parameters
    ----------
    run_file : RunFile
    resume : bool
        Go on with an output that exists.
    force : bool
        Replace an output that exists.
    figures : bool
        Draw the figures of the run file.
    reporter : Reporter, optional
        Told what happens. In notebooks a line of the cell is, where none is given.
    jobs : int
        Processes of this machine that branches are walked in, where there are several at once.
    executor : object, optional
        Walks them instead: with `submit`, as of `concurrent.futures` and dask, or with `map` alone. What is
        stored is the same, whoever walks.

    Raises
    ------
    ContwalkError
        Before anything is written, for bad input; later only if the database cannot be written.
    KeyboardInterrupt
        Outside the computing. Within it, what comes back says that it was interrupted.
    """
    kept = f"Interrupted. What was found is in {run_file.output}: run(..., resume=True) goes on."
    with interruptible(kept), ExitStack() as watched:
        reporter = reporter or watched.enter_context(watcher(run_file.range))
        result = _run(run_file, resume, force, figures, reporter, jobs, executor)
        if result.interrupted:
            reporter.interrupted(kept)
    return result


@one_thread()
def _run(
    run_file: RunFile,
    resume: bool,
    force: bool,
    figures: bool,
    reporter: Reporter,
    jobs: int,
    executor: Any,
) -> RunResult:
    traced(run_file)
    if figures:
        check_figures(run_file, replacing=force or (resume and run_file.output.exists()))
    studies = studies_of(run_file)
    result = RunResult(run_file.output)
    walkers = _ahead(run_file, studies, jobs, executor, reporter.note)
    with _database(run_file, resume, force) as db, walkers as ahead:
        for _, _, notes in studies:
            for text in notes:
                reporter.note(text)
        claims = claims_of(db)
        diagram = Diagram(
            all_starts(studies),
            coverage_of(run_file),
            lambda name: _stored(db, name),
            **claims,
            ahead=ahead,
        )
        recorder = _Recorder(db, reporter, result, run_file)
        recorder.tell_without_effect(run_file.without_effect)
        if elsewhere := made_elsewhere(db.header.provenance):
            recorder.note("elsewhere", elsewhere)
        recorder.record(diagram)
        if run_file.loci is not None and not result.interrupted:
            recorder.record(_curves(run_file, db, diagram.branches, claims, recorder.note))
        if claims and not result.interrupted:
            for name in claims["claim"].left:
                recorder.drop(name, "the study that has gone on has no such start")
        if not result.interrupted:
            recorder.forget(LEFT_FOR_LATER)
        result.branches = db.branches()
        if run_file.loci is not None and not result.interrupted:
            recorder.tell_without_curve(any(b.info.problem == "locus" for b in result.branches))
        lost = lost_values(run_file.sweep, result.branches, run_file.output.name)
        if lost and not result.interrupted:
            recorder.note("sweep", lost)
        for key, text in db.notes().items():
            if key not in recorder.noted:  # of an earlier process, of branches that it finished
                reporter.note(text)
    if figures and not result.interrupted:
        result.figures = list(drawn(run_file, result.branches, reporter.note))
    return result


@contextmanager
def _ahead(
    run_file: RunFile, studies: Sequence[Study], jobs: int, executor: Any, tell: Callable[[str], None]
) -> Iterator[Ahead | None]:
    """Who walks branches ahead of their turn, if anybody does; nobody is left behind."""
    if jobs == 1 and executor is None:
        yield None
        return
    from contwalk.workflow.executors import Executed
    from contwalk.workflow.walking_ahead import StudyText
    from contwalk.workflow.workers import Workers

    study = StudyText.of(run_file)
    ahead = Workers(study, jobs, tell) if executor is None else Executed(study, executor, tell)
    try:
        ahead.expect(first_tasks(run_file, studies))
        yield ahead
    finally:
        ahead.close()


def _curves(
    run_file: RunFile,
    db: Database,
    branches: list[Branch],
    claims: Mapping[str, Any],
    note: Callable[[str, str], None],
) -> Diagram:
    """The curves in two parameters from what a study has found."""
    from contwalk.workflow import loci  # of few runs

    assert run_file.loci is not None
    settings = replace(settings_of(run_file), second_range=run_file.loci.range)
    starts_ = loci.from_branches(run_file, branches, settings, discretization_of(run_file), note)
    taken = [*claims.get("taken", ()), *(branch.name for branch in branches)]
    coverage = loci.coverage_of(run_file, settings)
    return Diagram(starts_, coverage, lambda name: _stored(db, name), **{**claims, "taken": taken})


def traced(run_file: RunFile) -> None:
    """Trace the equations once, before anything is written: what cannot be traced is bad input.

    Raises
    ------
    UnsupportedOperation, SystemDefinitionError
        With the line of the plugin.
    """
    equations_text(run_file)


def _database(run_file: RunFile, resume: bool, force: bool) -> FileDatabase:
    """The output, new or reopened."""
    path = run_file.output
    if resume and path.exists():
        with backend_of(path).open(path) as stored:  # opening for writing writes the file anew
            _check_resumable(run_file, stored)
        db = backend_of(path).open(path, writable=True)
        if run_file.config() != db.header.config:
            db.write_header(header_of_both(run_file, db.header))
        return db
    header = RunHeader(run_file.system.name, dict(run_file.model), run_file.config(), provenance(run_file))
    return backend_of(path).create(path, header, overwrite=force)


def _check_resumable(run_file: RunFile, db: FileDatabase) -> None:
    """Refuse to go on with a database of another study, or of another version of the plugin."""
    path = run_file.output
    db.check_modes(run_file.system)
    if differing := differences(run_file, db.header):
        raise DatabaseError(
            f"{path} was computed from another run file: its settings differ from {run_file.path} "
            f"({', '.join(differing)}).",
            "Only max_points and diagram.effort may be raised, and a range widened. Give another --output, "
            "or --force to start anew.",
        )
    if db.header.provenance.get("equations_sha256") != equations_hash(run_file):
        raise DatabaseError(
            f"{path} was computed with another version of the plugin '{run_file.system_reference}': "
            "its equations or defaults have changed since.",
            "Put the plugin back as it was, give another --output, or --force to start anew.",
        )


def provenance(run_file: RunFile) -> dict[str, Any]:
    """Where and with what a database was made, as plain values."""
    import h5py

    from contwalk.plotting.quantities import units_of

    units = units_of(run_file.system)
    files = files_of(run_file.system, run_file.system_reference, run_file.path.parent)
    return {
        **versions_and_processor(),
        "python": sys.version.split()[0],
        "h5py": h5py.__version__,
        "platform": name_of_machine(),
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "run_file": str(run_file.path),
        "run_file_directory": str(run_file.path.resolve().parent),
        "system_reference": run_file.system_reference,
        "plugin_sha256": run_file.system.source,
        "plugin_files": files,
        "units": dict(units),
        "called": units.called,
        "equations_sha256": equations_hash(run_file),
        "accuracy": run_file.accuracy,
        "engine": dict(run_file.engine),
        **{key: run_file.data[key] for key in ("author", "description") if run_file.data.get(key)},
    }


def _stored(db: Database, name: str) -> Stored | None:
    if name not in db.branch_names():
        return None
    branch = db.branch(name)
    outcome = branch.outcome if branch.complete else None
    return Stored(db.rows(name), db.specials(name), outcome, branch.info.observables)


class _Recorder:
    """Writes the events of a diagram into a database."""

    def __init__(self, db: Database, reporter: Reporter, result: RunResult, run_file: RunFile) -> None:
        self.db, self.reporter, self.result, self.accuracy = db, reporter, result, run_file.accuracy
        self._system, self._report_at = run_file.system, run_file.report_at
        self._magnitude = max(map(abs, run_file.range))  # of the free parameter
        self.noted: set[str] = set()
        self._current: BranchInfo | None = None
        self._number = 0

    def note(self, key: str, text: str) -> None:
        """Store a note, and tell it."""
        self.noted.add(key)
        self.db.write_note(key, text)
        self.reporter.note(text)

    def tell_without_effect(self, sentences: Mapping[str, str]) -> None:
        """Notes on what the run file asks for in vain, and none on what an earlier one did."""
        for key in self.db.notes():
            if key.split()[0] == "without_effect" and key not in sentences:
                self.db.write_note(key, "")
        for key, text in sentences.items():
            self.note(key, text)

    def tell_without_curve(self, has_curves: bool) -> None:
        """A note where a study has no curve in two parameters; that of an earlier process goes else."""
        if not has_curves:
            self.note("loci", NO_CURVE)
        elif self.db.notes().get("loci"):
            self.db.write_note("loci", "")

    def forget(self, keys: Sequence[str]) -> None:
        """Take back what an earlier process told under these keys, and this one has not."""
        for key in keys:
            if key not in self.noted and self.db.notes().get(key):
                self.db.write_note(key, "")

    def record(self, diagram: Diagram) -> None:
        """Everything until the end, or until the user interrupts."""
        try:
            for event in diagram.events():
                self._handle(event)
        except KeyboardInterrupt:
            self.result.interrupted = True
            # It may have come while the branch was made, or right after its end was stored.
            name = "" if self._current is None else self._current.name
            if name in self.db and not self.db[name].complete:
                self.db.finish(name, not_begun.interrupted(), self.db[name].cost)

    def _handle(self, event: Event) -> None:
        if isinstance(event, Began):
            self._current, self._number = event.info, 0
            self.db.start_branch(event.info)
            self.reporter.branch_began(event.info)
        elif isinstance(event, Cut):
            self._current, self._number = event.info, event.rows
            self.db.drop_outcome(event.info.name)
            self.db.truncate(event.info.name, event.rows, event.special_points)
            self.reporter.branch_began(event.info)
        elif isinstance(event, Found):
            self._found(event)
        elif isinstance(event, Ended):
            for key, text in notes_of(event.branch, self._system, self._report_at):
                self.note(key, text)
            self.db.finish(event.branch.name, event.branch.outcome, event.branch.cost)
            self._current = None
            self.reporter.branch_ended(event.branch)
        elif isinstance(event, Dropped):
            self.drop(event.name, f"it lies on branch {event.known}, which has gone on to it")
        elif isinstance(event, Noted):
            self.note(event.key, event.text)

    def drop(self, name: str, why: str) -> None:
        """Remove a branch that the finished study does not have, with all that was said of it."""
        for key in self.db.notes():
            if any(word.split("/")[0] == name for word in key.split()):
                self.db.write_note(key, "")
        self.db.drop(name)
        self.note(f"dropped {name}", f"{name} is left out: {why}.")

    def _found(self, event: Found) -> None:
        """Store a point with what is special at it, then tell of both: a run that goes on computes a special
        point without its record anew, and what was told before would be gone if it were killed again.
        """
        name = event.info.name
        if self._current is None or self._current.name != name:  # it was interrupted before its first point
            self._current, self._number = event.info, 0
            self.db.drop_outcome(name)
        if event.row is not None:
            self.db.append(name, event.row)
        if event.special is not None:
            self.db.append_special(name, event.special)
        if event.row is not None:
            row = event.row[0]
            self._number += 1
            self.reporter.point(
                event.info, float(row["free"][0]), float(row["step"]), int(row["unstable"]), self._number
            )
        if event.special is not None:
            self.reporter.special(event.info, event.special)
            self._check_accuracy(event.info, event.special)

    def _check_accuracy(self, info: BranchInfo, point: SpecialPoint) -> None:
        """Say where a point is known less well than was asked for."""
        place = point.parameters[info.free[0]]
        value = abs(place)
        if point.status != "located" or point.error is None:
            return
        if point.error > allowed_error(self.accuracy, value, point.error, self._magnitude):
            share = f", which is {point.error / value:.1e} of it" if value > 0.0 else ""
            text = (
                f"{info.name}: {point.label} at {info.free[0]} = {place:.10g} is known only to "
                f"{point.error:.1e}{share}: more than the accuracy of {self.accuracy:g} that was asked for."
            )
            self.note(f"accuracy {info.name} {point.label} {point.s!r}", text)
