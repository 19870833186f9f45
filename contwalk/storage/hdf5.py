"""A database in an HDF5 file; `docs/schema.md` describes it.

In use a file only grows, by records that are flushed one by one (see `records`). Whatever would make HDF5
reorder its own bookkeeping, or find it torn after a kill, is done by copying into a new file instead.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.files.drafts import AlreadyThereError, drafted
from contwalk.files.locking import Lock, is_locked
from contwalk.files.locking import lock as acquire
from contwalk.storage.database import (
    RunHeader,
    assemble,
    check_new_name,
    checked_row,
    finished,
    unknown_branch,
)
from contwalk.storage.failures import check_input, check_output, check_space, failures_of
from contwalk.storage.file_database import FileDatabase
from contwalk.storage.hdf5_branch import StoredBranch
from contwalk.storage.hdf5_file import CATALOGUE, NOTES, catalogued, create_file, dataset_in, read_header
from contwalk.storage.records import RecordLog
from contwalk.storage.schema import TEXT_DTYPE, encode, joined, note_from_text, pieces
from contwalk.storage.seal import append_seal
from contwalk.storage.snapshot import open_snapshot

OUTCOME = 8  # rows of text that an outcome takes, and more than any has taken


class Hdf5Database(FileDatabase):
    """A `Database` in a file. Make one with `create` or `open`; use it as a context manager."""

    def __init__(self, path: Path, file: h5py.File, lock: Lock | None = None) -> None:
        self._path = path
        self._lock = lock  # that of a writer
        self._failed: DatabaseError | None = None  # why nothing can be written any more
        self._attach(file)

    @classmethod
    def create(cls, path: str | Path, header: RunHeader, overwrite: bool = False) -> Hdf5Database:
        """Create a file and open it for writing.

        An existing file is replaced only when the new one is whole.

        Raises
        ------
        DatabaseError
            If the output exists (unless `overwrite`), is a directory, is in use, or cannot be written.
        """
        path = Path(path)
        with failures_of(path, "create"):
            check_output(path, overwrite)
            replaced = acquire(path) if path.exists() else None
        try:
            with _placed(path, header, new=replaced is None) as (file, lock):
                pass
        except AlreadyThereError:  # another process was faster
            return cls.create(path, header, overwrite)
        finally:
            if replaced is not None:
                replaced.release()
        return cls(path, file, lock)

    @classmethod
    def open(cls, path: str | Path, writable: bool = False) -> Hdf5Database:
        """Open a file.

        Opening for writing first copies what is whole into a new file in its place: nothing that a killed
        run left half-written stays.

        Raises
        ------
        DatabaseError
            If the file is missing, is not a contwalk database, has a newer schema, or is damaged; for writing
            also if another process writes it.
        """
        path = Path(path)
        check_input(path)
        if not writable:
            return cls(path, open_snapshot(path))
        with failures_of(path, "write"):
            lock = acquire(path)
        try:
            database = cls(path, open_snapshot(path), lock)
            database._rewrite()
        except BaseException:
            lock.release()
            raise
        return database

    def _attach(self, file: h5py.File) -> None:
        self._file = file
        self._branches: dict[str, StoredBranch] = {}
        try:
            self._header = read_header(self._path, file)
            with failures_of(self._path, "read"):
                self._notes = RecordLog(dataset_in(file, NOTES), TEXT_DTYPE)
                for stored in map(StoredBranch.open, catalogued(file)):
                    if stored.info.name in self._branches:
                        raise ValueError(f"it has two branches {stored.info.name}")
                    self._branches[stored.info.name] = stored
        except BaseException:
            file.close()
            raise

    @property
    def header(self) -> RunHeader:
        """The header given at creation."""
        return self._header

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    def close(self) -> None:
        """Release the file. Everything was flushed before; what was written is sealed."""
        if self._failed is not None:
            _abandon(self._file)
        elif self._file and _closed(self._file) and self._lock is not None:
            append_seal(self._path)
        if self._lock is not None:
            self._lock.release()

    def start_branch(self, info: BranchInfo) -> None:
        """Begin a branch."""
        check_new_name(info.name, self.branch_names())
        order = len(self._branches)
        if order == len(self._file[CATALOGUE]):
            self._rewrite()
        with self._writing(StoredBranch.room(info)):
            self._branches[info.name] = StoredBranch.create(self._file, order, info)

    def append(self, name: str, row: np.ndarray | np.void) -> None:
        """Append one point, shape (1,) or (); it is on disk when this returns."""
        record = checked_row(self._unfinished(name).info, row)
        if self._stored(name).points.full(1):
            self._rewrite()
        with self._writing(self._stored(name).points.room(1)):
            self._stored(name).append_row(record)

    def append_special(self, name: str, point: SpecialPoint) -> None:
        """Append a special point; it is on disk when this returns."""
        record = self._unfinished(name).special_record(point)
        if self._stored(name).special_points.full(1):
            self._rewrite()
        with self._writing(self._stored(name).special_points.room(1)):
            self._stored(name).special_points.append(record)

    def finish(self, name: str, outcome: Outcome, cost: Mapping[str, float]) -> None:
        """Say how the branch ended."""
        stored = self._unfinished(name)
        with self._writing(stored.outcomes.room(OUTCOME)):
            stored.write_end(outcome, cost)

    def drop_outcome(self, name: str) -> None:
        """Reopen a finished branch."""
        stored = self._stored(name)
        if stored.end() is not None:
            with self._writing(stored.outcomes.room(1)):
                stored.reopen()

    def truncate(self, name: str, rows: int, specials: Sequence[int]) -> None:
        """Keep the first rows, and some special points; a shorter branch goes into a new file."""
        stored = self._stored(name)
        if rows < stored.points.count or len(specials) < stored.special_points.count:
            self._rewrite(truncated={name: (rows, list(specials))})

    def write_header(self, header: RunHeader) -> None:
        """Replace the header: a run goes on with other settings."""
        before, self._header = self._header, header
        try:
            self._rewrite()
        except BaseException:
            self._header = before
            raise

    def drop(self, name: str) -> None:
        """Remove a branch; the others go into a new file that replaces this one."""
        self._rewrite(dropped=self._stored(name).info.name)

    def rows(self, name: str) -> np.ndarray:
        """Points in the order of appending, shape (k,), of dtype `info.point_dtype()`."""
        stored = self._stored(name)
        with failures_of(self._path, "read"):
            return stored.rows()

    def specials(self, name: str) -> list[SpecialPoint]:
        """Special points in the order of appending."""
        stored = self._stored(name)
        with failures_of(self._path, "read"):
            return stored.specials()

    def branch_names(self) -> list[str]:
        """Names in the order of creation."""
        self._check_open()
        return list(self._branches)

    def infos(self) -> list[BranchInfo]:
        """What is true of each branch, without its rows."""
        self._check_open()
        return [stored.info for stored in self._branches.values()]

    def branch(self, name: str) -> Branch:
        """One branch, sorted and named."""
        stored = self._stored(name)
        with failures_of(self._path, "read"):
            running = stored.end() is None and self._lock is None and is_locked(self._path)
            return assemble(stored.info, stored.rows(), stored.specials(), stored.end(), running)

    def write_note(self, key: str, text: str) -> None:
        """Keep a text under a key; the last one counts."""
        self._check_open()
        records = pieces(encode([key, text], "a note"))
        if self._notes.full(len(records)):
            self._rewrite()
        with self._writing(self._notes.room(len(records))):
            self._notes.append(records)

    def notes(self) -> dict[str, str]:
        """All notes."""
        self._check_open()
        with failures_of(self._path, "read"):
            known = dict(map(note_from_text, joined(self._notes.read())))
            return {key: text for key, text in known.items() if text}

    def _rewrite(
        self, truncated: Mapping[str, tuple[int, list[int]]] | None = None, dropped: str = ""
    ) -> None:
        """Copy what is kept into a new file and put it in the place of this one."""
        kept = [stored for stored in self._branches.values() if stored.info.name != dropped]
        with self._writing(self._path.stat().st_size):
            notes = self._notes.read()
            with _placed(self._path, self._header, notes, len(kept), "write") as (file, lock):
                for order, stored in enumerate(kept):
                    rows, specials = (truncated or {}).get(stored.info.name, (None, None))
                    stored.copy_to(file, order, rows, specials)
        old, before = self._file, self._lock
        self._lock = lock
        self._attach(file)
        _closed(old)  # whoever has waited for it finds that another file has taken its place
        if before is not None:
            before.release()

    @contextlib.contextmanager
    def _writing(self, size: int) -> Iterator[None]:
        """Refuse what cannot be written now, and explain what fails."""
        self._check_open()
        if self._lock is None:
            raise DatabaseError(f"{self._path} is open for reading only.", "Open it with writable=True.")
        if self._failed is not None:
            raise self._failed
        try:
            with failures_of(self._path, "write"):
                check_space(self._path, size)
                yield
        except DatabaseError as error:
            self._failed = error
            raise

    def _check_open(self) -> None:
        if not self._file:
            raise DatabaseError(f"{self._path} is closed.", "Open it again with contwalk.open_database.")

    def _stored(self, name: str) -> StoredBranch:
        self._check_open()
        if name not in self._branches:
            raise unknown_branch(name, self.branch_names(), str(self._path), self.point_names)
        return self._branches[name]

    def _unfinished(self, name: str) -> StoredBranch:
        stored = self._stored(name)
        if stored.end() is not None:
            raise finished(name)
        return stored


@contextlib.contextmanager
def _placed(
    path: Path,
    header: RunHeader,
    notes: np.ndarray | None = None,
    branches: int = 0,
    purpose: str = "create",
    new: bool = False,
) -> Iterator[tuple[h5py.File, Lock]]:
    """A new file to fill, locked, which takes its place at `path`; if that fails, `path` stays as it was.

    Raises
    ------
    AlreadyThereError
        If it is to be `new`, and another process has put a file there meanwhile.
    """
    text = encode(asdict(header), "the header")

    def opened(name: Path) -> h5py.File:
        return create_file(name, header, text, notes, branches)

    with failures_of(path, purpose):
        check_space(path, len(text), purpose)
        with drafted(path, opened, new, _abandon) as draft:
            yield draft.file, draft.lock
            draft.file.flush()


def _closed(file: h5py.File) -> bool:
    """Close a file; whether that was possible."""
    try:
        file.close()
    except (OSError, RuntimeError):
        return False
    return True


def _abandon(file: h5py.File) -> None:
    """Leave a file as it is on disk: as a kill would, which is safe at any moment.

    HDF5 would go on to write what belongs to a write that has failed, and leave the file unreadable. So its
    descriptor leads nowhere from now on.
    """
    with contextlib.suppress(OSError, RuntimeError, ValueError, NotImplementedError):
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, file.id.get_vfd_handle())
        os.close(nowhere)
    _closed(file)
