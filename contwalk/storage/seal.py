"""The seal of a file that nobody writes any more: a hash of all its bytes, behind them.

HDF5 does not protect its own bookkeeping, and a single wrong bit there may drop or exchange rows that are
whole. A file that was closed ends in a seal, and is read only while the seal fits. HDF5 itself does not
look behind the end that its superblock tells; it cuts the seal off when it opens the file for writing.
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
    """Whether the seal of a file fits; None where it has none. One that is cut off in its midst does not."""
    place = len(content) - LENGTH
    if place < 0 or not content.startswith(MARK, place):
        return False if _is_cut(content[-LENGTH:]) else None
    return content[place:] == _seal(hashlib.sha256(memoryview(content)[:place]))


def intact_file(path: Path) -> bool | None:
    """As `intact`, of a file that is too large to be read at once."""
    with path.open("rb") as file:
        place = file.seek(0, os.SEEK_END) - LENGTH
        file.seek(max(place, 0))
        seal = file.read()
        if place < 0 or not seal.startswith(MARK):
            return False if _is_cut(seal) else None
        file.seek(0)
        return seal == _seal(_hash_of(file, place))


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


def _is_cut(end: bytes) -> bool:
    """Whether a file's last bytes, at most as many as a seal has, end in a seal that lacks its own end."""
    return MARK in end or any(end.endswith(MARK[:left]) for left in range(SHORTEST, len(MARK)))


def _seal(hashed: hashlib._Hash) -> bytes:
    return MARK + hashed.hexdigest().encode() + b"\n"


def _hash_of(file: object, size: int) -> hashlib._Hash:
    hashed = hashlib.sha256()
    while size > 0 and (part := file.read(min(_PART, size))):  # type: ignore[attr-defined]
        hashed.update(part)
        size -= len(part)
    return hashed
