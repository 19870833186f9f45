"""`contwalk init`: a run file to start from."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from contwalk.cli.model_option import model_of, model_option
from contwalk.cli.new_files import relative_to_run_file, write_new


@click.command("init")
@click.argument("system")
@click.option("-o", "output", metavar="FILE", help="The run file to write; SYSTEM.yaml by default.")
@model_option
def command(system: str, output: str | None, choices: Sequence[str]) -> None:
    """Write a commented run file for SYSTEM, an installed system or the path of a plugin file.

    The file runs as it stands, if the system declares a study or an equilibrium, or moves to an orbit from
    the state that is guessed. A file that exists is not replaced.
    """
    from contwalk.system import load_system
    from contwalk.system.loading import is_path
    from contwalk.workflow.run_file.template import starting_file

    loaded = load_system(system, model_of(choices))
    path = Path(output or f"{loaded.name}.yaml")
    reference = relative_to_run_file(system, path) if is_path(system) else system
    text = starting_file(loaded, reference)
    write_new({path: text})
    click.echo(f"Wrote {path}. Next: contwalk continue {path}")
