"""How a database shows itself: a line of text, and a table in notebooks."""

from __future__ import annotations

from contwalk import tables
from contwalk.branch import table_of_branches
from contwalk.errors import DatabaseError
from contwalk.storage.database import Database


def line_of(database: Database) -> str:
    """`<database cascade.h5 of autobalancer: b1 b2>`."""
    where = "in memory" if database.path is None else str(database.path)
    try:
        names = " ".join(database.branch_names())
    except DatabaseError:  # it is closed: that is no reason to fail here
        return f"<database {where}, closed>"
    return f"<database {where} of {database.header.system}: {names or 'no branches'}>"


def html_of(database: Database) -> str:
    """The branches as a table of HTML."""
    return tables.html(line_of(database)[1:-1], table_of_branches(database.branches()))
