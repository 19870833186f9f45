"""Branches walked by whatever can call a function elsewhere: a pool of processes, a cluster, an MPI pool."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import suppress
from functools import partial
from typing import Any

from contwalk.diagram.ahead import Message, Task
from contwalk.errors import ContwalkError
from contwalk.workflow.study_text import StudyText
from contwalk.workflow.walking_ahead import failed_elsewhere, walked


class NoExecutor(ContwalkError):
    """What was given calls no functions."""


class Executed:
    """Branches of one run file as calls of a function, whose results are lists of messages.

    Parameters
    ----------
    study : StudyText
    executor : object
        With `submit(function, *arguments)`, whose result has `result()`, as of `concurrent.futures` and dask;
        or with `map(function, items)` alone.
    tell : callable, optional
        Given a sentence where a branch is walked here instead: what is stored does not show it.

    Raises
    ------
    NoExecutor
    """

    def __init__(
        self, study: StudyText, executor: Any, tell: Callable[[str], None] = lambda text: None
    ) -> None:
        if not hasattr(executor, "submit") and not hasattr(executor, "map"):
            raise NoExecutor(
                f"The executor {executor!r} has neither submit nor map.",
                "Give a concurrent.futures executor, a client of dask.distributed, or any object with map.",
            )
        self._study, self._executor, self._tell = study, executor, tell
        self._waiting: dict[Task, None] = {}
        self._futures: dict[Task, Any] = {}
        self._known: dict[Task, list[Message]] = {}
        self._begun = False

    def expect(self, tasks: Sequence[Task]) -> None:
        """These branches are likely to be asked for; none is walked before the first one is."""
        for task in tasks:
            if task not in self._futures and task not in self._known:
                self._waiting[task] = None
        if self._begun and hasattr(self._executor, "submit"):
            self._submit()

    def drop(self, task: Task) -> None:
        """This branch will not be asked for."""
        self._waiting.pop(task, None)
        self._known.pop(task, None)
        future = self._futures.pop(task, None)
        if hasattr(future, "cancel"):
            future.cancel()

    def messages(self, task: Task) -> Iterator[Message]:
        """What is told of a branch, when all of it is known."""
        self._begun = True
        self.expect([task])
        if task not in self._known:
            if task in self._futures:
                self._known[task] = self._result(task)
            else:
                self._map()
        yield from self._known.pop(task)

    def _result(self, task: Task) -> list[Message]:
        """What was found elsewhere; walked here where that has failed, as of a process that was killed."""
        try:
            found: list[Message] = self._futures.pop(task).result()
        except Exception as error:  # of whatever calls functions there
            self._tell(failed_elsewhere(f"{type(error).__name__}: {error}"))
            return walked(self._study, task)
        return found

    def close(self) -> None:
        """Give up what is not wanted any more."""
        for future in self._futures.values():
            if hasattr(future, "cancel"):
                with suppress(Exception):  # of a cluster that is gone
                    future.cancel()
        self._futures.clear()

    def _submit(self) -> None:
        for task in sorted(self._waiting, key=lambda task: task.turn):
            try:
                self._futures[task] = self._executor.submit(walked, self._study, task)
            except Exception as error:  # of a pool that has broken before
                self._futures[task] = Future()
                self._futures[task].set_exception(error)
        self._waiting.clear()

    def _map(self) -> None:
        """All that is expected in one call: without `submit` no more can be asked for until it returns."""
        tasks = sorted(self._waiting, key=lambda task: task.turn)
        found = self._executor.map(partial(walked, self._study), tasks)
        self._known.update(zip(tasks, found, strict=True))
        self._waiting.clear()
