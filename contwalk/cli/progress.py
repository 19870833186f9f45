"""What a run says while it computes: a live line on a terminal, a line a minute elsewhere."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Any

from contwalk.branch import Branch, BranchInfo, SpecialPoint
from contwalk.cli.terminal import console
from contwalk.number_words import plural
from contwalk.workflow.reporter import NoteKeeper, Visited, point_words


class ProgressLine(NoteKeeper):
    """A live line on stderr: branch, parameter, step, unstable count, and the part of the range that is done.

    Parameters
    ----------
    ends : tuple of float
        The range of the free parameter.
    """

    def __init__(self, ends: tuple[float, float]) -> None:
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        super().__init__()
        self._visited = Visited(ends)
        columns = (
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=20),
            TimeElapsedColumn(),
        )
        self._progress = Progress(*columns, console=console(stderr=True), transient=True)
        self._task: Any = None

    def __enter__(self) -> ProgressLine:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def branch_began(self, info: BranchInfo) -> None:
        """A new bar for each branch."""
        if self._task is not None:
            self._progress.remove_task(self._task)
        self._task = self._progress.add_task(f"{info.name}  {info.origin}", total=1.0)

    def point(self, info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> None:
        """Redraw the line."""
        part = self._visited.part(info.name, parameter)
        if self._task is not None:
            text = point_words(info, parameter, step, unstable, number)
            self._progress.update(self._task, description=text, completed=part)

    def special(self, info: BranchInfo, point: SpecialPoint) -> None:
        """A line that stays for each special point."""
        if point.label != "EP":
            value = point.parameters.get(info.free[0])
            at = "" if value is None else f" at {info.free[0]} = {value:.10g}"
            self._progress.console.print(f"{info.name}  {point.label}{at}")


class LineAMinute(NoteKeeper):
    """A line a minute on stderr, however long a point takes: how long, which branch, where, how fast.

    Parameters
    ----------
    wait : callable, optional
        Waits for so many seconds, or until the run has ended; whether it has.
    """

    def __init__(self, wait: Callable[[float], bool] | None = None) -> None:
        super().__init__()
        self._ended = threading.Event()
        self._wait = wait or self._ended.wait
        self._teller = threading.Thread(target=self._tell, daemon=True)
        self._where, self._branches = "no point yet", 0
        self._points = 0

    def __enter__(self) -> LineAMinute:
        self._teller.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._teller.join()

    def branch_began(self, info: BranchInfo) -> None:
        """The branch that is told of."""
        self._where = f"{info.name}  {info.origin}".rstrip()

    def point(self, info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> None:
        """Where it is."""
        self._points += 1
        self._where = f"{info.name}  {info.free[0]} = {parameter:.6g}  point {number}"

    def branch_ended(self, branch: Branch) -> None:
        """One more is done."""
        self._branches += 1

    def _tell(self) -> None:
        from contwalk.cli.entry import say

        minutes = before = 0
        while not self._wait(60.0):
            minutes, points = minutes + 1, self._points
            line = f"{minutes} min: {self._where}, {plural(points - before, 'point')} a minute"
            before = points
            with suppress(OSError):  # nobody reads
                say(f"{line}, branches done: {self._branches}")


def reporter_for(ends: tuple[float, float], quiet: bool) -> NoteKeeper:
    """The live line where somebody watches a terminal, a line a minute elsewhere; or only the notes."""
    if quiet:
        return NoteKeeper()
    return ProgressLine(ends) if sys.stdout.isatty() and sys.stderr.isatty() else LineAMinute()
