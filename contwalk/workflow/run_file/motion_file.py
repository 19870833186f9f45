"""What the run files of `contwalk simulate` and `contwalk sample` have in common."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from contwalk.system import System
from contwalk.workflow.file_names import beside
from contwalk.workflow.run_file.settings import FigureSpec
from contwalk.workflow.run_file.starts import StartSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionFile:
    """A checked run file for motions from a start.

    Parameters
    ----------
    path, text, overrides
        The file as the user gave it, its content, and the `--set` values.
    system_reference, system : str, System
    start : StartSpec
        Where the motion begins; its `parameters` are those of the motion.
    output : Path
        The base of the names of all files written: `X.h5` stands for `X_trajectory.h5` and so on.
    figures : tuple of FigureSpec
    """

    path: Path
    text: str
    overrides: tuple[str, ...]
    system_reference: str
    system: System
    start: StartSpec
    output: Path
    figures: tuple[FigureSpec, ...]

    def file(self, what: str) -> Path:
        """The file of this ending, as `trajectory.h5`."""
        return beside(self.output, what)
