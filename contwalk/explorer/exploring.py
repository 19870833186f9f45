"""From a database to its page: what is collected, what is missing, and in which words that is said."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from contwalk.errors import ContwalkError
from contwalk.explorer.charts import chart_of
from contwalk.explorer.diagram import diagram_of
from contwalk.explorer.making import making_of
from contwalk.explorer.motions import branch_part
from contwalk.explorer.packing import packed
from contwalk.explorer.page import written
from contwalk.explorer.pushing import margins_page
from contwalk.explorer.system_of_page import system_or_said
from contwalk.number_words import choices, in_brackets
from contwalk.plotting.quantities import units_of
from contwalk.printable import printable
from contwalk.storage import FileDatabase, open_database
from contwalk.storage.trajectory import is_of_margins
from contwalk.system import System


@dataclass(frozen=True)
class Explored:
    """A page, and sentences on what it does not show."""

    page: str
    missing: tuple[str, ...]


class Found(Protocol):
    """What a study in one call has found, as `cw.diagram` returns it."""

    database: FileDatabase


def explore(db: str | Path | FileDatabase | Found, trust: bool = False) -> str:
    """A database as a page of HTML: see `explored`.

    Parameters
    ----------
    db : str, Path, FileDatabase or what `cw.diagram` returns
        A file, of margins too, or a database that is open.
    trust : bool
        Whether code of a plugin file, or of a system that has changed, may run.

    Returns
    -------
    str
        The same for the same database.
    """
    if isinstance(db, str | Path):
        if is_of_margins(str(db)):
            return margins_page(Path(db), trust)[0]
        with open_database(db, trust) as opened:
            return explored(opened, trust).page
    return explored(db if isinstance(db, FileDatabase) else db.database, trust).page


def explored(
    database: FileDatabase,
    trust: bool = False,
    progress: Callable[[int, int], None] = lambda done, number: None,
    *,
    moving: bool = True,
    watched: str = "",
) -> Explored:
    """The page of a database, with its orbits integrated once more by the system.

    Parameters
    ----------
    database : FileDatabase
    trust : bool
    progress : callable
        Told the number of points that are done, and of all.
    moving : bool
        Whether orbits are integrated once more.
    watched : str
        What changes with the database, of a page that looks for changes; empty for one that stands alone.

    Raises
    ------
    ContwalkError
        If the database cannot be read, or has no branch and is not watched.
    """
    branches = database.branches()
    header = database.header
    missing: list[str] = []
    if not branches and not watched:
        raise ContwalkError(
            f"{database.path} has no branches, so there is nothing to look at.", "Compute some."
        )
    system = _system(database, trust, missing) if moving else None
    missing += [] if moving else ["A run is writing this database: motions are shown when it has ended."]
    units = _units(header.provenance, system)
    number = sum(len(branch) + len(branch.special_points) for branch in branches)
    done = 0

    def one_more() -> None:
        nonlocal done
        done += 1
        progress(done, number)

    parts = {branch.name: branch_part(system, branch, units, one_more) for branch in branches}
    missing += [f"{name}: {text}" for name, part in parts.items() for text in part.missing]
    regions, told = chart_of(system, branches) if system is not None else ("", [])
    missing += told
    head = diagram_of(branches, units)
    head |= {
        "file": database.path.name,
        "system": header.system,
        "model": printable(choices(header.model)),
        "made": [
            printable(str(text)) for key in ("description", "author") if (text := header.provenance.get(key))
        ],
        "notes": [printable(text) for text in dict.fromkeys(database.notes().values())],
        "missing": [printable(text) for text in missing],
        "error": max((part.error for part in parts.values()), default=0.0),
        "states": list(branches[0].info.states) if branches else [],
        "watched": watched,
        "time": f"time{in_brackets(units.get('period', ''))}",
        "making": making_of(header.config, header.provenance, "continue"),
        "command": _command(header.provenance, database.path),
        "draws": system is not None and system.draw is not None,
    }
    blocks = {"head": packed(head)}
    blocks |= {f"words {name}": part.words for name, part in parts.items()}
    blocks |= {f"motions {name}": part.motions for name, part in parts.items() if part.motions}
    blocks |= {f"planes {name}": part.planes for name, part in parts.items() if part.planes}
    blocks |= {"chart": regions} if regions else {}
    title = f"{header.system}: {database.path.name}"
    return Explored(written(title, blocks, connected=bool(watched)), tuple(missing))


def _system(database: FileDatabase, trust: bool, missing: list[str]) -> System | None:
    """The system of the run; None where it may not run or cannot be had, which is then said."""
    return system_or_said(
        lambda: database.stored_system(trust),
        "the motions, the machine, segments and margins of orbits",
        "What is computed with it may differ from what is stored.",
        missing,
    )


def _command(provenance: Mapping[str, Any], path: Path) -> dict[str, str]:
    """Words of the command that goes on from a point, whose name stands for @."""
    run = Path(str(provenance.get("run_file") or f"{path.stem}.yaml")).name
    return {
        "file": shlex.quote(path.name),
        "run": shlex.quote(run),
        "start": shlex.quote(f"start={{from: {path.name}, point: @}}"),
        "output": shlex.quote(f"{path.stem}_@.h5"),
    }


def _units(provenance: Mapping[str, Any], system: System | None) -> Mapping[str, str]:
    """Units by name: as stored, or else the system's."""
    stored = provenance.get("units")
    if stored is not None:
        return {str(name): str(text) for name, text in stored.items()}
    return {} if system is None else units_of(system)
