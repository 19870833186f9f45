"""Logs that grow: few chunks, so that a kill costs no rows, and few copies, so that growing costs no time."""

from __future__ import annotations

from pathlib import Path

import h5py
import pytest

from contwalk.storage.hdf5 import Hdf5Database

# Entries that the first node of HDF5's index of chunks holds; when it splits, a kill may lose rows.
ENTRIES = 64


def most_chunks(path: Path) -> int:
    """The most chunks that any dataset of a file lies in."""
    found = [0]

    def visit(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.chunks is not None:
            found.append(item.id.get_num_chunks())

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return max(found)


class Appended:
    """Appends to a database, and counts how often its file was replaced by a copy."""

    def __init__(self, path: Path, header) -> None:
        self.path, self.copies = path, 0
        self.db = Hdf5Database.create(path, header)
        self._file = path.stat().st_ino

    def __call__(self, append, *given) -> None:
        append(*given)
        now = self.path.stat().st_ino
        self.copies += now != self._file
        self._file = now


@pytest.fixture
def appended(tmp_path, header):
    found = Appended(tmp_path / "log.h5", header)
    yield found
    found.db.close()


def test_520_special_points_lie_in_at_most_64_chunks_after_one_copy(appended, make_info, make_special):
    """Eight rows a chunk: the 513th finds no room; the copy has room for a thousand and more."""
    appended.db.start_branch(make_info())
    for number in range(520):
        appended(appended.db.append_special, "b1", make_special("UZ", float(number)))
        assert appended.copies == (number >= 512)
    appended.db.close()
    assert 1 < most_chunks(appended.path) <= ENTRIES


def test_many_points_are_copied_as_often_as_they_double(appended, make_info, make_row):
    """64 rows a chunk: a copy at 4096, and none for each append after it."""
    info = make_info()
    appended.db.start_branch(info)
    for number in range(4200):
        appended(appended.db.append, "b1", make_row(info, float(number)))
    assert appended.copies == 1
    appended.db.close()
    assert 1 < most_chunks(appended.path) <= ENTRIES


def test_notes_grow_as_points_do(appended):
    for number in range(600):
        appended(appended.db.write_note, f"note {number}", "x" * 50)
    appended.db.close()
    assert appended.copies <= 4
    assert most_chunks(appended.path) <= ENTRIES
