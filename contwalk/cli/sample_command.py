"""`contwalk sample`: many motions from drawn states and parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from contwalk.cli.bar import bar
from contwalk.cli.study_call import StudyCall, study_command

if TYPE_CHECKING:
    from rich.console import Console

    from contwalk.workflow.run_file.sample import SampleFile
    from contwalk.workflow.sampling import SampleResult


@study_command(
    "sample",
    "what a sampling has found",
    output="Base of the files' names, instead of the run file's output.",
    resume="Go on with a sampling that was stopped.",
    force="Replace files that exist.",
    jobs="Motions at once (1); auto: one for each processor. The result is the same.",
    no_figures="Draw no figures.",
)
@click.option("--threads", type=click.IntRange(1, 1024), hidden=True, help="Another name of --jobs.")
def command(call: StudyCall, *, threads: int | None) -> int:
    """Draw states and parameters as the run file FILE says, and measure a motion from each.

    With output X.h5 it writes X_samples.h5, X_samples.csv and X_histogram.png; what is found is kept in
    X_samples.journal until then.

    Exit codes: 0; 1 if a motion could not be integrated; 2 for bad input, with nothing written; 130 after
    Ctrl-C, 143 after SIGTERM.
    """
    if threads is not None:
        call = replace(call, jobs=threads)
    from contwalk.cli.entry import say
    from contwalk.cli.terminal import console
    from contwalk.number_words import plural
    from contwalk.workflow.cluster import executor_at
    from contwalk.workflow.run_file.sample import read_sampling
    from contwalk.workflow.sampling import sample

    run = read_sampling(*call.given)

    def work() -> int:
        with bar("motions", run.sampling.count, call.quiet) as move, executor_at(call.scheduler) as executor:
            progress = move and (lambda done: move(advance=done))
            result = sample(run, threads=call.jobs, executor=executor, **call.kept, progress=progress)
        if not call.quiet:
            _print(console(), run, result)
        if result.summary.failed:
            say(f"error: {plural(result.summary.failed, 'motion')} could not be integrated; see the table.")
            return 1
        return 0

    return call.interruptible(work, run.file("samples.journal"), call.again())


def _print(out: Console, run: SampleFile, result: SampleResult) -> None:
    from contwalk.cli.terminal import line, table
    from contwalk.number_words import choices

    chosen, wanted, summary = choices(run.system.model), run.sampling.measure, result.summary
    line(out, run.system.name + (f" ({chosen})" if chosen else ""), style="bold")
    drawn = ", ".join(result.samples.drawn)
    line(
        out,
        f"{wanted.crossing} {wanted.direction} crossing of {wanted.observable} through {wanted.level.text}",
    )
    line(out, f"drawn: {drawn}; seed {run.sampling.seed}; in {result.samples.measured}")
    rows = [
        ["samples", str(summary.count)],
        ["mean", f"{summary.mean:.8g}"],
        ["standard error", f"{summary.error:.3g}"],
        ["standard deviation", f"{summary.deviation:.8g}"],
        ["never settled", str(summary.never_settled)],
        ["never crossed", str(summary.never_crossed)],
        ["failed", str(summary.failed)],
    ]
    if summary.without_equilibrium:
        name = run.sampling.settled.equilibrium
        rows.append([f"no equilibrium {name} there", str(summary.without_equilibrium)])
    table(out, ["", ""], rows, indent=4, right=(1,))
    out.print()
    if result.note:
        line(out, f"note: {result.note}")
    for path in result.files:
        line(out, f"file:   {path}")
    for path in result.figures:
        line(out, f"figure: {path}")
