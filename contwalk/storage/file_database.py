"""What every database in a file offers: how it is made and opened, and the system of its run."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from pathlib import Path
from typing import Any, Self

from contwalk.branch import BranchInfo
from contwalk.errors import DatabaseError
from contwalk.storage.database import Database, RunHeader
from contwalk.storage.stored_system import StoredSystem, system_of_run
from contwalk.system import System


class FileDatabase(Database):
    """A `Database` in a file; a storage backend is a subclass of it.

    Attributes
    ----------
    trust : bool
        Whether `system` may run code that is not trusted by itself.
    """

    trust = False

    @classmethod
    @abstractmethod
    def create(cls, path: str | Path, header: RunHeader, overwrite: bool = False) -> Self:
        """Create a file and open it for writing.

        An existing file is replaced only when the new one is whole.

        Raises
        ------
        DatabaseError
            If the output exists (unless `overwrite`), is a directory, is in use, or cannot be written.
        """

    @classmethod
    @abstractmethod
    def open(cls, path: str | Path, writable: bool = False) -> Self:
        """Open a file; for writing, nothing that a killed run left half-written stays.

        Raises
        ------
        DatabaseError
            If the file is missing, is not a contwalk database, has a newer schema, or is damaged; for writing
            also if another process writes it.
        """

    @property
    @abstractmethod
    def path(self) -> Path:
        """The file."""

    def stored_system(self, trust: bool = False) -> StoredSystem:
        """The system of this run, loaded; see `system_of_run` for what may be loaded, and what it raises."""
        given = self.header.provenance, self.header.model, self.header.system
        stored = system_of_run(*given, self.path, trust or self.trust)
        self.check_modes(stored.system)
        return stored

    def infos(self) -> list[BranchInfo]:
        """What is true of each branch."""
        return [branch.info for branch in self.branches()]

    def check_modes(self, system: System) -> None:
        """Refuse branches in modes, or with transitions, that a system has not.

        Raises
        ------
        DatabaseError
        """
        modes = {mode.name for mode in system.modes}
        for info in self.infos():
            legs = info.settings.get("legs", ())
            visited = [
                info.settings.get("mode", system.modes[0].name),
                *(passed[0] for passed in legs if passed),
            ]
            unknown = [name for name in visited if name not in modes]
            if unknown or not all(2 < len(passed) < 7 and _leads(system, *passed[:2]) for passed in legs):
                raise DatabaseError(
                    f"Branch {info.name} of {self.path} has modes or transitions that '{system.name}' has "
                    "not.",
                    "Put the plugin back as it was when the database was computed.",
                )

    def system(self, trust: bool = False) -> System:
        """The same as a `System`; a Python warning says where it has changed since the run."""
        stored = self.stored_system(trust)
        if stored.changed:
            warnings.warn(stored.changed, stacklevel=2)
        return stored.system


def _leads(system: System, mode: Any, name: Any) -> bool:
    """Whether a transition leads out of a mode, or one that soft transitions lead to; none has no name."""
    return name == "" or any(source in system.sources(name) for source in system.modes_around(mode))
