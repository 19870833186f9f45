"""The root of a file: format, schema version, header."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from contwalk.errors import DatabaseError
from contwalk.storage.database import RunHeader
from contwalk.storage.failures import failures_of, not_contwalk
from contwalk.storage.records import RecordLog, describe
from contwalk.storage.schema import FORMAT, SCHEMA_VERSION, TEXT_CHUNK, TEXT_DTYPE, decode, joined, pieces

BRANCHES = "branches"
CATALOGUE = "catalogue"
HEADER = "header"
NOTES = "notes"

# A file of the newest HDF5 format is marked as open while it is written and cannot be opened after a kill.
LIBVER = ("earliest", "v110")


def create_file(
    path: Path, header: RunHeader, header_text: str, notes: np.ndarray | None = None, branches: int = 0
) -> h5py.File:
    """A new file without branches, with room in its catalogue for at least twice as many as announced."""
    file = h5py.File(path, "x", libver=LIBVER)
    describe(file, format=FORMAT, system=header.system)
    file.attrs["schema_version"] = SCHEMA_VERSION
    file.create_group(BRANCHES)
    RecordLog.create(file, HEADER, pieces(header_text), TEXT_CHUNK)
    # HDF5 adds a link to a group in several writes, which a kill can tear; an entry of the catalogue is one.
    file[CATALOGUE] = np.full(max(64, 2 * branches), h5py.Reference(), h5py.ref_dtype)
    RecordLog.create(file, NOTES, np.empty(0, TEXT_DTYPE) if notes is None else notes, TEXT_CHUNK)
    return file


def open_file(path: Path, writable: bool) -> h5py.File:
    """Open an existing file."""
    with failures_of(path, "read"):
        return h5py.File(path, "r+" if writable else "r", libver=LIBVER, rdcc_nbytes=0)


def catalogued(file: h5py.File) -> list[h5py.Group]:
    """The groups of the branches in the order of creation."""
    return [file[reference] for reference in file[CATALOGUE][()] if reference]


def publish(file: h5py.File, order: int, name: str, group: h5py.Group) -> None:
    """Make a branch group that is on disk the one of this order, and link it under its name for browsers."""
    file[CATALOGUE][order] = group.ref
    file.flush()
    file[BRANCHES][name] = group
    file.flush()


def read_header(path: Path, file: h5py.File) -> RunHeader:
    """Check format and schema version, and read the header.

    Raises
    ------
    DatabaseError
        If the file is HDF5 of something else, has a newer schema, or is damaged.
    """
    with failures_of(path, "read"):
        stated = file.attrs.get("format")
    if not (isinstance(stated, bytes | np.bytes_) and stated == FORMAT.encode()):
        raise not_contwalk(path, "an HDF5 file of another program")
    with failures_of(path, "read"):
        version = int(file.attrs["schema_version"])
        if version <= SCHEMA_VERSION:
            (text,) = joined(RecordLog(file[HEADER], TEXT_DTYPE).read())
            return RunHeader(**decode(text))
    raise DatabaseError(
        f"{path} has schema version {version}; this contwalk reads versions up to {SCHEMA_VERSION}.",
        "Read it with the newer contwalk that wrote it: pip install --upgrade contwalk",
    )
