"""The seal of a file that nobody writes any more: a hash of all its bytes, behind them.

HDF5 does not protect its own bookkeeping, and a single wrong bit there may drop or exchange rows that are
whole. A file that was closed ends in a seal, and is read only while the seal fits. HDF5 itself does not
look behind the end that its superblock tells; it cuts the seal off when it opens the file for writing.

A kill while the seal is written leaves its beginning. That is no damage: all before it had been written, and
as much of the hash as there is says so. A beginning that does not fit is damage, as a whole seal would be.
"""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from pathlib import Path

MARK = b"\ncontwalk seal 1, sha256: "
LENGTH = len(MARK) + 64 + 1
# So much of a mark at the end of a file is not there by chance.
SHORTEST = 8
_PART = 1 << 20


def intact(content: bytes) -> bool | None:
    """Whether the seal of a file fits; None where it has none, or only the beginning of the one that fits."""
    place = _place(content[-LENGTH:], len(content))
    if place is None:
        return None
    return _fits(content[place:], hashlib.sha256(memoryview(content)[:place]))


def intact_file(path: Path) -> bool | None:
    """As `intact`, of a file that is too large to be read at once."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - LENGTH, 0))
        end = file.read()
        place = _place(end, size)
        if place is None:
            return None
        file.seek(0)
        return _fits(end[place - size :], _hash_of(file, place))


def append_seal(path: Path) -> None:
    """Seal a file, all of which is on the disk then; one that has no room for it stays as it is."""
    with suppress(OSError), path.open("r+b") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        seal = _seal(_hash_of(file, size))
        try:
            file.write(seal)
            file.flush()
            os.fsync(file.fileno())
        except OSError:
            os.truncate(path, size)


def _place(end: bytes, size: int) -> int | None:
    """Where the seal of a file of this size begins, whose last bytes are `end`; None where it has none.

    One that lacks its own end is found as well: a run was killed while it wrote it.
    """
    begins = end.rfind(MARK)
    if begins < 0:
        begins = len(end) - next((n for n in range(len(MARK), SHORTEST - 1, -1) if end.endswith(MARK[:n])), 0)
    return size - len(end) + begins if begins < len(end) else None


def _fits(seal: bytes, hashed: hashlib._Hash) -> bool | None:
    right = _seal(hashed)
    return True if seal == right else None if right.startswith(seal) else False


def _seal(hashed: hashlib._Hash) -> bytes:
    return MARK + hashed.hexdigest().encode() + b"\n"


def _hash_of(file: object, size: int) -> hashlib._Hash:
    hashed = hashlib.sha256()
    while size > 0 and (part := file.read(min(_PART, size))):  # type: ignore[attr-defined]
        hashed.update(part)
        size -= len(part)
    return hashed
