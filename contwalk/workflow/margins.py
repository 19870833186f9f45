"""`contwalk margins`: how far a stored solution may be pushed, one state and sign at a time."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from contwalk.branch import Branch, SpecialPoint
from contwalk.errors import ContwalkError, StartError
from contwalk.numerics.threads import one_thread
from contwalk.storage.failures import failures_of, refuse_existing
from contwalk.storage.journal import Journal
from contwalk.storage.trajectory import Margins, write_margins
from contwalk.studies.margins.solution import Solution, solution_at
from contwalk.studies.margins.survival import BEYOND, MEANINGS, SURVIVED, Rule
from contwalk.workflow.made_with import made_with
from contwalk.workflow.many_runs import Executor, in_order
from contwalk.workflow.margin_rays import Ray, Study, row_of, survival_of
from contwalk.workflow.run_file.margins import MarginsFile
from contwalk.workflow.stored.points import branch_of, place_of

PERIODS = 20.0  # to survive, where nobody says
# A smooth motion that nothing ends must have come back so near, in units of the magnitudes.
RETURNS = 0.1
# Local errors of motions where nobody says: they must not move a border by its own accuracy.
TOLERANCE, SHARE, LEAST_TOLERANCE = 1e-8, 1e-4, 1e-13


@dataclass(frozen=True, eq=False)
class MarginsResult:
    """What was found.

    Parameters
    ----------
    rows : list of dict
        A row for each ray: instant, fraction, state, sign, border (NaN where none was met), several, borders,
        ends (the reason code of what is beyond the border), simulations.
    notes : list of str
        What was left out, and why.
    files, figures : list of Path
    """

    rows: list[dict[str, Any]]
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    figures: list[Path] = field(default_factory=list)


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
    database, table, picture = (run.file(f"margins.{suffix}") for suffix in ("h5", "csv", "png"))
    journal = run.file("margins.journal")
    refuse_existing([database, table, *([picture] if figures else [])], force)
    _check_journal(journal, resume or force)
    study, notes = _study(run)
    rays, left_out = _rays(run, study.solution)
    notes += left_out
    _check_unpushed(study)
    with Journal(journal, {"study": study.key, "rays": [asdict(ray) for ray in rays]}, resume) as kept:
        rows = list(kept.kept)
        rest = [(study, ray) for ray in rays[len(rows) :]]
        for row in in_order(row_of, rest, jobs, executor):
            kept.add(row)
            rows.append(row)
            if progress is not None:
                progress(len(rows), len(rays))
        notes += _notes_of(rows)
        write_margins(database, _to_store(run, study.solution, rows, notes))
        _write_table(rows, table)
        drawn = [_drawn(run, study.solution, rows, picture)] if figures else []
        kept.remove()
    return MarginsResult(rows, notes, [database, table], drawn)


def _check_journal(journal: Path, taken_up: bool) -> None:
    """Refuse to go over what a study that was stopped has left."""
    if journal.exists() and not taken_up:
        raise ContwalkError(
            f"{journal} holds what a study that was stopped has found.",
            "Go on with --resume, or begin anew with --force.",
        )


def _to_store(
    run: MarginsFile, solution: Solution, rows: Sequence[dict[str, Any]], notes: Sequence[str]
) -> Margins:
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
            "parameters": solution.parameters,
            "notes": list(notes),
            "provenance": _provenance(run),
        },
    )


def _provenance(run: MarginsFile) -> dict[str, str]:
    """As of other files, without the hour: files of the same study are the same to the last bit."""
    made = made_with(run.path, run.system_reference, run.system)
    return {name: value for name, value in made.items() if name != "time"}


def _study(run: MarginsFile) -> tuple[Study, list[str]]:
    """The study, and what is to be said of it.

    Raises
    ------
    ContwalkError
    """
    from contwalk.storage import open_database

    wanted, system = run.margins, run.system
    notes = []
    with open_database(run.database) as db:
        branch = branch_of(db, run.database, wanted.of.point, system)
        stored = str(db.header.provenance.get("plugin_sha256", system.source))
        if stored != system.source:
            notes.append("The system's files have changed since the database was computed.")
        point = place_of(branch, run.database, wanted.of.point)
        fractions = (
            tuple(k / wanted.instants for k in range(wanted.instants))
            if isinstance(wanted.instants, int)
            else wanted.instants
        )
        if branch.info.problem == "equilibrium":
            fractions = (0.0,)
        _check_stable(branch, point, wanted.of.point)
        solution = solution_at(system, branch, point, fractions)
    for name, value in run.parameters.items():
        if solution.parameters[name] != value:
            raise StartError(
                f"{run.path} sets {name} to {value:.12g}; at {wanted.of.point} of {run.database} it is "
                f"{solution.parameters[name]:.12g}.",
                "Margins are of a stored solution: leave the parameter out, or name another point.",
            )
    return (
        Study(
            reference=run.system_reference,
            model=dict(run.model),
            base=str(run.path.parent.resolve()),
            source=system.source,
            solution=solution,
            rule=_rule(run, solution),
            accuracy=wanted.accuracy,
            scan=wanted.scan,
            farthest=wanted.farthest,
        ),
        notes,
    )


def _check_stable(branch: Branch, point: SpecialPoint | int, name: str) -> None:
    """Refuse what is unstable on both sides: any push along its unstable direction is lost in time."""
    if isinstance(point, int):
        unstable = int(branch.points["unstable"][point])
    else:
        unstable = min(point.unstable_before, point.unstable_after)
    if unstable:
        raise StartError(
            f"{name} is unstable in {unstable} direction{'s' * (unstable > 1)}: every push that has a share "
            "in them is lost sooner or later.",
            "Margins are of stable motions: name a point where `contwalk show` counts 0 unstable directions.",
        )


def _rule(run: MarginsFile, solution: Solution) -> Rule:
    survive, wanted, system = run.margins.survive, run.margins, run.system
    if np.isnan(solution.period) and survive.time is None:
        raise StartError(
            f"{run.path}: the point {wanted.of.point} is an equilibrium, which has no period.",
            "Say for how long a motion must survive: survive: {time: 100}.",
        )
    duration = survive.time if survive.time is not None else (survive.periods or PERIODS) * solution.period
    sequence = survive.sequence == "kept" and bool(solution.cycle)
    judged = system.fallen is not None or sequence
    returns = survive.returns if survive.returns is not None else None if judged else RETURNS
    tolerance = wanted.tolerance or max(min(TOLERANCE, SHARE * wanted.accuracy), LEAST_TOLERANCE)
    return Rule(float(duration), sequence, returns, tolerance, wanted.method)


def _rays(run: MarginsFile, solution: Solution) -> tuple[list[Ray], list[str]]:
    """The rays in their order, and which states are left out, and why."""
    names, wanted = run.system.state_names, run.margins.states
    chosen = [name for name in names if wanted == ("all",) or name in wanted]
    notes = []
    neutral = [name for name in chosen if name in solution.neutral]
    if neutral:
        notes.append(f"Left out as neutral, so that no push along them is lost: {', '.join(neutral)}.")
    rays: list[Ray] = []
    for number, instant in enumerate(solution.instants):
        there = [name for name in chosen if name not in neutral and names.index(name) in instant.exists]
        absent = [name for name in chosen if names.index(name) not in instant.exists]
        if absent:
            notes.append(
                f"Left out at instant {number}, as they do not exist in mode '{instant.mode}': "
                f"{', '.join(absent)}."
            )
        rays += [
            Ray(len(rays) + 2 * k + j, number, name, s)
            for k, name in enumerate(there)
            for j, s in enumerate((1, -1))
        ]
    if not rays:
        raise ContwalkError("No state is left to be pushed.", " ".join(notes))
    return rays, notes


def _check_unpushed(study: Study) -> None:
    survival = survival_of(study)
    for number, instant in enumerate(study.solution.instants):
        ended = survival.verdict(instant, np.zeros(len(survival.system.states)))
        if ended != SURVIVED:
            raise ContwalkError(
                f"The motion does not survive unpushed from instant {number}: {MEANINGS[ended]} ({ended}).",
                "Margins are of stable motions. Name another point, or ask for less: survive: {periods: 5}.",
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
        notes.append(f"On {free} of {len(rows)} rays no border was met as far as was looked (farthest).")
    beyond = Counter(row["ends"] for row in rows)[BEYOND]
    if beyond:
        notes.append(f"On {beyond} rays the border is where the push carries a guard past zero.")
    return notes


COLUMNS = ("instant", "fraction", "state", "sign", "border", "several", "ends", "simulations", "borders")


def _write_table(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """A line for each ray, all digits kept."""
    with failures_of(path, "create"), path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(_cells(rows))


def _cells(rows: Sequence[dict[str, Any]]) -> Iterator[list[object]]:
    for row in rows:
        given = {
            **row,
            "border": "" if row["border"] is None else row["border"],
            "several": "true" if row["several"] else "false",
            "borders": " ".join(repr(border) for border in row["borders"]),
        }
        yield [given[name] for name in COLUMNS]


def _drawn(run: MarginsFile, solution: Solution, rows: Sequence[dict[str, Any]], path: Path) -> Path:
    from contwalk import plotting

    fractions = [instant.fraction for instant in solution.instants]
    figure = plotting.plot_margins(rows, fractions, units=plotting.units_of(run.system))
    return plotting.save(figure.axes[0], path)
