"""`contwalk export`: a database as tables."""

from __future__ import annotations

import click

from contwalk.printable import printable


@click.command("export")
@click.argument("db")
@click.option("--csv", "directory", metavar="DIR", required=True, help="The directory to write into.")
@click.option("--force", is_flag=True, help="Replace tables that exist.")
def command(db: str, directory: str, force: bool) -> None:
    """Write the database DB as CSV tables into the directory DIR.

    branches.csv, special_points.csv, and one table per branch with every point. Numbers keep all digits.
    """
    from contwalk.storage import open_database, write_tables

    with open_database(db) as database:
        for path in write_tables(database, directory, overwrite=force):
            click.echo(printable(str(path)))
