"""One writer at a time: a lock of the operating system on the file, which ends with the process."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path

from contwalk.errors import DatabaseError

try:
    import fcntl
except ImportError:  # where there is none, HDF5's own lock has to do
    fcntl = None  # type: ignore[assignment]

# A reader that asks whether somebody writes holds the lock for an instant.
TRIES, WAIT = 10, 0.02


class Lock:
    """A lock that is held. `release` gives it back; so does the end of the process, however it ends."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def synchronise(self) -> None:
        """Have on the disk what the operating system has been given of the file."""
        os.fsync(self._descriptor)

    def release(self) -> None:
        """Give the lock back. Twice is allowed."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


def lock(path: Path) -> Lock:
    """Lock a file that exists.

    Raises
    ------
    DatabaseError
        If another process holds it.
    """
    for attempt in range(TRIES):
        if attempt:
            time.sleep(WAIT)
        descriptor = _opened(path)
        if _taken(descriptor) is not False and _is_still(path, descriptor):
            return Lock(descriptor)
        os.close(descriptor)
    raise DatabaseError(
        f"{path} is in use: another process writes it.",
        "Wait until that run has ended, or stop it; what it has stored is kept. It can be read meanwhile.",
    )


def is_locked(path: Path) -> bool:
    """Whether a process writes the file."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY)
        try:
            return _taken(descriptor) is False
        finally:
            os.close(descriptor)
    return False


def lock_of_nobody(path: Path) -> Lock | None:
    """The lock of a file that certainly nobody else has locked; None where that cannot be told."""
    with suppress(OSError):
        descriptor = os.open(path, os.O_RDWR)
        if _taken(descriptor) and _is_still(path, descriptor):
            return Lock(descriptor)
        os.close(descriptor)
    return None


def _opened(path: Path) -> int:
    try:
        return os.open(path, os.O_RDWR)
    except PermissionError:
        return os.open(path, os.O_RDONLY)


def _taken(descriptor: int) -> bool | None:
    """Whether the lock is this process's now; None where there are no locks."""
    if fcntl is None:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return None
    return True


def _is_still(path: Path, descriptor: int) -> bool:
    """Whether the locked file is the one of this name: another writer may have replaced it meanwhile."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(descriptor))
    except OSError:
        return False
