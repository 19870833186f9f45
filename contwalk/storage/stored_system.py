"""The system that a run was computed with: when its code may run, and whether it is still the same.

Reading a database runs nothing by itself. What has to be computed again (segments of an orbit, its motion, a
drawing of the machine) needs the system: an installed one whose files are those of the run is loaded; the
code of a plugin file, or of a system that has changed since, runs only for one who trusts it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contwalk.errors import ContwalkError
from contwalk.system import System, load_system
from contwalk.system.loading import is_path, list_systems, plugin_files
from contwalk.system.plugin_files import hash_of

TRUST = "Give --trust (in Python trust=True) if you trust its code."


class NotTrusted(ContwalkError):
    """A system whose code is not run without being trusted."""


@dataclass(frozen=True, eq=False)
class StoredSystem:
    """A loaded system.

    Parameters
    ----------
    system : System
    changed : str
        A sentence that says so where its files are not those that the run was computed with; else empty.
    """

    system: System
    changed: str = ""


def system_of_run(
    provenance: Mapping[str, Any], model: Mapping[str, Any], name: str, database: Path, trust: bool = False
) -> StoredSystem:
    """The system of a run.

    Parameters
    ----------
    provenance, model, name
        Those of the run's header.
    database : Path
        A plugin file is looked for where the run file was, then beside the database; one whose files are
        those of the run comes first.
    trust : bool
        Whether the code of a plugin file, or of a system that has changed since the run, may run.

    Raises
    ------
    NotTrusted
        If code would run that is not trusted; none did.
    ContwalkError
        If the system cannot be loaded; the sentence says why.
    """
    reference = str(provenance.get("system_reference", name))
    if is_path(reference) and not trust:
        raise NotTrusted(
            f"The system of {database} is the plugin file {reference}, which is not run without being asked.",
            TRUST,
        )
    base, changed = _place(provenance, reference, database)
    if changed and not trust:
        raise NotTrusted(changed, f"It is not run without being asked. {TRUST}")
    try:
        return StoredSystem(load_system(reference, dict(model), base), changed)
    except (Exception, SystemExit) as error:  # a plugin may have changed, or raise anything
        raise ContwalkError(
            f"The system '{reference}' of {database} cannot be loaded: {error}",
            f"Install it, or put its plugin file beside the database. {changed}".strip(),
        ) from error


def _place(provenance: Mapping[str, Any], reference: str, database: Path) -> tuple[Path | None, str]:
    """Where a plugin's path begins, and the sentence on what has changed there."""
    bases: list[Path | None] = list(_bases(provenance, database)) if is_path(reference) else [None]
    stored = str(provenance.get("plugin_sha256", ""))
    found = [(base, files) for base in bases if (files := plugin_files(reference, base))]
    for base, files in found:
        if hash_of(files) == stored:
            return base, ""
    if not found and (is_path(reference) or not stored or reference not in list_systems()):
        return bases[0], ""  # loading it says that there is none
    base, files = found[0] if found else (None, {})
    before = dict(provenance.get("plugin_files", {}))
    differing = [name for name in {**before, **files} if before.get(name) != files.get(name)]
    which = f" ({', '.join(differing)})" if before else ""
    what = "plugin" if is_path(reference) else "installed system"
    return base, f"The {what} {reference} has changed since {database} was computed{which}."


def _bases(provenance: Mapping[str, Any], database: Path) -> Iterator[Path]:
    if "run_file_directory" in provenance:
        yield Path(str(provenance["run_file_directory"]))
    yield database.resolve().parent
