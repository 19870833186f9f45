"""Branch databases: what a run computes, kept so that a killed run loses at most one point.

Rules of the contract
---------------------
1. A database holds one run: its `RunHeader`, its branches in the order of their creation, and its notes.
   `Hdf5Database` (a file) and `MemoryDatabase` obey the same `Database` protocol; every test runs over both,
   and over the one of the page that says how another is added.
2. `start_branch`, `append`, `append_special`, `finish` and `write_note` are on disk when they return.
3. A record is stored complete or not at all. What a kill leaves half-written is ignored by readers and
   removed when the file is next opened for writing.
4. The row of a special point is appended before its record, so a record never lacks its row.
5. A running database only grows. `truncate` and `drop` write a new file beside the old one and put it in
   its place, so that at every moment one whole file exists.
6. `rows` and `specials` are in the order of appending; `branch` sorts by arclength and names special points.
7. A branch without an outcome is incomplete; it loads as `stopped`, `interrupted`.
8. One writer at a time, and any number of readers beside it. A second writer gets a `DatabaseError`.
9. What goes wrong is a `DatabaseError` that names the file and the remedy. Nothing is cut silently.

`docs/schema.md` describes the file. h5py is imported only when a file is opened.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from contwalk.storage.backends import backend_of
from contwalk.storage.database import Database, RunHeader
from contwalk.storage.document import document, interface_schema
from contwalk.storage.file_database import FileDatabase
from contwalk.storage.memory import MemoryDatabase
from contwalk.storage.tables import write_tables

if TYPE_CHECKING:
    from contwalk.storage.hdf5 import Hdf5Database

__all__ = [
    "Database",
    "FileDatabase",
    "Hdf5Database",
    "MemoryDatabase",
    "RunHeader",
    "document",
    "interface_schema",
    "open_database",
    "write_tables",
]


def open_database(path: str | Path, trust: bool = False) -> FileDatabase:
    """Open a stored run for reading. No code that it names is run.

    Parameters
    ----------
    path : str or Path
    trust : bool
        Whether `system()` of the database may run a plugin file, or a system that has changed since the run.

    Raises
    ------
    DatabaseError
        If the file is missing, is not a contwalk database, or is damaged.
    """
    database = backend_of(path).open(path)
    database.trust = trust
    return database


def __getattr__(name: str) -> Any:
    # h5py takes a noticeable part of a second to import; only those who open a file pay for it.
    if name == "Hdf5Database":
        from contwalk.storage.hdf5 import Hdf5Database

        return Hdf5Database
    raise AttributeError(f"module 'contwalk.storage' has no attribute '{name}'")
