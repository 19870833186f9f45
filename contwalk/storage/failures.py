"""What the operating system or HDF5 refuses, said in sentences."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from contwalk.errors import DatabaseError, WriteError
from contwalk.files.drafts import AlreadyThereError, target_of

try:
    import resource
except ImportError:  # where there are no such limits
    resource = None  # type: ignore[assignment]

RESERVE = 1 << 16  # bytes left free for HDF5's own records, so that closing the file still succeeds

_FULL = (errno.ENOSPC, errno.EDQUOT)
_NOT_LARGER = (errno.EFBIG,)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)
# What is damaged fails in h5py, or later where its content is not what the schema says.
# Files of contwalk that are no databases: the command that writes them, and what they hold.
OTHERS = {
    "contwalk trajectory": ("simulate", "a motion"),
    "contwalk samples": ("sample", "the samples of a Monte Carlo study"),
    "contwalk margins": ("margins", "how far a solution may be pushed"),
}
_RAISED_BY: dict[str, tuple[type[Exception], ...]] = {
    "read": (
        OSError,
        RuntimeError,
        LookupError,
        ValueError,
        TypeError,
        ArithmeticError,
        AttributeError,
        MemoryError,
    ),
    "write": (OSError, RuntimeError, ValueError),
    "create": (OSError, RuntimeError),
}
# Whose journals have names that end so.
JOURNALS = {"_margins.journal": "margins", "_samples.journal": "sample"}
AGAIN = "Restore the file from a copy, or compute it again with contwalk continue FILE --force."


@contextmanager
def failures_of(path: Path, purpose: str) -> Iterator[None]:
    """Turn the errors of h5py and the operating system into a `DatabaseError` about `path`.

    Parameters
    ----------
    path : Path
    purpose : str
        `read`, `write` or `create`.
    """
    try:
        yield
    except _RAISED_BY[purpose] as error:
        raise explained(path, purpose, error) from error


@contextmanager
def creating(path: Path) -> Iterator[None]:
    """As `failures_of`, for a file that is written whole."""
    with failures_of(path, "create"):
        try:
            yield
        except AlreadyThereError:
            raise already_there(path) from None


def already_there(path: Path) -> DatabaseError:
    """The error for a file that would be replaced."""
    return DatabaseError(f"{path} exists.", "Replace it with --force, or choose another output.")


def explained(path: Path, purpose: str, error: Exception) -> DatabaseError:
    """The `DatabaseError` for an exception; h5py often gives the reason only in its text."""
    text = str(error)
    code = getattr(error, "errno", None)
    if os.strerror(errno.EIO) in text:
        text, code = os.strerror(errno.EIO), errno.EIO
    if code in _FULL or os.strerror(errno.ENOSPC) in text or f"errno = {errno.EDQUOT}" in text:
        return disk_full(path, purpose)
    if code in _NOT_LARGER or os.strerror(errno.EFBIG) in text:
        return limited(path, purpose)
    if code == errno.ENAMETOOLONG:
        longest = max(path.parts, key=len)
        return DatabaseError(f"The name {longest[:40]}... is too long for a file.", "Choose a shorter one.")
    if "unable to lock file" in text or "file is already open" in text:
        return DatabaseError(
            f"{path} is in use: another process reads or writes it.",
            "Wait until that run has ended, or stop it; what it has stored is kept.",
        )
    if code in _FORBIDDEN or any(f"errno = {number}" in text for number in _FORBIDDEN):
        return DatabaseError(
            f"{path} cannot be {_done(purpose)}: {os.strerror(code) if code else 'permission denied'}.",
            "Change its permissions, or choose another output.",
        )
    if purpose == "create":
        why = text if code is None else os.strerror(code)
        return DatabaseError(f"{path} cannot be created: {why}.", "Choose another output.")
    if "truncated file" in text:
        return DatabaseError(f"{path} is damaged: its end is missing.", AGAIN)
    if purpose == "write" and not isinstance(error, ValueError):
        return WriteError(
            f"{path} cannot be written ({text}). {_kept(path)}",
            f"Go on with: {again(path)}",
        )
    return DatabaseError(f"{path} is damaged and cannot be {_done(purpose)} ({text}).", AGAIN)


def disk_full(path: Path, purpose: str = "write") -> DatabaseError:
    """The error for a disk without space."""
    return _no_room(path, purpose, "The disk is full", "Free some space")


def limited(path: Path, purpose: str = "write") -> DatabaseError:
    """The error for a file that reaches the largest size that the process may write."""
    return _no_room(path, purpose, "The size of files is limited (ulimit -f)", "Raise the limit")


def _no_room(path: Path, purpose: str, what: str, remedy: str) -> DatabaseError:
    if purpose == "create":
        return DatabaseError(f"{what}: {path} cannot be created.", f"{remedy}, or choose another output.")
    return WriteError(
        f"{what}: {path} cannot grow. {_kept(path)}",
        f"{remedy}, then go on with: {again(path)}",
    )


def _kept(path: Path) -> str:
    """What is not lost where a file cannot be written."""
    return "Every point stored before is kept." if _command(path) == "continue" else "What it holds is kept."


def again(path: Path) -> str:
    """The command that goes on with what a file is of."""
    return f"contwalk {_command(path)} FILE --resume"


def _command(path: Path) -> str:
    return next((command for end, command in JOURNALS.items() if path.name.endswith(end)), "continue")


def check_space(path: Path, size: int, purpose: str = "write") -> None:
    """Refuse to write `size` bytes unless they fit well; to be created, all of the file.

    HDF5 cannot take back a write that failed half-way, so a full disk is noticed before it.
    """
    place, there = (path.parent, 0) if purpose == "create" else (path, path.stat().st_size)
    usage = shutil.disk_usage(place)
    # A system of files that are none, such as /proc, has no room to tell of.
    if usage.total and usage.free < size + RESERVE:
        raise disk_full(path, purpose)
    most = largest_file()
    if most is not None and there + size + RESERVE > most:
        raise limited(path, purpose)


def largest_file() -> int | None:
    """The largest size of a file that this process may write, bytes; None without a limit."""
    if resource is None:
        return None
    soft = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return None if soft == resource.RLIM_INFINITY else soft


def check_output(path: Path, overwrite: bool) -> None:
    """Refuse an output that cannot be created, before anything is computed or written."""
    target_of(path)
    if path.is_dir():
        raise DatabaseError(f"{path} is a directory.", "Name a file in it, such as run.h5.")
    if not path.parent.is_dir():
        raise DatabaseError(
            f"{path} cannot be created: the directory {path.parent} does not exist.",
            "Create it, or choose another output.",
        )
    if path.exists() and not path.is_file():
        raise DatabaseError(f"{path} is not a regular file.", "Choose another output.")
    if path.exists() and not overwrite:
        raise DatabaseError(
            f"{path} exists.", "Continue it with --resume, replace it with --force, or choose another output."
        )


def refuse_existing(paths: Sequence[Path], force: bool, made: bool = False) -> None:
    """Refuse names that cannot be written or stand for files already, before anything is computed.

    `made` says that a folder that is missing will be made.
    """
    for path in paths:
        with failures_of(path, "create"):
            if not made and not path.parent.is_dir():
                raise DatabaseError(
                    f"{path} cannot be created: the directory {path.parent} does not exist.",
                    "Create it, or choose another output.",
                )
            if path.is_dir():
                raise DatabaseError(f"{path} is a directory.", "Choose another output.")
            if path.exists() and not force:
                raise already_there(path)
            target_of(path)


def check_no_link(path: Path) -> None:
    """Refuse a file of contwalk's own that is a link: whoever has put it there means another file."""
    if path.is_symlink() or (path.exists() and not path.is_file()):
        raise DatabaseError(
            f"{path} is a link or no regular file; contwalk writes what it has found there.",
            "Remove it, or choose another output.",
        )


def check_writable(path: Path) -> None:
    """Refuse a file in a folder that takes none, before anything is computed; nothing is left behind."""
    if path.parent.is_dir():
        with failures_of(path, "create"), tempfile.TemporaryFile(dir=path.parent):
            pass


def check_input(path: Path) -> None:
    """Refuse what `check_file` refuses; recognise by its signature what is not HDF5."""
    check_file(path)
    with failures_of(path, "read"), path.open("rb") as file:
        signature = file.read(8)
    if signature != b"\x89HDF\r\n\x1a\n":
        raise not_contwalk(path, "not an HDF5 file")


def check_file(path: Path) -> None:
    """Refuse what is missing or is no file."""
    with failures_of(path, "read"):
        directory, missing = path.is_dir(), not path.exists()
    if directory:
        raise DatabaseError(f"{path} is a directory.", "Name the file of a run in it, such as run.h5.")
    if not missing and not path.is_file():
        raise DatabaseError(f"{path} is not a regular file.", "Name the file of a run, such as run.h5.")
    if missing:
        raise DatabaseError(f"{path} does not exist.", f"Name the file of a run. {_files_near(path)}")


def _files_near(path: Path) -> str:
    """What may have been meant: runs write to the current directory, names in run files begin at the file."""
    namesake = Path(path.name)
    if namesake.is_file():
        return f"One of this name is in the current directory: {namesake.absolute()}."
    near = sorted(other.name for other in path.parent.glob("*.h5")) if path.parent.is_dir() else []
    return f"In its directory are: {', '.join(near)}." if near else "Its directory holds no .h5 file."


def not_contwalk(path: Path, what: str, form: str = "") -> DatabaseError:
    """The error for a file of something else; `form` is what contwalk itself has written into it."""
    if form in OTHERS:
        command, holds = OTHERS[form]
        table = path.with_suffix(".csv").name
        return DatabaseError(
            f"{path} holds no branches: it is {holds} that contwalk {command} has written.",
            f"Its numbers are in {table} beside it; in Python, "
            f"contwalk.storage.trajectory.read_{form.split()[-1]} reads it.",
        )
    return DatabaseError(
        f"{path} is not a contwalk database: it is {what}.",
        "Name a file that contwalk continue has written.",
    )


def _done(purpose: str) -> str:
    return {"read": "read", "write": "written", "create": "created"}[purpose]
