"""`contwalk sample`: many motions from drawn states and parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from contwalk.cli.bar import bar
from contwalk.cli.going_on import check_resume, command_to_resume, computing, say_interrupted
from contwalk.cli.jobs_option import jobs_option
from contwalk.cli.scheduler_option import check_one, scheduler_option

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Console

    from contwalk.workflow.run_file.sample import SampleFile
    from contwalk.workflow.sampling import SampleResult


@click.command("sample")
@click.argument("file")
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file.")
@click.option("--output", metavar="X.h5", help="Base of the files' names, instead of the run file's output.")
@jobs_option("Motions at once (1); auto: one for each processor. The result is the same.", 1)
@click.option("--threads", type=click.IntRange(1, 1024), hidden=True, help="Another name of --jobs.")
@scheduler_option()
@click.option("--resume", is_flag=True, help="Go on with a sampling that was stopped.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option("--no-figures", is_flag=True, help="Draw no figures.")
@click.pass_context
def command(
    context: click.Context,
    *,
    file: str,
    overrides: tuple[str, ...],
    output: str | None,
    jobs: int,
    threads: int | None,
    scheduler: str | None,
    resume: bool,
    force: bool,
    quiet: bool,
    no_figures: bool,
) -> int:
    """Draw states and parameters as the run file FILE says, and measure a motion from each.

    With output X.h5 it writes X_samples.h5, X_samples.csv and X_histogram.png; what is found is kept in
    X_samples.journal until then.

    Exit codes: 0; 1 if a motion could not be integrated; 2 for bad input, with nothing written; 130 after
    Ctrl-C, 143 after SIGTERM.
    """
    threads = threads or jobs
    check_one(context, threads, scheduler)
    check_resume(context, resume, force, "what a sampling has found")
    from contwalk.cli.entry import say
    from contwalk.cli.terminal import console
    from contwalk.cli.termination import termination
    from contwalk.cli.words import plural
    from contwalk.workflow.cluster import executor_at
    from contwalk.workflow.run_file.sample import read_sampling
    from contwalk.workflow.sampling import sample

    run = read_sampling(file, overrides, output)

    def found(progress: Callable[[int], None] | None) -> SampleResult:
        with executor_at(scheduler) as executor:
            return sample(
                run,
                threads=threads,
                executor=executor,
                resume=resume,
                force=force,
                figures=not no_figures,
                progress=progress,
            )

    flags = {"--quiet": quiet, "--no-figures": no_figures}
    again = command_to_resume("sample", file, overrides, output, computing(threads, scheduler), flags)
    with termination() as terminated:
        try:
            with bar("motions", run.sampling.count, quiet) as move:
                result = found(move and (lambda done: move(advance=done)))
        except KeyboardInterrupt:
            return say_interrupted(again if run.file("samples.journal").exists() else None, terminated)
    if not quiet:
        _print(console(), run, result)
    if result.summary.failed:
        say(f"error: {plural(result.summary.failed, 'motion')} could not be integrated; see the table.")
        return 1
    return 0


def _print(out: Console, run: SampleFile, result: SampleResult) -> None:
    from contwalk.cli.terminal import line, table
    from contwalk.cli.words import choices

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
    for path in result.files:
        line(out, f"file:   {path}")
    for path in result.figures:
        line(out, f"figure: {path}")
