"""What a study of many runs is told about going on, and tells when it is interrupted."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from contwalk.cli.termination import Termination


def check_resume(context: click.Context, resume: bool, force: bool, what: str) -> None:
    """Refuse to go on with what is replaced; `what` is gone on with."""
    if resume and force:
        raise click.UsageError(
            f"--resume goes on with {what}, --force replaces it. Give one of them.", context
        )


def computing(jobs: int, scheduler: str | None) -> dict[str, str]:
    """The options that say what computes, where they are not as by default."""
    return {"--jobs": str(jobs)} if jobs != 1 else {"--scheduler": scheduler} if scheduler else {}


def command_to_resume(
    command: str,
    file: str,
    overrides: Sequence[str],
    output: str | None,
    options: Mapping[str, str],
    flags: Mapping[str, bool],
) -> str:
    """The command that goes on with a run."""
    words = ["contwalk", command, file]
    for override in overrides:
        words += ["--set", override]
    if output is not None:
        words += ["--output", output]
    for option, value in options.items():
        words += [option, value]
    return shlex.join([*words, "--resume", *[flag for flag, given in flags.items() if given]])


def say_interrupted(again: str | None, terminated: Termination) -> int:
    """Tell how to go on (None: nothing is stored yet); the exit code."""
    from contwalk.cli.entry import INTERRUPTED, TERMINATED, say

    word = "Terminated" if terminated.came else "Interrupted"
    say(f"{word}." if again is None else f"{word}; everything found is stored. Go on with:\n  {again}")
    return TERMINATED if terminated.came else INTERRUPTED
