"""What is known of every run file that is not one of branches."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from contwalk.system import System
from contwalk.workflow.file_names import beside


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckedFile:
    """A checked run file.

    Parameters
    ----------
    path, text, overrides
        The file as the user gave it, its content, and the `--set` values.
    system_reference, system : str, System
    output : Path
        The base of the names of all files written: `X.h5` stands for `X_trajectory.h5` and so on.
    """

    path: Path
    text: str
    overrides: tuple[str, ...]
    system_reference: str
    system: System
    output: Path

    def file(self, what: str) -> Path:
        """The file of this ending, as `trajectory.h5`."""
        return beside(self.output, what)
