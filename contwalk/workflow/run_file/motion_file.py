"""What the run files of `contwalk simulate` and `contwalk sample` have in common."""

from __future__ import annotations

from dataclasses import dataclass

from contwalk.workflow.run_file.checked_file import CheckedFile
from contwalk.workflow.run_file.figures import FigureSpec
from contwalk.workflow.run_file.starts import StartSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionFile(CheckedFile):
    """A checked run file for motions from a start.

    Parameters
    ----------
    start : StartSpec
        Where the motion begins; its `parameters` are those of the motion.
    figures : tuple of FigureSpec
    """

    start: StartSpec
    figures: tuple[FigureSpec, ...]
