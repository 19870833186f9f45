"""How a command that computes a study is called, and what such commands have in common."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from contwalk.cli.going_on import check_resume, command_to_resume, computing, say_interrupted
from contwalk.cli.jobs_option import jobs_option
from contwalk.cli.scheduler_option import check_one, scheduler_option

Command = Callable[..., Any]
_NAMES = ("file", "overrides", "output", "jobs", "scheduler", "resume", "force", "quiet", "no_figures")


@dataclass(frozen=True)
class StudyCall:
    """What a command that computes a study was given; see its options.

    Parameters
    ----------
    command : str
        Its name.
    file, overrides, output, jobs, scheduler, resume, force, quiet, no_figures
        As on the command line.
    """

    command: str
    file: str
    overrides: tuple[str, ...]
    output: str | None
    jobs: int
    scheduler: str | None
    resume: bool
    force: bool
    quiet: bool
    no_figures: bool

    def __post_init__(self) -> None:
        check_one(click.get_current_context(), self.jobs, self.scheduler)

    @property
    def given(self) -> tuple[str, tuple[str, ...], str | None]:
        """The run file, what is set in it, and the file that is written, as those who read run files ask."""
        return self.file, self.overrides, self.output

    @property
    def kept(self) -> dict[str, bool]:
        """What becomes of what there is, and whether figures are drawn."""
        return {"resume": self.resume, "force": self.force, "figures": not self.no_figures}

    def again(self, **flags: bool) -> str:
        """The command that goes on with this one, if further flags are as they are here."""
        own = {f"--{name}": given for name, given in flags.items()}
        options = computing(self.jobs, self.scheduler)
        flags = {"--no-figures": self.no_figures, **own, "--quiet": self.quiet}
        return command_to_resume(self.command, *self.given, options, flags)

    def interruptible(self, work: Callable[[], int], journal: Path, again: str) -> int:
        """The exit code of some work; interrupted, how to go on, if anything is in the journal."""
        from contwalk.cli.termination import termination

        with termination() as terminated:
            try:
                return work()
            except KeyboardInterrupt:  # outside the computing itself; what was found is stored all the same
                return say_interrupted(again if journal.exists() else None, terminated)


def study_command(
    command: str, what: str, *, output: str, resume: str, force: str, jobs: str, no_figures: str
) -> Callable[[Command], click.Command]:
    """A command that computes the study of a run file: its function is given the `StudyCall`.

    Parameters
    ----------
    command : str
        Its name.
    what : str
        What `--resume` goes on with.
    output, resume, force, jobs, no_figures : str
        Help of these options.
    """
    options: list[Callable[[Command], Command]] = [
        click.argument("file"),
        click.option(
            "--set", "overrides", metavar="KEY=VALUE", multiple=True, help="Set a value of the run file."
        ),
        click.option("--output", metavar="X.h5", help=output),
        click.option("--resume", is_flag=True, help=resume),
        click.option("--force", is_flag=True, help=force),
        jobs_option(jobs, 1),
        scheduler_option(),
        click.option("--quiet", is_flag=True, help="Print errors only."),
        click.option("--no-figures", is_flag=True, help=no_figures),
    ]

    def made(function: Command) -> click.Command:
        @functools.wraps(function)
        def asked(context: click.Context, **given: Any) -> int:
            check_resume(context, given["resume"], given["force"], what)
            call = StudyCall(command, **{name: given.pop(name) for name in _NAMES})
            code: int = function(call, **given)
            return code

        called: Command = click.pass_context(asked)
        for option in reversed(options):
            called = option(called)
        return click.command(command)(called)

    return made
