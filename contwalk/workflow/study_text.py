"""A run file as what other processes are told of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from contwalk.errors import PluginError
from contwalk.system import System


class ReadFile(Protocol):
    """A checked run file of any command."""

    @property
    def text(self) -> str:
        """As it was read."""

    @property
    def path(self) -> Path:
        """Where it stands."""

    @property
    def overrides(self) -> tuple[str, ...]:
        """What was set beside it."""

    @property
    def system(self) -> System:
        """The machine."""


@dataclass(frozen=True)
class StudyText:
    """A run file as data that any process understands, with the hash of its plugin's source."""

    text: str
    path: str
    overrides: tuple[str, ...]
    source: str

    @classmethod
    def of(cls, run_file: ReadFile) -> StudyText:
        """That of a run file that was read."""
        path = str(run_file.path.resolve())
        return cls(run_file.text, path, run_file.overrides, str(run_file.system.source))

    def check(self, reference: str, system: System) -> None:
        """Refuse another plugin than the one that the run began with.

        Raises
        ------
        PluginError
        """
        if str(system.source) != self.source:
            raise PluginError(
                f"The plugin '{reference}' is not the one that the run began with: its source has changed, "
                "or another version is installed where runs are computed.",
                "Install the same version everywhere, and start the run again.",
            )
