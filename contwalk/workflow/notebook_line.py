"""A line in a notebook's cell while a study is computed: the branch, where it is, and how far."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

from contwalk.branch import BranchInfo
from contwalk.number_words import plural
from contwalk.workflow.reporter import NoteKeeper, Visited, point_words


class Line:
    """What stands in the cell: a bar and some words, or the words alone where no page shows it."""

    def __init__(self, words: str, part: float | None) -> None:
        self.words, self.part = words, part

    def __repr__(self) -> str:
        return self.words

    def _repr_html_(self) -> str:
        import html  # of notebooks alone

        bar = "" if self.part is None else f'<progress value="{self.part:.3f}" max="1"></progress> '
        return f"<div>{bar}<code>{html.escape(self.words)}</code></div>"


class NotebookLine(NoteKeeper):
    """Keeps one line of a cell up to date, and leaves in it what was computed.

    Parameters
    ----------
    ends : tuple of float
        The range of the free parameter.
    clock : callable, optional
        Seconds. No more than five lines are sent in one: a page that is read over a network waits for each.
    """

    def __init__(self, ends: tuple[float, float], clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._visited, self._clock = Visited(ends), clock
        self._fifth, self._points, self._ended = -1, 0, ""
        self._branches: set[str] = set()
        self._handle: Any = None

    def point(self, info: BranchInfo, parameter: float, step: float, unstable: int, number: int) -> None:
        """Say where it is, if the last words are of another fifth of a second."""
        self._points += 1
        self._branches.add(info.name)
        part, fifth = self._visited.part(info.name, parameter), int(5 * self._clock())
        if fifth != self._fifth:
            self._fifth = fifth
            self._show(Line(point_words(info, parameter, step, unstable, number), part))

    def interrupted(self, sentence: str) -> None:
        """The last words begin with this sentence."""
        self._ended = f"{sentence} "

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave what was computed, if anything was."""
        branches = f"{len(self._branches)} branch{'' if len(self._branches) == 1 else 'es'}"
        if self._handle is not None:
            self._show(Line(f"{self._ended}{plural(self._points, 'point')} of {branches} computed", None))

    def _show(self, line: Line) -> None:
        if self._handle is None:
            from IPython.display import display  # which is there, where a notebook is

            self._handle = display(line, display_id=True)
        else:
            self._handle.update(line)


def watcher(ends: tuple[float, float]) -> NoteKeeper:
    """Who watches a run over this range where nobody else does: the cell of a notebook, else nobody."""
    return NotebookLine(ends) if in_notebook() else NoteKeeper()


def in_notebook() -> bool:
    """Whether this process is the kernel of a notebook: its IPython talks to a page, not to a terminal."""
    python = sys.modules.get("IPython")
    shell = None if python is None else python.get_ipython()
    return getattr(shell, "kernel", None) is not None
