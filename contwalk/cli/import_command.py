"""`contwalk import`: a model that exists, made a plugin."""

from __future__ import annotations

from pathlib import Path

import click

from contwalk.cli.new_files import relative_to_run_file, write_new


@click.command("import")
@click.argument("model", type=click.Path(path_type=Path))
@click.option(
    "-o", "output", metavar="FILE", help="The plugin to write; MODEL's name with .py by default, here."
)
@click.option("--run", "run_file", metavar="FILE", help="Write a run file for it as well.")
def command(model: Path, output: str | None, run_file: str | None) -> None:
    """Write the plugin of MODEL: an XPPAUT .ode file, SBML (.xml), or a .txt file of equations.

    What cannot be translated is named with its line, and nothing is written. Files that exist are not
    replaced.
    """
    from contwalk.workflow.importing import imported, name_of

    found = imported(model)
    plugin = Path(output or f"{name_of(model)}.py")
    files = {plugin: found.plugin}
    if run_file is not None:
        run = Path(run_file)
        files[run] = found.run_file(relative_to_run_file(str(plugin), run))
    write_new(files)
    for note in found.model.notes:
        click.echo(f"note: {note}", err=True)
    names = " and ".join(str(path) for path in files)
    go_on = f"contwalk continue {run_file}" if run_file else f"contwalk init ./{plugin}"
    click.echo(f"Wrote {names}. Next: {go_on}")
