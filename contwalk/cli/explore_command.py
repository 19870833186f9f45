"""`contwalk explore`: a database as a page to look at."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from contwalk.cli.bar import bar
from contwalk.cli.stored_system import trust_option
from contwalk.errors import ContwalkError

RUN_FILES = (".yaml", ".yml")


@click.command("explore")
@click.argument("db", metavar="DB|RUNFILE")
@click.option(
    "-o", "output", metavar="FILE", help="The page to write; DB.html in the current folder by default."
)
@click.option("--watch", is_flag=True, help="Serve the page on this machine alone while a run writes DB.")
@click.option("--port", type=click.IntRange(1, 65535), help="The port of --watch; a free one by default.")
@click.option("--force", is_flag=True, help="Replace a file that exists.")
@click.option("--quiet", is_flag=True, help="Print errors only.")
@trust_option
@click.pass_context
def command(
    context: click.Context,
    *,
    db: str,
    output: str | None,
    watch: bool,
    port: int | None,
    force: bool,
    quiet: bool,
    trust: bool,
) -> int:
    """Write the database DB, or a file of margins, as a page of HTML: one file, which asks no network.

    It shows the diagram and, of each point that one clicks on, everything that `contwalk show` does, and
    the motion, which the system integrates once more while the page is made. A run file is computed first,
    as by `contwalk continue`, and its page is opened.

    With --watch the page is served on 127.0.0.1 while a run writes the database, and grows; nothing is
    written.
    """
    if watch:
        if output is not None:
            raise ContwalkError("--watch serves the page and writes none.", "Leave -o out.")
        _serve(Path(db), port or 0, trust)
        return 0
    if port is not None:
        raise ContwalkError("--port belongs to --watch.", "Give both, or neither.")
    code = 0
    if is_run_file := Path(db).suffix.lower() in RUN_FILES:
        code, db = _computed(context, db, force, quiet)
    path = Path(output if output is not None else f"{Path(db).stem}.html")
    _write(db, path, force, quiet, trust or is_run_file)
    if is_run_file:
        import webbrowser

        webbrowser.open(path.resolve().as_uri())
    return code


def _computed(context: click.Context, file: str, force: bool, quiet: bool) -> tuple[int, str]:
    """Compute a study as `contwalk continue` does; the exit code, and the database."""
    from contwalk.cli.continue_command import command as continued
    from contwalk.workflow.run_file.reading import read_run_file

    database = str(read_run_file(file).output)
    given = {"file": file, "overrides": (), "output": None, "jobs": 1, "scheduler": None, "resume": False}
    given |= {"force": force, "quiet": quiet, "no_figures": True, "strict": False}
    return int(context.invoke(continued, **given) or 0), database


def _write(db: str, path: Path, force: bool, quiet: bool, trust: bool) -> None:
    from contwalk.cli.entry import say
    from contwalk.explorer import explored, margins_page
    from contwalk.files.drafts import written
    from contwalk.storage import open_database
    from contwalk.storage.failures import creating, refuse_existing
    from contwalk.storage.trajectory import is_of_margins

    refuse_existing([path], force)
    if is_of_margins(db):
        page, missing = margins_page(Path(db), trust)
    else:
        with open_database(db) as database, bar("points", None, quiet) as move:
            progress = (lambda done, number: move(completed=done, total=number)) if move else None
            found = explored(database, trust, *([progress] if progress else []))
        page, missing = found.page, found.missing
    for sentence in missing:
        say(sentence)
    text = page.encode("utf-8")
    with creating(path), written(path) as stream:
        stream.write(text)
    if not quiet:
        click.echo(f"Wrote {path}: {len(text) / 1e6:.2f} MB. Open it with a browser.")


def _serve(path: Path, port: int, trust: bool) -> None:
    """Until Ctrl-C."""
    from contwalk.explorer.watching import Watched, server_of

    watched = Watched(path, trust)
    watched.page()
    server, address = server_of(watched, port)
    click.echo(f"Open {address} with a browser; Ctrl-C ends it.")
    sys.stdout.flush()
    with server:
        server.serve_forever(poll_interval=0.2)
