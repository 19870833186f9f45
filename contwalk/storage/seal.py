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
_PART = 1 << 20


def intact(content: bytes) -> bool | None:
    """Whether the seal of a file fits; None where it has none."""
    place = len(content) - LENGTH
    if place < 0 or not content.startswith(MARK, place):
        return None
    return content[place:] == _seal(hashlib.sha256(memoryview(content)[:place]))


def intact_file(path: Path) -> bool | None:
    """As `intact`, of a file that is too large to be read at once."""
    with path.open("rb") as file:
        place = file.seek(0, os.SEEK_END) - LENGTH
        if place < 0:
            return None
        file.seek(place)
        seal = file.read()
        file.seek(0)
        return seal == _seal(_hash_of(file, place)) if seal.startswith(MARK) else None


def append_seal(path: Path) -> None:
    """Seal a file; one that has no room for it stays as it is."""
    with suppress(OSError), path.open("r+b") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        seal = _seal(_hash_of(file, size))
        try:
            file.write(seal)
            file.flush()
        except OSError:
            os.truncate(path, size)


def _seal(hashed: hashlib._Hash) -> bytes:
    return MARK + hashed.hexdigest().encode() + b"\n"


def _hash_of(file: object, size: int) -> hashlib._Hash:
    hashed = hashlib.sha256()
    while size > 0 and (part := file.read(min(_PART, size))):  # type: ignore[attr-defined]
        hashed.update(part)
        size -= len(part)
    return hashed
