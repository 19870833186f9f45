"""`contwalk continue`: compute the study that a run file describes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from contwalk.cli.study_call import StudyCall, study_command

if TYPE_CHECKING:
    from contwalk.branch import Branch
    from contwalk.workflow.run_file.reading import RunFile
    from contwalk.workflow.runner import RunResult


@study_command(
    "continue",
    "a database",
    output="The database to write, instead of the run file's output.",
    resume="Go on with a database that an earlier run has begun.",
    force="Replace a database that exists.",
    jobs="Processes that branches are computed in (1); auto: one for each processor.",
    no_figures="Do not draw the figures of the run file.",
)
@click.option("--strict", is_flag=True, help="Exit with 1 if a special point could not be located.")
def command(call: StudyCall, *, strict: bool) -> int:
    """Compute the study that the run file FILE describes.

    Every point is stored when it is found: after Ctrl-C or a crash, --resume goes on from there. Several
    values are set with several options: --set parameters.c=0.9 --set continue.range=[1,6]. With --jobs the
    branches of a study are computed in several processes at once; what is stored is the same for any number.

    Exit codes: 0; 1 if a branch failed, or the disk is full; 2 for bad input, with nothing written; 130
    after Ctrl-C, 143 after SIGTERM.
    """
    from contwalk.cli.collector import loaded
    from contwalk.cli.entry import say
    from contwalk.cli.progress import reporter_for
    from contwalk.errors import WriteError
    from contwalk.workflow.cluster import executor_at
    from contwalk.workflow.run_file.reading import read_run_file
    from contwalk.workflow.runner import run

    run_file = read_run_file(*call.given)
    loaded()
    again = call.again(strict=strict)
    reporter = reporter_for(run_file.range, call.quiet)

    def computed() -> RunResult:
        with executor_at(call.scheduler) as executor, reporter:
            return run(run_file, **call.kept, reporter=reporter, jobs=call.jobs, executor=executor)

    def work() -> int:
        try:
            result = computed()
        except WriteError as error:
            say(f"error: {error.sentence} {error.remedy.partition('contwalk')[0]}\n  {again}")
            return error.exit_code
        if not call.quiet:
            _print(run_file, result, reporter.notes)
        failed = _failures(result.branches, strict)
        if result.interrupted:
            raise KeyboardInterrupt
        return 1 if failed else 0

    return call.interruptible(work, run_file.output, again)


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
