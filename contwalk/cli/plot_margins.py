"""`contwalk plot X_margins.h5`: the figure of margins from their own file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.storage.trajectory import Margins
    from contwalk.system import System


def plot(path: str, output: str, trust: bool) -> None:
    """Draw the margins that a file holds.

    Raises
    ------
    ContwalkError
        If it holds none, or the figure cannot be written.
    """
    from contwalk.cli.entry import say
    from contwalk.storage.trajectory import read_margins
    from contwalk.workflow.margins_picture import drawn_margins

    margins = read_margins(path)
    if not margins.rows:
        raise ContwalkError(
            f"{path} holds no margins, only a basin.",
            "contwalk margins draws the basin. Beside it states are pushed where the run file gives states.",
        )
    left_out = drawn_margins(margins, _system(margins, Path(path), trust), Path(output))
    if left_out:
        say(f"note: {left_out}")
    click.echo(f"Wrote {output}.")


def _system(margins: Margins, path: Path, trust: bool) -> System | None:
    """The system, which draws the machine; where it cannot be had, that is said on stderr."""
    from contwalk.cli.entry import say
    from contwalk.storage.stored_system import system_of_run

    header = margins.header
    try:
        stored = system_of_run(header["provenance"], header.get("model", {}), margins.system, path, trust)
    except ContwalkError as error:
        say(f"Not shown: the machine where it is pushed. {error}")
        return None
    if stored.changed:
        say(f"warning: {stored.changed} What is drawn with it may differ from what was pushed.")
    return stored.system
