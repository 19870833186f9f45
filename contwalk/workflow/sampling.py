"""`contwalk sample`: many motions from drawn states and parameters, measured, as files and figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contwalk.flow.ensemble.sampling import BATCH, Measured
from contwalk.numerics.threads import one_thread
from contwalk.storage.csv_files import write_csv
from contwalk.storage.journal import Journal, check_still_new, check_stopped, going_on_from
from contwalk.workflow.kept_motions import KeptMotions
from contwalk.workflow.machine import made_elsewhere, versions_and_processor
from contwalk.workflow.made_with import made_with_but_the_hour
from contwalk.workflow.many_runs import Executor, Runs
from contwalk.workflow.run_file.sample import SampleFile
from contwalk.workflow.sampled_motions import Draws, Found, drawn, level_guard, measured, measured_elsewhere
from contwalk.workflow.study_text import StudyText

if TYPE_CHECKING:
    from contwalk.storage.trajectory import Samples

# Motions to a task for another process: whole batches, some seconds' work where a motion takes milliseconds.
PART = 8 * BATCH


@dataclass(frozen=True)
class Summary:
    """What the samples say together.

    Parameters
    ----------
    count : int
        All samples.
    measured : int
        Those with a number; `mean`, `error` (standard error of the mean), `deviation` are theirs.
    never_settled : int
        Motions that did not come to rest in time. Their numbers count: the last crossing up to then.
    never_crossed : int
        Those that did not cross the level. Where the observable was beyond it all along, the time is 0.
    failed : int
        Those that could not be integrated to their end.
    without_equilibrium : int
        Those drawn where the equilibrium does not exist.
    """

    count: int
    measured: int
    mean: float
    error: float
    deviation: float
    never_settled: int
    never_crossed: int
    failed: int
    without_equilibrium: int


@dataclass(frozen=True, eq=False)
class SampleResult:
    """What a sampling left behind; `note` says that it was begun on another kind of machine, if it was."""

    samples: Any
    summary: Summary
    files: list[Path]
    figures: list[Path]
    note: str = ""


@one_thread()
def sample(
    run: SampleFile,
    *,
    threads: int | None = None,
    executor: Executor | None = None,
    resume: bool = False,
    force: bool = False,
    figures: bool = True,
    progress: Callable[[int], None] | None = None,
) -> SampleResult:
    """Compute and measure the motions that a run file describes, and write what was found.

    What is computed stands in a journal beside the files until they are written.

    Parameters
    ----------
    run : SampleFile
    threads : int, optional
        As many as there are processors by default. The result does not depend on it.
    executor : Executor, optional
        What computes instead, such as a pool or a cluster's client: anything with `map`.
    resume : bool
        Go on with a sampling that was stopped.
    force : bool
        Replace files that exist.
    figures : bool
        Draw the figures too.
    progress : callable, optional
        Told, now and then, how many motions more are done.

    Raises
    ------
    ContwalkError
        For bad input, before anything is written; where a sampling to go on with is another one.
    """
    from contwalk.storage.trajectory import write_samples

    database, table = run.file("samples.h5"), run.file("samples.csv")
    named = (figure.options.get("file") for figure in run.figures)
    pictures = [run.output.parent / name if name else run.file("histogram.png") for name in named]
    pictures = list(dict.fromkeys(pictures)) if figures else []
    journal = run.file("samples.journal")
    check_stopped(journal, [database, table, *pictures], resume, force)
    draws = drawn(run, range(run.sampling.count))
    with Journal(journal, _identity(run, draws), resume, versions_and_processor()) as on_disk:
        check_still_new(on_disk, [database, table, *pictures], force)
        kept = KeptMotions(on_disk, run.sampling.count)
        try:
            _compute(run, draws, kept, threads, executor, progress)
        finally:  # after an interruption too
            kept.write()
        samples = _samples(run, draws, kept.found)
        summary = _summary(samples, kept.found)
        with going_on_from(journal):
            write_samples(database, samples)
            _write_table(samples, table)
            for path in pictures:
                _draw(run, samples, summary, path)
        on_disk.remove()
    return SampleResult(samples, summary, [database, table], pictures, made_elsewhere(*on_disk.made))


def _identity(run: SampleFile, draws: Draws) -> dict[str, Any]:
    """What the motions follow from."""
    return {
        "plugin": run.system.source,
        "start": draws.state.tolist(),
        "parameters": draws.base,
        "sample": repr(run.sampling),
    }


def _compute(
    run: SampleFile,
    draws: Draws,
    kept: KeptMotions,
    threads: int | None,
    executor: Executor | None,
    progress: Callable[[int], None] | None,
) -> None:
    """The motions that are not known yet, in threads or by an executor."""
    missing = kept.missing

    def keep(numbers: Sequence[int], found: Found) -> None:
        kept.add(numbers, found)
        if progress is not None:
            progress(len(numbers))

    if progress is not None and len(missing) < run.sampling.count:
        progress(run.sampling.count - len(missing))
    if not missing:
        return
    if executor is None:
        measured(
            run,
            draws.of(missing),
            threads,
            lambda places, found: keep(missing[places.start : places.stop], found),
        )
        return
    parts = [missing[first : first + PART] for first in range(0, len(missing), PART)]
    with Runs(measured_elsewhere, StudyText.of(run), executor=executor) as runs:
        for numbers, found in zip(parts, runs.in_order(parts), strict=True):
            keep(numbers, found)


def _samples(run: SampleFile, draws: Draws, found: Found) -> Samples:
    """What is stored."""
    from contwalk.storage.trajectory import Samples

    motions = found.motions
    return Samples(
        system=run.system.name,
        drawn=draws.names,
        measured=run.sampling.time_unit.name if run.sampling.time_unit else "time",
        draws=draws.values,
        values=_values(run, motions, draws) / draws.units,
        settled=_settled(motions),
        crossed=motions.crossed,
        ends=motions.ended_at / draws.units,
        header={
            "config": run.text,
            "overrides": list(run.overrides),
            "parameters": draws.base,
            "provenance": made_with_but_the_hour(run.path, run.system_reference, run.system),
        },
    )


def _settled(found: Measured) -> np.ndarray:
    from contwalk.flow.ensemble.sampling_records import FOUND, SETTLED

    return np.isin(found.ended, (SETTLED, FOUND))


def _failed(found: Measured) -> np.ndarray:
    from contwalk.flow.ensemble.sampling_records import GIVEN_UP, NOT_FINITE

    return np.isin(found.ended, (NOT_FINITE, GIVEN_UP))


def _values(run: SampleFile, found: Measured, draws: Draws) -> np.ndarray:
    """Instants of the crossings; NaN where there is none, 0 where the observable was beyond all along."""
    guard, last = level_guard(run), run.sampling.measure.crossing == "last"
    values = np.where(found.crossed, found.crossed_at, np.nan)
    for index in np.flatnonzero(~found.crossed) if last else ():
        value, rate, _ = guard(0.0, draws.starts[index], draws.parameters[index])
        if np.sign(value or rate) == guard.direction:
            values[index] = 0.0
    values[_failed(found)] = np.nan
    return values


def _summary(samples: Samples, found: Found) -> Summary:
    values = samples.values[np.isfinite(samples.values)]
    deviation = float(values.std(ddof=1)) if len(values) > 1 else math.nan
    failed = _failed(found.motions)
    return Summary(
        count=len(samples.values),
        measured=len(values),
        mean=float(values.mean()) if len(values) else math.nan,
        error=deviation / math.sqrt(len(values)) if len(values) else math.nan,
        deviation=deviation,
        never_settled=int((~samples.settled & ~failed).sum()),
        never_crossed=int((~samples.crossed).sum()),
        failed=int(failed.sum()),
        without_equilibrium=int((~found.there).sum()),
    )


def _write_table(samples: Samples, path: Path) -> None:
    """A line for each sample, all digits kept."""
    names = (*samples.drawn, samples.measured, "crossed", "settled", "ended")
    columns = (samples.values, samples.crossed, samples.settled, samples.ends)
    rows = zip(range(len(samples.draws)), samples.draws.tolist(), *(c.tolist() for c in columns), strict=True)
    write_csv(path, ["sample", *names], ([number, *drawn, *rest] for number, drawn, *rest in rows))


def _draw(run: SampleFile, samples: Samples, summary: Summary, path: Path) -> None:
    from contwalk import plotting

    values, wanted = samples.values[np.isfinite(samples.values)], run.sampling.measure
    way = "falls below" if wanted.direction == "falling" else "rises above"
    label = f"{wanted.crossing} time that {wanted.observable} {way} {wanted.level.text} ({samples.measured})"
    if len(values):
        plotting.save(plotting.plot_histogram(values, label=label, never_settled=summary.never_settled), path)
