"""`contwalk margins`: how far a stored solution may be pushed, one state and sign at a time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from contwalk.numerics.threads import one_thread
from contwalk.storage.csv_files import write_csv
from contwalk.storage.journal import Journal, check_still_new, check_stopped, going_on_from
from contwalk.storage.trajectory import Margins, write_margins
from contwalk.studies.margins.solution import Solution
from contwalk.studies.margins.survival import BEYOND
from contwalk.workflow.basin import BasinResult, basin_of, basin_study
from contwalk.workflow.basin_files import drawn_basin, write_basin_table
from contwalk.workflow.basin_points import reached
from contwalk.workflow.machine import made_elsewhere, versions_and_processor
from contwalk.workflow.made_with import made_with_but_the_hour
from contwalk.workflow.many_runs import Executor, Runs
from contwalk.workflow.margin_rays import row_of
from contwalk.workflow.margin_study import check_unpushed, rays_of, study_of
from contwalk.workflow.margins_picture import drawn_margins
from contwalk.workflow.run_file.margins import MarginsFile


@dataclass(frozen=True, eq=False)
class MarginsResult:
    """What was found.

    Parameters
    ----------
    rows : list of dict
        A row for each ray: instant, fraction, state, sign, border (NaN where none was met), several, borders,
        ends (the reason code of what is beyond the border), simulations, farthest (the largest push that was
        tried).
    notes : list of str
        What was left out, and why; that a study was begun on another kind of machine.
    files, figures : list of Path
    basin : BasinResult, optional
    """

    rows: list[dict[str, Any]]
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    figures: list[Path] = field(default_factory=list)
    basin: BasinResult | None = None


@one_thread()
def margins(
    run: MarginsFile,
    *,
    jobs: int = 1,
    executor: Executor | None = None,
    resume: bool = False,
    force: bool = False,
    figures: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> MarginsResult:
    """Find the margins that a run file asks for, and write them.

    Parameters
    ----------
    run : MarginsFile
    jobs : int
        Processes. What is found does not depend on it.
    executor : Executor, optional
        What computes instead, such as a pool or a cluster's client: anything with `map`.
    resume : bool
        Go on with a study that was stopped.
    force : bool
        Replace files that exist.
    figures : bool
        Draw the figure too.
    progress : callable, optional
        Told how many rays are done, and of how many.

    Raises
    ------
    ContwalkError
        For bad input, before anything is written; where the motion does not survive unpushed; where a study
        to go on with is another one.
    """
    names, wanted = Names(run), run.margins.basin
    journal = run.file("margins.journal")
    check_stopped(journal, names.written(figures), resume, force)
    study, modes, notes = study_of(run)
    rays, left_out = rays_of(run, study, modes)
    notes += left_out
    check_unpushed(study)
    identity: dict[str, Any] = {
        "study": study.key,
        "rays": [{**asdict(ray), "vector": list(ray.vector)} for ray in rays],
    }
    plane = None if wanted is None else basin_study(run, study)
    if plane is not None:
        identity |= {"basin": repr(wanted), "solutions known to the basin": plane.attractors.hashes}
    with Journal(journal, identity, resume, versions_and_processor()) as kept:
        if elsewhere := made_elsewhere(*kept.made):
            notes.append(elsewhere)
        check_still_new(kept, names.written(figures), force)
        rows = list(kept.kept[: len(rays)])
        with Runs(row_of, study, jobs, executor) as runs:
            for row in runs.in_order(rays[len(rows) :]):
                kept.add(row)
                rows.append(row)
                if progress is not None:
                    progress(len(rows), len(rays))
        notes += _notes_of(rows)
        basin = None
        if plane is not None:
            with Runs(reached, plane, jobs, executor) as runs:
                basin = basin_of(run, plane, kept, kept.kept[len(rays) :], runs)
            notes += basin.notes
        stored = _to_store(run, study.solution, rows, notes, basin)
        with going_on_from(journal):
            write_margins(names.database, stored)
            files, drawn = [names.database], []
            if rows:
                _write_table(rows, names.table)
                files.append(names.table)
                if figures:
                    undrawn = drawn_margins(stored, run.system, names.picture)
                    notes += [undrawn] if undrawn else []
                    drawn.append(names.picture)
            if basin is not None:
                write_basin_table(basin, names.basin_table)
                files.append(names.basin_table)
                drawn += [drawn_basin(run, basin, names.basin_picture)] if figures else []
        kept.remove()
    return MarginsResult(rows, notes, files, drawn, basin)


class Names:
    """The files that a study writes."""

    def __init__(self, run: MarginsFile) -> None:
        self.database, self.table, self.picture = (run.file(f"margins.{end}") for end in ("h5", "csv", "png"))
        self.basin_table, self.basin_picture = (run.file(f"basin.{end}") for end in ("csv", "png"))
        self._basin = run.margins.basin is not None

    def written(self, figures: bool) -> list[Path]:
        """Those that must not be there before."""
        found = [self.database, self.table, *([self.picture] if figures else [])]
        if self._basin:
            found += [self.basin_table, *([self.basin_picture] if figures else [])]
        return found


def _to_store(
    run: MarginsFile,
    solution: Solution,
    rows: Sequence[dict[str, Any]],
    notes: Sequence[str],
    basin: BasinResult | None,
) -> Margins:
    from contwalk.plotting import units_of

    return Margins(
        system=run.system.name,
        states=run.system.state_names,
        rows=tuple(rows),
        instants=tuple(
            {"fraction": i.fraction, "time": i.time, "mode": i.mode, "state": i.state.tolist()}
            for i in solution.instants
        ),
        header={
            "config": run.text,
            "overrides": list(run.overrides),
            "model": dict(run.model),
            "units": dict(units_of(run.system)),
            "parameters": solution.parameters,
            "notes": list(notes),
            "provenance": made_with_but_the_hour(run.path, run.system_reference, run.system),
        },
        basin={}
        if basin is None
        else {"states": basin.states, "places": basin.places, "labels": basin.labels},
    )


def _notes_of(rows: Sequence[dict[str, Any]]) -> list[str]:
    """What the table alone would not tell."""
    notes = []
    several = sum(row["several"] for row in rows)
    if several:
        notes.append(
            f"On {several} of {len(rows)} rays survival begins again beyond a border; the innermost is told."
        )
    free = sum(row["border"] is None for row in rows)
    if free:
        notes.append(f"On {free} of {len(rows)} rays no border was met as far as was looked: see farthest.")
    beyond = Counter(row["ends"] for row in rows)[BEYOND]
    if beyond:
        notes.append(
            f"On {beyond} of {len(rows)} rays the border is where the push carries a guard past zero."
        )
    return notes


COLUMNS = (
    "instant",
    "fraction",
    "state",
    "sign",
    "border",
    "several",
    "ends",
    "simulations",
    "farthest",
    "borders",
)


def _write_table(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """A line for each ray, all digits kept."""
    write_csv(path, COLUMNS, _cells(rows))


def _cells(rows: Sequence[dict[str, Any]]) -> Iterator[list[object]]:
    for row in rows:
        given = {
            **row,
            "border": "" if row["border"] is None else row["border"],
            "several": bool(row["several"]),
            "borders": " ".join(repr(border) for border in row["borders"]),
        }
        yield [given[name] for name in COLUMNS]
