"""`contwalk explore`: a database as a page to look at."""

from __future__ import annotations

from pathlib import Path

import click

from contwalk.cli.bar import bar
from contwalk.cli.stored_system import trust_option


@click.command("explore")
@click.argument("db")
@click.option(
    "-o", "output", metavar="FILE", help="The page to write; DB.html in the current folder by default."
)
@click.option("--force", is_flag=True, help="Replace a file that exists.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@trust_option
def command(*, db: str, output: str | None, force: bool, quiet: bool, trust: bool) -> None:
    """Write the database DB as a page of HTML: one file, which asks no network for anything.

    It shows the diagram and, of each point that one clicks on, everything that `contwalk show` does, and
    the motion, which the system integrates once more while the page is made.
    """
    from contwalk.cli.entry import say
    from contwalk.explorer import explored
    from contwalk.files.drafts import written
    from contwalk.storage import open_database
    from contwalk.storage.failures import creating, refuse_existing

    path = Path(output if output is not None else f"{Path(db).stem}.html")
    refuse_existing([path], force)
    with open_database(db) as database, bar("points", None, quiet) as move:
        progress = (lambda done, number: move(completed=done, total=number)) if move else None
        found = explored(database, trust, *([progress] if progress else []))
    for sentence in found.missing:
        say(sentence)
    with creating(path), written(path) as stream:
        stream.write(found.page.encode("utf-8"))
    if not quiet:
        click.echo(f"Wrote {path}: {len(found.page.encode('utf-8')) / 1e6:.2f} MB. Open it with a browser.")
