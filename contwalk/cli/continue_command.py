"""`contwalk continue`: compute the study that a run file describes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from contwalk.cli.going_on import check_resume, command_to_resume, computing, say_interrupted
from contwalk.cli.jobs_option import jobs_option
from contwalk.cli.scheduler_option import check_one, scheduler_option

if TYPE_CHECKING:
    from contwalk.branch import Branch
    from contwalk.workflow.run_file.reading import RunFile
    from contwalk.workflow.runner import RunResult


@click.command("continue")
@click.argument("file")
@click.option("--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file.")
@click.option("--output", metavar="X.h5", help="The database to write, instead of the run file's output.")
@click.option("--resume", is_flag=True, help="Go on with a database that an earlier run has begun.")
@click.option("--force", is_flag=True, help="Replace a database that exists.")
@jobs_option("Processes that branches are walked in (1); auto: one for each processor.", 1)
@scheduler_option()
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option("--no-figures", is_flag=True, help="Do not draw the figures of the run file.")
@click.option("--strict", is_flag=True, help="Exit with 1 if a special point could not be located.")
@click.pass_context
def command(
    context: click.Context,
    *,
    file: str,
    overrides: tuple[str, ...],
    output: str | None,
    resume: bool,
    force: bool,
    jobs: int,
    scheduler: str | None,
    quiet: bool,
    no_figures: bool,
    strict: bool,
) -> int:
    """Compute the study that the run file FILE describes.

    Every point is stored when it is found: after Ctrl-C or a crash, --resume goes on from there. Several
    values are set with several options: --set parameters.c=0.9 --set continue.range=[1,6]. With --jobs the
    branches of a study are walked in several processes at once; what is stored is the same for every number.

    Exit codes: 0; 1 if a branch failed, or the disk is full; 2 for bad input, with nothing written; 130
    after Ctrl-C, 143 after SIGTERM.
    """
    check_resume(context, resume, force, "a database")
    check_one(context, jobs, scheduler)
    from contwalk.cli.collector import loaded
    from contwalk.cli.entry import say
    from contwalk.cli.progress import reporter_for
    from contwalk.cli.termination import termination
    from contwalk.errors import WriteError
    from contwalk.workflow.cluster import executor_at
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.runner import run

    run_file = read_run_file(file, overrides, output)
    loaded()
    flags = {"--no-figures": no_figures, "--strict": strict, "--quiet": quiet}
    again = command_to_resume("continue", file, overrides, output, computing(jobs, scheduler), flags)
    reporter = reporter_for(run_file.range, quiet)
    with termination() as terminated:
        try:
            with executor_at(scheduler) as executor, reporter:
                kept = {"resume": resume, "force": force, "figures": not no_figures}
                result = run(run_file, **kept, reporter=reporter, jobs=jobs, executor=executor)
        except KeyboardInterrupt:  # outside the computing itself; what was found is stored all the same
            return say_interrupted(again if run_file.output.exists() else None, terminated)
        except WriteError as error:
            say(f"error: {error.sentence} {error.remedy.partition('contwalk')[0]}\n  {again}")
            return error.exit_code
    if not quiet:
        _print(run_file, result, reporter.notes)
    failed = _failures(result.branches, strict)
    if result.interrupted:
        return say_interrupted(again, terminated)
    return 1 if failed else 0


def _print(run_file: RunFile, result: RunResult, notes: Sequence[str]) -> None:
    from contwalk.cli.summary import print_branches, print_notes, print_where
    from contwalk.cli.terminal import console
    from contwalk.plotting.quantities import units_of

    out = console()
    units = units_of(run_file.system)
    every = result.branches
    print_branches(out, run_file.system.name, run_file.model, every, every, units, errors_follow=True)
    print_notes(out, notes)
    print_where(out, result.path, result.figures, result.branches)


def _failures(branches: Sequence[Branch], strict: bool) -> bool:
    """Say on stderr what failed; whether anything did."""
    from contwalk.cli.entry import say

    failed = [branch for branch in branches if branch.outcome.status == "failed"]
    for branch in failed:
        say(f"error: branch {branch.name} failed ({branch.outcome.reason}): {branch.outcome.message}")
    unlocated = [
        f"{branch.name}/{point.name}"
        for branch in branches
        for point in branch.special_points
        if point.status == "unlocated"
    ]
    if unlocated and strict:
        say(
            f"error: {', '.join(unlocated)} could not be located, which --strict does not allow. "
            "See the notes of these points, or take smaller steps with --set engine.max_step=0.02."
        )
    return bool(failed) or (strict and bool(unlocated))
