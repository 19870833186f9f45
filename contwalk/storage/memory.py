"""A database in memory, for tests and for use as a library without files.

It keeps the same texts and bytes as the file would, so that both give back the same objects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from contwalk.branch import Branch, BranchInfo, Outcome, SpecialPoint
from contwalk.errors import DatabaseError
from contwalk.storage.database import (
    Database,
    RunHeader,
    assemble,
    check_new_name,
    checked_row,
    finished,
    unknown_branch,
)
from contwalk.storage.schema import (
    decode,
    encode,
    info_from_text,
    info_text,
    outcome_from_text,
    outcome_text,
    special_from_text,
    special_record,
    special_record_dtype,
    special_text,
)


@dataclass
class _Stored:
    info: BranchInfo
    rows: list[np.ndarray] = field(default_factory=list)
    specials: list[str] = field(default_factory=list)
    end: str | None = None


class MemoryDatabase(Database):
    """A `Database` without a file.

    Parameters
    ----------
    header : RunHeader
    where : str
        What it is called in messages.
    """

    def __init__(self, header: RunHeader, where: str = "The database in memory") -> None:
        self._where = where
        self.write_header(header)
        self._branches: dict[str, _Stored] = {}
        self._notes: dict[str, str] = {}
        self._closed = False

    @property
    def header(self) -> RunHeader:
        """The header given at creation, or the last one written."""
        return self._header

    @property
    def path(self) -> None:
        """None."""
        return None

    def close(self) -> None:
        """Refuse further use, as a closed file does."""
        self._closed = True

    def write_header(self, header: RunHeader) -> None:
        """Replace the header."""
        self._header = RunHeader(**decode(encode(asdict(header), "the header")))

    def start_branch(self, info: BranchInfo) -> None:
        """Begin a branch."""
        self._check_open()
        check_new_name(info.name, self.branch_names())
        self._branches[info.name] = _Stored(info_from_text(info_text(info)))

    def append(self, name: str, row: np.ndarray | np.void) -> None:
        """Append one point, shape (1,) or ()."""
        stored = self._unfinished(name)
        stored.rows.append(checked_row(stored.info, row).copy())

    def append_special(self, name: str, point: SpecialPoint) -> None:
        """Append a special point."""
        stored = self._unfinished(name)
        special_record(stored.info, point, special_record_dtype(stored.info))  # refuses what a file refuses
        stored.specials.append(special_text(point))

    def finish(self, name: str, outcome: Outcome, cost: Mapping[str, float]) -> None:
        """Say how the branch ended."""
        self._unfinished(name).end = outcome_text(outcome, cost)

    def drop_outcome(self, name: str) -> None:
        """Reopen a finished branch."""
        self._stored(name).end = None

    def truncate(self, name: str, rows: int, specials: Sequence[int]) -> None:
        """Keep the first rows, and some special points."""
        stored = self._stored(name)
        del stored.rows[rows:]
        stored.specials = [stored.specials[number] for number in specials]

    def drop(self, name: str) -> None:
        """Remove a branch."""
        del self._branches[self._stored(name).info.name]

    def rows(self, name: str) -> np.ndarray:
        """Points in the order of appending, shape (k,), of dtype `info.point_dtype()`."""
        stored = self._stored(name)
        return np.concatenate([np.empty(0, stored.info.point_dtype()), *stored.rows])

    def specials(self, name: str) -> list[SpecialPoint]:
        """Special points in the order of appending."""
        return [special_from_text(text) for text in self._stored(name).specials]

    def branch_names(self) -> list[str]:
        """Names in the order of creation."""
        self._check_open()
        return list(self._branches)

    def branch(self, name: str) -> Branch:
        """One branch, sorted and named."""
        stored = self._stored(name)
        return assemble(stored.info, self.rows(name), self.specials(name), outcome_from_text(stored.end))

    def write_note(self, key: str, text: str) -> None:
        """Keep a text under a key."""
        self._check_open()
        self._notes[key] = text

    def notes(self) -> dict[str, str]:
        """All notes."""
        self._check_open()
        return {key: text for key, text in self._notes.items() if text}

    def _check_open(self) -> None:
        if self._closed:
            raise DatabaseError(f"{self._where} is closed.", "Use it before close().")

    def _stored(self, name: str) -> _Stored:
        self._check_open()
        if name not in self._branches:
            raise unknown_branch(name, self.branch_names(), self._where, self.point_names)
        return self._branches[name]

    def _unfinished(self, name: str) -> _Stored:
        stored = self._stored(name)
        if stored.end is not None:
            raise finished(name)
        return stored
