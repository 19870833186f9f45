"""The system that a database was computed with, if it can still be loaded."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from contwalk.errors import ContwalkError

if TYPE_CHECKING:
    from contwalk.storage import RunHeader
    from contwalk.system import System


def system_of(header: RunHeader, database: Path) -> System:
    """The system of a run.

    Parameters
    ----------
    header : RunHeader
    database : Path
        A plugin file is looked for where the run file was, then beside the database.

    Raises
    ------
    ContwalkError
        If it cannot be loaded; the sentence says why.
    """
    from contwalk.system import load_system

    reference = _reference(header)
    problem: Exception | None = None
    for base in _bases(header, database):
        try:
            return load_system(reference, dict(header.model), base)
        except Exception as error:  # a plugin may have changed, or raise anything
            problem = problem or error
    raise ContwalkError(
        f"The system '{reference}' of {database} cannot be loaded: {problem}",
        "Install it, or put its plugin file beside the database.",
    )


def _reference(header: RunHeader) -> str:
    """What the run file said after `system:`."""
    from contwalk.workflow.yaml_lines import parse_yaml

    if "system_reference" in header.provenance:
        return str(header.provenance["system_reference"])
    try:
        data = parse_yaml(header.config, "the stored run file")[0]
    except ContwalkError:
        data = None
    return str(data.get("system", header.system)) if isinstance(data, dict) else header.system


def _bases(header: RunHeader, database: Path) -> Iterator[Path]:
    if "run_file_directory" in header.provenance:
        yield Path(str(header.provenance["run_file_directory"]))
    yield database.resolve().parent
