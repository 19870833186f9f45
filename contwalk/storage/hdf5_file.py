"""The root of a file: format, schema version, header."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from contwalk.errors import DatabaseError
from contwalk.storage.database import RunHeader
from contwalk.storage.failures import failures_of, not_contwalk
from contwalk.storage.known_keys import Provenance
from contwalk.storage.records import RecordLog, check_layout, describe
from contwalk.storage.schema import FORMAT, SCHEMA_VERSION, TEXT_CHUNK, TEXT_DTYPE, decode, joined, pieces
from contwalk.storage.typed import check_known, typed

BRANCHES = "branches"
CATALOGUE = "catalogue"
HEADER = "header"
NOTES = "notes"

# A file of the newest HDF5 format is marked as open while it is written and cannot be opened after a kill.
LIBVER = ("earliest", "v110")


def create_file(
    path: Path, header: RunHeader, header_text: str, notes: np.ndarray | None = None, branches: int = 0
) -> h5py.File:
    """A new file without branches, with room in its catalogue for at least twice as many as announced.

    `notes` are the records of a text log, shape (k,).
    """
    # The lock is contwalk's own: it is held while one file takes the place of another.
    file = h5py.File(path, "x", libver=LIBVER, locking=False, rdcc_nbytes=0)
    describe(file, format=FORMAT, system=header.system)
    file.attrs["schema_version"] = SCHEMA_VERSION
    file.create_group(BRANCHES)
    RecordLog.create(file, HEADER, pieces(header_text), TEXT_CHUNK)
    # HDF5 adds a link to a group in several writes, which a kill can tear; an entry of the catalogue is one.
    file[CATALOGUE] = np.full(max(64, 2 * branches), h5py.Reference(), h5py.ref_dtype)
    RecordLog.create(file, NOTES, np.empty(0, TEXT_DTYPE) if notes is None else notes, TEXT_CHUNK)
    return file


def dataset_in(group: h5py.Group, name: str) -> h5py.Dataset:
    """A dataset that is a part of the group, in this file.

    Raises
    ------
    ValueError
        If it is missing, is something else, or only a link to elsewhere.
    """
    own = isinstance(group.get(name, getlink=True), h5py.HardLink)
    dataset = group[name] if own else None
    if not isinstance(dataset, h5py.Dataset) or (dataset.chunks is None and name != CATALOGUE):
        raise ValueError(f"it has no dataset {group.name.rstrip('/')}/{name} of its own")
    return dataset


def catalogued(file: h5py.File) -> list[h5py.Group]:
    """The groups of the branches in the order of creation.

    Raises
    ------
    ValueError
        Unless they are groups, each once, with nothing between them.
    """
    catalogue = dataset_in(file, CATALOGUE)
    check_layout(catalogue)
    if catalogue.dtype != h5py.ref_dtype or catalogue.ndim != 1:
        raise ValueError(f"{catalogue.name} holds no references")
    references = list(catalogue[()].tolist())
    known = [bool(reference) for reference in references]
    groups = [file[reference] for reference in references[: sum(known)] if reference]
    places = {h5py.h5o.get_info(group.id).addr for group in groups}
    if known[: sum(known)].count(False) or len(places) < len(groups):
        raise ValueError(f"{catalogue.name} does not list the branches one after the other")
    if not all(isinstance(group, h5py.Group) for group in groups):
        raise ValueError(f"{catalogue.name} lists what is no branch")
    return groups


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
        stated, form = _short_text(file, "format"), stated_form(file)
    if stated != FORMAT.encode():
        raise not_contwalk(path, "an HDF5 file of another program", form)
    with failures_of(path, "read"):
        version = whole_number(file, "schema_version")
        if version <= SCHEMA_VERSION:
            (text,) = joined(RecordLog(dataset_in(file, HEADER), TEXT_DTYPE).read())
            return _header_of(decode(text))
    raise DatabaseError(
        f"{path} has schema version {version}; this contwalk reads versions up to {SCHEMA_VERSION}.",
        "Read it with the newer contwalk that wrote it: pip install --upgrade contwalk",
    )


def _header_of(stored: Any) -> RunHeader:
    header = typed(RunHeader, stored)
    check_known(Provenance, header.provenance)
    return header


def _short_text(file: h5py.File, name: str) -> bytes | None:
    """An attribute that is a text of fixed length; None for anything else, which is not read."""
    kept = file.attrs.get_id(name) if name in file.attrs else None
    short = kept is not None and kept.shape == () and kept.dtype.kind == "S"
    return bytes(file.attrs[name]) if short else None


def stated_form(file: h5py.File) -> str:
    """The format that a file tells of itself, a text of any length; empty for none."""
    kept = file.attrs.get_id("format") if "format" in file.attrs else None
    if kept is None or kept.shape != () or h5py.check_string_dtype(kept.dtype) is None:
        return ""
    stated = file.attrs["format"]
    return stated.decode(errors="replace") if isinstance(stated, bytes) else str(stated)


def whole_number(file: h5py.File, name: str) -> int:
    """An attribute that is a whole number.

    Raises
    ------
    KeyError, ValueError
        If there is none.
    """
    kept = file.attrs.get_id(name)
    if kept.shape != () or kept.dtype.kind not in "iu":
        raise ValueError(f"the attribute {name} is no number")
    return int(file.attrs[name])
