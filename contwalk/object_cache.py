"""Compiled code, and what else is made of texts, kept on disk under a hash of all that it was made from.

A key covers the text, and of what is compiled the machine and the compiler; what is found under it can
therefore not be out of date. Every file begins with a digest of the rest, since a damaged object file would
end the process in the linker. A directory that cannot be read or written means that nothing is kept, and is
no error. One that others may write to is not used: whoever writes there has code run in this process.
"""

from __future__ import annotations

import hashlib
import marshal
import os
import stat
import sys
import tempfile
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

MOST_BYTES = 256 * 1024 * 1024
# A folder of many files takes long to list. It is listed where more than this part of `MOST_BYTES` has been
# written since, by whatever processes, and where room is made, this part is left free.
SPARE = 1.0 / 16.0
# Seconds after which a file that is loaded is dated anew: rarely, since each dating is a write.
REDATED_AFTER = 600.0
_DIGEST = hashlib.sha256().digest_size
# Why a directory is not used, a sentence for whoever prints; empty where none was refused.
refusal = ""
_are_own: dict[Path, bool] = {}


def directory() -> Path:
    """Where compiled code is kept: `$CONTWALK_CACHE_DIR`, or the user's cache directory."""
    given = os.environ.get("CONTWALK_CACHE_DIR")
    if given:
        return Path(given)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    if base:
        return Path(base) / "contwalk"
    home = Path(os.path.expanduser("~"))
    return home / ("Library/Caches" if sys.platform == "darwin" else ".cache") / "contwalk"


def key(*parts: str) -> str:
    """One name for several texts, in their order."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode()
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()


def load(name: str) -> bytes | None:
    """What was stored under a key; None if there is nothing, or if it is damaged."""
    file = _file(name)
    if not _own(file.parent):
        return None
    try:
        data = file.read_bytes()
    except OSError:
        return None
    _remember_use(file)
    content = data[_DIGEST:]
    return content if data[:_DIGEST] == hashlib.sha256(content).digest() else None


def store(name: str, content: bytes) -> None:
    """Keep `content` under a key, if the directory can be written.

    The file appears complete or not at all, however many processes write it at once.
    """
    with suppress(OSError):
        target = _file(name)
        target.parent.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        target.parent.mkdir(mode=0o700, exist_ok=True)
        if not _own(target.parent):
            return
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=".writing-")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(hashlib.sha256(content).digest() + content)
            os.replace(temporary, target)
        except OSError:
            os.unlink(temporary)
            raise
        _count(target.parent, _DIGEST + len(content))


def load_values(name: str) -> list[Any] | None:
    """What `store_values` has kept under a key; None if there is nothing, or something else."""
    content = load(name)
    if content is None:
        return None
    try:
        own, *values = marshal.loads(content)
    except (ValueError, TypeError, EOFError):
        return None
    return values if own == name else None


def store_values(name: str, values: Iterable[Any]) -> None:
    """Keep numbers, texts, and tuples and lists of them, as `store` does; for this version of Python."""
    store(name, marshal.dumps((name, *values)))


def _own(folder: Path) -> bool:
    """Whether nobody but this user may write into the folder, and the one that it is in.

    A group that has the number of its user is that user's own.
    """
    global refusal
    if folder in _are_own:
        return _are_own[folder]
    for place in (folder, folder.parent):
        try:
            there = place.stat()
        except OSError:
            return True  # there is nothing to be read, and nothing is kept
        others = stat.S_IWOTH | (stat.S_IWGRP if there.st_gid != there.st_uid else 0)
        theirs = hasattr(os, "geteuid") and there.st_uid not in (os.geteuid(), 0)
        if theirs or there.st_mode & others:
            refusal = (
                f"The cache {folder} is not used, since others may write into {place}: code lies there. "
                "Make it your own, and chmod go-w, or name another folder in CONTWALK_CACHE_DIR."
            )
            _are_own[folder] = False
            return False
    _are_own[folder] = True
    return True


def _remember_use(file: Path) -> None:
    """Date a file anew, if it is old: room is made by deleting what nobody has loaded for longest."""
    with suppress(OSError):  # another process may have deleted it, or it is there to be read only
        if time.time() - file.stat().st_mtime > REDATED_AFTER:
            os.utime(file)


def _file(name: str) -> Path:
    return directory() / "objects" / f"{name}.o"


def _count(folder: Path, written: int) -> None:
    """Count what is written into a folder, by the length of a file beside it, and make room where it is time.

    What several processes append at once is counted whole. A byte stands for as many as a digest has.
    """
    counter = folder.with_name(f"{folder.name}.written")
    known = counter.exists()
    handle = os.open(counter, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o600)
    try:
        os.write(handle, bytes(-(-written // _DIGEST)))
        if not known or os.fstat(handle).st_size * _DIGEST > SPARE * MOST_BYTES:
            room = _made_room(folder, MOST_BYTES)
            os.ftruncate(handle, 0)
            os.write(handle, bytes(int((SPARE * MOST_BYTES - room) / _DIGEST)))
    finally:
        os.close(handle)


def _made_room(folder: Path, limit: int) -> float:
    """Delete the oldest files where all do not fit into `limit` bytes; how many may be written then."""
    files, spare = [], SPARE * limit
    with os.scandir(folder) as entries:
        for entry in entries:
            with suppress(FileNotFoundError):  # another process may have moved it meanwhile
                status = entry.stat()
                files.append((status.st_mtime, status.st_size, entry.path))
    total = sum(size for _, size, _ in files)
    if total > limit:
        for _, size, path in sorted(files):
            if total <= limit - spare:
                break
            Path(path).unlink(missing_ok=True)
            total -= size
    return min(limit - total, spare)
