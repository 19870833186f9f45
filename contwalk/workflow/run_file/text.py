"""A run file from the disk to data: what can be wrong before any key is looked at."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from contwalk.errors import RunFileError
from contwalk.workflow.run_file.model import RunModel
from contwalk.workflow.run_file.overrides import apply_override
from contwalk.workflow.run_file.yaml_lines import MAX_CHARACTERS, Document, parse_yaml, shown


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


def document_of(text: str, name: str, overrides: Sequence[str]) -> Document:
    """The data of a run file, a mapping, with the `--set` values put in."""
    data, lines = parse_yaml(text, name)
    if data is None:
        raise RunFileError(
            f"{name} is empty.",
            "Give at least system, start and continue; contwalk init SYSTEM writes a file.",
        )
    if not isinstance(data, dict):
        raise RunFileError(
            f"{name}, line 1: the file is {shown(data)}, not a mapping of keys.",
            f"Write lines KEY: VALUE. Allowed: {', '.join(RunModel.known_keys())}.",
        )
    document = Document(name, data, lines)
    for override in overrides:
        apply_override(document, override)
    return document
