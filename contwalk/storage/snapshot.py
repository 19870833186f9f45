"""Reading a file as it is at one instant, also while a run writes it.

Whatever a kill may leave is readable, and so is what a file holds at any instant. A reader takes its bytes
at once and looks at nothing else: it holds no lock, and the run goes on beside it.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import h5py

from contwalk.errors import DatabaseError
from contwalk.storage import seal
from contwalk.storage.failures import AGAIN, failures_of

# Larger files are read in place; one that is being written then has to wait.
LARGEST = 1 << 30
TRIES, WAIT = 20, 0.005


def open_snapshot(path: Path) -> h5py.File:
    """The file's content, for reading.

    Raises
    ------
    DatabaseError
        If the seal does not fit, or HDF5 cannot read the file.
    """
    with failures_of(path, "read"):
        if path.stat().st_size > LARGEST:
            check_seal(path, seal.intact_file(path))
            return h5py.File(path, "r", locking=False, rdcc_nbytes=0)
        content = _content(path)
        return _opened(path, content)


def check_seal(path: Path, intact: bool | None) -> None:
    """Refuse a file whose seal does not fit."""
    if intact is False:
        raise DatabaseError(f"{path} is damaged: it is not what was stored, by its checksum.", AGAIN)


def _content(path: Path) -> bytes:
    """All bytes: sealed, or twice the same."""
    content = path.read_bytes()
    for _ in range(TRIES):
        intact = seal.intact(content)
        if intact:
            break
        again = path.read_bytes()
        if again == content:  # a seal that does not fit may have been in the midst of being written
            check_seal(path, intact)
            break
        content = again
        time.sleep(WAIT)
    return content


def _opened(path: Path, content: bytes) -> h5py.File:
    """A file in memory. HDF5 wants a name that no file has; none can be inside of a file."""
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fapl_core(1 << 16, False)
    access.set_file_image(content)
    return h5py.File(h5py.h5f.open(os.fsencode(path / "snapshot"), h5py.h5f.ACC_RDONLY, fapl=access))
