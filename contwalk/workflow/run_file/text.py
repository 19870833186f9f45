"""The text of a run file from the disk."""

from __future__ import annotations

from pathlib import Path

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.document import MAX_CHARACTERS


def text_of_file(path: Path, name: str) -> str:
    """The file's text; a `RunFileError` for whatever cannot be read as one."""
    try:
        with path.open("rb") as file:
            raw = file.read(4 * MAX_CHARACTERS + 1)
    except FileNotFoundError:
        raise RunFileError(f"The run file {name} does not exist.", "Check the name.") from None
    except IsADirectoryError:
        raise RunFileError(f"{name} is a directory, not a run file.", "Give a file in it.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RunFileError(f"The run file {name} cannot be read: {reason}.", "Check the name.") from None
    if raw.startswith(b"\x89HDF"):
        raise RunFileError(
            f"{name} is a database, not a run file.", "See it with contwalk show; a run file is YAML text."
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise RunFileError(
            f"{name}, line {line}: this is not UTF-8 text.", "A run file is YAML text, saved as UTF-8."
        ) from None
