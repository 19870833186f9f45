"""Files that a command writes for a user to go on with; none that exists is replaced."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from contwalk.errors import ContwalkError


def write_new(files: Mapping[Path, str]) -> None:
    """Write all of these texts, or none.

    Raises
    ------
    ContwalkError
        If one exists, or cannot be written.
    """
    if len({path.resolve() for path in files}) < len(files):
        raise ContwalkError("Two files have one name.", "Give each its own.")
    for path in files:
        if path.exists():
            raise ContwalkError(f"{path} exists.", "Give another name, or remove it first.")
    written: list[Path] = []
    for path, text in files.items():
        try:
            with path.open("x", encoding="utf-8") as file:
                written.append(path)
                file.write(text)
        except OSError as error:
            for made in written:
                made.unlink(missing_ok=True)
            raise ContwalkError(
                f"{path} cannot be written: {error.strerror}.", "Give another name, or free some space."
            ) from None


def relative_to_run_file(plugin: str, run_file: Path) -> str:
    """The plugin's path as the run file must say it."""
    try:
        path = Path(os.path.relpath(Path(plugin).resolve(), run_file.resolve().parent)).as_posix()
    except ValueError:  # on another drive
        return Path(plugin).resolve().as_posix()
    return path if path.startswith("../") else f"./{path}"
