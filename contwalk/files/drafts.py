"""The one way in which a file is written: whole, or not at all.

A draft is made beside the file under a name that no file has, locked as long as somebody fills it, put on the
disk, and renamed. A kill leaves a draft that nobody has locked; whoever next writes the same file removes it.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, Generic, TypeVar

from contwalk.errors import DatabaseError
from contwalk.files.locking import TRIES, lock, lock_of_nobody

Opened = TypeVar("Opened")


class AlreadyThereError(Exception):
    """Another process has put a file where a new one was to be."""


class Draft(Generic[Opened]):
    """A file that is being written beside the one whose place it takes.

    Parameters
    ----------
    path : Path
        The file; where it is a symbolic link, what that leads to.
    opened : callable
        Makes the draft under a name, which no file may have, and opens it.
    new : bool
        Go over no other file.

    Attributes
    ----------
    file : object
        What `opened` returned.
    path : Path
        Name of the draft.
    lock : Lock
        Belongs to the file once the draft has taken its place.

    Raises
    ------
    OSError
        If there can be none, or the file that would be replaced may not be written.
    """

    def __init__(self, path: Path, opened: Callable[[Path], Opened], new: bool = False) -> None:
        self._target, self._new = target_of(path), new
        _remove_abandoned(self._target)
        for attempt in range(TRIES):
            name = f".{self._target.stem}.{secrets.token_hex(4)}.new{self._target.suffix}"
            self.path = self._target.with_name(name)
            opened_file = None
            try:
                opened_file = self.file = opened(self.path)
                _like(self.path, self._target)
                self.lock = lock(self.path)
                return
            except BaseException as error:
                _close(opened_file)
                if not isinstance(error, FileExistsError):
                    self.path.unlink(missing_ok=True)
                # Another process may have taken it for an abandoned one before it was locked.
                if not isinstance(error, FileNotFoundError | DatabaseError) or attempt == TRIES - 1:
                    raise

    def place(self) -> None:
        """Put it on the disk and give it its name; what was written must have been flushed.

        Raises
        ------
        AlreadyThereError
        """
        self.lock.synchronise()
        put_in_place(self.path, self._target, self._new)
        synchronise_folder(self._target.parent)

    def discard(self) -> None:
        """Remove it."""
        self.path.unlink(missing_ok=True)
        self.lock.release()


@contextmanager
def drafted(
    path: Path,
    opened: Callable[[Path], Opened],
    new: bool = False,
    abandon: Callable[[Opened], None] | None = None,
) -> Iterator[Draft[Opened]]:
    """A draft to fill, which takes its place when it is left without an exception; else nothing stays of it.

    Whoever fills it flushes it, and releases its lock later.

    Parameters
    ----------
    path, opened, new
        As of `Draft`.
    abandon : callable, optional
        Closes a draft that cannot be filled.
    """
    draft = Draft(path, opened, new)
    try:
        yield draft
        draft.place()
    except BaseException:
        (abandon or _close)(draft.file)
        draft.discard()
        raise


@contextmanager
def written(path: Path, mode: str = "b", new: bool = False) -> Iterator[IO[Any]]:
    """A stream whose content becomes the file when it is left without an exception.

    Parameters
    ----------
    path : Path
    mode : str
        `b` for bytes, `t` for text in UTF-8, whose ends of lines stay as they are.
    new : bool
        Go over no other file.

    Raises
    ------
    OSError, AlreadyThereError
        If it cannot be written, or is there and must not be; nothing is left behind.
    """
    text = {"encoding": "utf-8", "newline": ""} if mode == "t" else {}

    def opened(name: Path) -> IO[Any]:
        return open(name, f"x{mode}", **text)  # type: ignore[call-overload]

    with drafted(path, opened, new) as draft:
        yield draft.file
        draft.file.close()
    draft.lock.release()


def target_of(path: Path) -> Path:
    """What is written where `path` is asked for: a symbolic link stays one.

    Raises
    ------
    OSError
        If links lead round in a circle, or there is a file that may not be written.
    """
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    with suppress(FileNotFoundError):
        mode = target.stat().st_mode
        if stat.S_ISREG(mode) and not (mode & 0o222 and os.access(target, os.W_OK)):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    return target


def put_in_place(draft: Path, target: Path, new: bool) -> None:
    """Give a file that is whole its name; one that is `new` goes over no other.

    Raises
    ------
    AlreadyThereError
    """
    if not new:
        draft.replace(target)
        return
    try:
        os.link(draft, target)
    except FileExistsError:
        raise AlreadyThereError from None
    except OSError:  # a system of files without links
        if target.exists():
            raise AlreadyThereError from None
        draft.replace(target)
    else:
        draft.unlink()


def synchronise_folder(folder: Path) -> None:
    """Have the names in a folder on the disk, where a system of files lets one ask for that."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _like(draft: Path, target: Path) -> None:
    """Give a draft the owner and the permissions of the file that it replaces."""
    try:
        there = target.stat()
    except FileNotFoundError:
        return
    if hasattr(os, "chown"):
        with suppress(OSError):  # only the superuser gives files away
            os.chown(draft, there.st_uid, there.st_gid)
    draft.chmod(stat.S_IMODE(there.st_mode))


def _remove_abandoned(target: Path) -> None:
    """Remove the drafts of processes that were killed: those that nobody has locked."""
    name = re.compile(rf"\.{re.escape(target.stem)}\.[0-9a-f]{{8}}\.new{re.escape(target.suffix)}")
    with os.scandir(target.parent) as entries:
        left = [Path(entry.path) for entry in entries if name.fullmatch(entry.name) and _is_file(entry)]
    for draft in left:
        held = lock_of_nobody(draft)
        if held is not None:
            draft.unlink(missing_ok=True)
            held.release()


def _is_file(entry: os.DirEntry[str]) -> bool:
    return entry.is_file(follow_symlinks=False)


def _close(file: Any) -> None:
    with suppress(OSError, RuntimeError, ValueError):
        if file is not None:
            file.close()
