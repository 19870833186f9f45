"""Results kept line by line while a study of many runs goes on: a killed one loses those it was working on.

A journal is text: a line for what the study is, then one for each result in its order, each with a checksum.
It belongs to the study alone and is removed when its files are written.
"""

from __future__ import annotations

import json
import os
import warnings
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from contwalk.errors import ContwalkError, DatabaseError, WriteError
from contwalk.files.locking import lock
from contwalk.storage.failures import again, check_no_link, failures_of, refuse_existing

# Under this, lines tell what results are made with: that for what the study is, and others who go on with it.
_MADE = "made with"


class Journal:
    """An open journal.

    Parameters
    ----------
    path : Path
    identity : mapping
        What the study is: plain values. Results of another one are not taken up.
    resume : bool
        Go on after the results that are there; else begin anew.
    made : mapping, optional
        What last digits hang on, as versions and the kind of processor.

    Attributes
    ----------
    kept : list of dict
        The results that were there, in their order.
    made : list of dict
        What that was of those who made them.

    Raises
    ------
    DatabaseError
        If it is of another study, or does not tell of which; if it cannot be written; if another process
        has it.

    Warns
    -----
    UserWarning
        If it is damaged in its midst: what it holds from there on is computed again.
    """

    def __init__(
        self, path: Path, identity: Mapping[str, Any], resume: bool, made: Mapping[str, Any] | None = None
    ) -> None:
        self.path = path
        self.made: list[dict[str, Any]] = []
        self.kept: list[dict[str, Any]] = []
        with failures_of(path, "create"):
            check_no_link(path)
            path.touch()
            self._lock = lock(path)
            try:
                self._open(identity, path.read_bytes() if resume else b"", dict(made or {}))
            except BaseException:
                self._lock.release()
                raise

    def _open(self, identity: Mapping[str, Any], there: bytes, made: dict[str, Any]) -> None:
        """Take up what is there, and begin where it ends."""
        lines = list(_sound_lines(self.path, there))
        self.made = [entry.pop(_MADE) for entry, _ in lines if _MADE in entry]
        if lines and lines[0][0] != dict(identity):
            differing = _differing(lines[0][0], identity)
            raise DatabaseError(
                f"{self.path} holds results of another study; what differs: {differing}.",
                "Undo the change, or begin anew with --force.",
            )
        self.kept = [entry for entry, _ in lines[1:] if entry]
        end = lines[-1][1] if lines else 0
        self._file = self.path.open("r+b")
        self._file.truncate(end)
        self._file.seek(end)
        if not lines:
            self.add({**identity, _MADE: made})
        elif made not in self.made:
            self.add({_MADE: made})

    def add(self, result: Mapping[str, Any]) -> None:
        """Keep one more result; it is on the disk when this returns."""
        with failures_of(self.path, "write"):
            self._file.write(_line(result))
            self._file.flush()
            os.fsync(self._file.fileno())

    def remove(self) -> None:
        """Close and delete it: what it kept is in other files."""
        self._file.close()
        self.path.unlink(missing_ok=True)
        self._lock.release()

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with suppress(OSError):  # what the disk did not take was told where it was written
            self._file.close()
        self._lock.release()


@contextmanager
def going_on_from(journal: Path) -> Iterator[None]:
    """What is computed is in a journal: where its files cannot be written, that and how to go on is told.

    Raises
    ------
    WriteError
    """
    try:
        yield
    except ContwalkError as error:
        raise WriteError(
            f"{error.sentence} What was found is kept in {journal}.",
            f"Mend that, then go on with: {again(journal)}",
        ) from error


def check_stopped(journal: Path, files: Sequence[Path], resume: bool, force: bool) -> None:
    """Refuse to go over what a study has left: its files, or the journal of one that was stopped.

    Raises
    ------
    DatabaseError
    """
    if journal.exists() and not (resume or force):
        raise DatabaseError(
            f"{journal} holds what a study that was stopped has found.",
            "Go on with --resume, or begin anew with --force.",
        )
    if resume and not force and not journal.exists() and any(file.exists() for file in files):
        raise DatabaseError(
            f"There is nothing to go on with: {journal} does not exist, and the study's files do. "
            "They were written at its end.",
            "Leave --resume out and choose another output, or compute them again with --force.",
        )
    # Files beside a journal were being written when the study was stopped.
    refuse_existing(files, force or (resume and journal.exists()))


def check_still_new(journal: Journal, files: Sequence[Path], force: bool) -> None:
    """Refuse to go over what another process has written while this one got ready to begin.

    Raises
    ------
    DatabaseError
    """
    try:
        refuse_existing(files, force or bool(journal.kept))
    except DatabaseError:
        journal.remove()
        raise


def _line(entry: Mapping[str, Any]) -> bytes:
    text = json.dumps(dict(entry), sort_keys=True).encode()
    return f"{zlib.crc32(text):08x} ".encode() + text + b"\n"


def _sound_lines(path: Path, content: bytes) -> Iterator[tuple[dict[str, Any], int]]:
    """The entries and where each ends, up to the first that is damaged; a last line that is not whole was
    being written.
    """
    place = 0
    for line in content.splitlines(keepends=True):
        begin, place = place, place + len(line)
        if not line.endswith(b"\n") and place == len(content):
            return
        if line[:9] != f"{zlib.crc32(line[9:-1]):08x} ".encode():
            if begin == 0:  # of which study the others are is not known
                raise DatabaseError(
                    f"{path} is damaged at byte 0.", "Begin anew with --force, or restore it from a copy."
                )
            warnings.warn(_lost_from(path, begin, content), stacklevel=2)
            return
        yield json.loads(line[9:-1]), place


def _lost_from(path: Path, begin: int, content: bytes) -> str:
    before, behind = content[:begin].count(b"\n") - 1, content[begin:].count(b"\n")
    return (
        f"{path} is damaged at byte {begin}: the {before} results before that are kept, what followed "
        f"({behind} lines) is computed again."
    )


def _differing(stored: Mapping[str, Any], identity: Mapping[str, Any]) -> str:
    names = [name for name in {**stored, **identity} if stored.get(name) != identity.get(name)]
    return ", ".join(sorted(names))
