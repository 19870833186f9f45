"""`contwalk examples`: run files that are installed, to look at and to copy."""

from __future__ import annotations

from pathlib import Path

import click

from contwalk.cli.terminal import console, line, table


@click.command("examples")
@click.argument("name", required=False)
@click.option("--force", is_flag=True, help="Replace files that exist.")
def command(name: str | None, force: bool) -> None:
    """List the run files that are installed, or copy the one of NAME to the current directory.

    A run file that begins at a solution of another one is copied with that one. A file that exists is an
    error without --force.
    """
    if name is None:
        if force:
            raise click.UsageError("--force belongs to a NAME.")
        _list()
    else:
        _copy(name, force)


def _list() -> None:
    from contwalk.workflow.examples import examples

    out, found = console(), examples()
    if not found:
        line(out, "No package that is installed offers run files. contwalk new my_machine writes one.")
        return
    table(out, ["example", "about"], [[example.name, example.about] for example in found.values()])
    out.print()
    line(out, "next: contwalk examples NAME")


def _copy(name: str, force: bool) -> None:
    from contwalk.files.drafts import written
    from contwalk.storage.failures import creating, refuse_existing
    from contwalk.workflow.examples import with_what_it_needs

    copied = with_what_it_needs(name)
    refuse_existing([Path(example.file) for example in copied], force)
    for example in copied:
        with creating(Path(example.file)), written(Path(example.file), "t", new=not force) as file:
            file.write(example.text)
    click.echo(f"Wrote {', '.join(example.file for example in copied)}. Next, in this order:")
    for example in copied:
        # Of those that it begins at only the database is needed.
        needed = example.commands if example is copied[-1] else example.commands[:1]
        for word in needed:
            click.echo(f"    contwalk {word} {example.file}")
