"""Many runs that do not depend on each other: here, in processes, or wherever an executor computes them.

A run is a pure function of its task and of what all tasks share: all can be pickled, and a run may be
computed twice, or again where a worker was lost. Results come in the order of the tasks whatever computes
them, so that what is made of them is the same to the last bit. What is shared goes to each process once.
"""

from __future__ import annotations

import signal
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from itertools import islice
from multiprocessing import get_context, parent_process
from types import TracebackType
from typing import Any, Generic, Protocol, TypeVar

from contwalk.errors import ContwalkError
from contwalk.workflow.interruptions import deaf
from contwalk.workflow.process_end import end_process, refuse_exit
from contwalk.workflow.watching import on_stderr, watching

Shared = TypeVar("Shared")
Task = TypeVar("Task")
Result = TypeVar("Result")

# Tasks that are handed out for each process, done or not, so that none waits for the first of them.
AHEAD = 8
# A task whose worker dies so often is what kills it.
MOST_LOST = 3


class LostWorkersError(ContwalkError):
    """Processes that ended again and again while they computed the same."""

    exit_code = 1


class Executor(Protocol):
    """Anything with `map`: a process pool, `contwalk.workflow.cluster.Cluster`, an MPI pool.

    One that has `map_shared(function, shared, tasks)` too sends what is shared once, not with each task.
    """

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task], /) -> Iterable[Result]:
        """Results in the order of the tasks."""


class Runs(Generic[Shared, Task, Result]):
    """Runs of one study. Its processes begin with the first runs that need them, and stay until it is left.

    Parameters
    ----------
    function : callable
        Of a module, so that it can be pickled for other processes: of what is shared, and of a task.
    shared : object
    jobs : int
        Processes; 1 computes here.
    executor : Executor, optional
        Computes instead of processes of this machine.
    """

    def __init__(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        jobs: int = 1,
        executor: Executor | None = None,
    ) -> None:
        self._function, self._shared, self._jobs, self._executor = function, shared, jobs, executor
        self._pool: ProcessPoolExecutor | None = None
        self._processes = 0

    def __enter__(self) -> Runs[Shared, Task, Result]:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._leave()

    def in_order(self, tasks: Sequence[Task]) -> Iterator[Result]:
        """Results in the order of the tasks.

        Raises
        ------
        LostWorkersError
            If a task has killed its process again and again.
        """
        if self._executor is not None:
            yield from self._elsewhere(self._executor, tasks)
        elif self._jobs == 1 or len(tasks) < 2:
            for task in tasks:
                yield self._function(self._shared, task)
        else:
            yield from self._in_processes(tasks)

    def _elsewhere(self, executor: Executor, tasks: Sequence[Task]) -> Iterable[Result]:
        if hasattr(executor, "map_shared"):
            found: Iterable[Result] = executor.map_shared(self._function, self._shared, tasks)
            return found
        return executor.map(partial(self._function, self._shared), tasks)

    def _in_processes(self, tasks: Sequence[Task]) -> Iterator[Result]:
        """With a lost process its whole pool is lost, and what was not done is done again."""
        done, lost = 0, 0
        while done < len(tasks):
            begun = done
            try:
                for result in self._in_pool(tasks[done:]):
                    done += 1
                    yield result
            except BrokenProcessPool as error:
                self._leave()
                lost = lost + 1 if done == begun else 1
                if lost >= MOST_LOST:
                    raise LostWorkersError(
                        f"A worker process has died {lost} times at run {done}, without a word.",
                        "Was it killed for its memory? Try --jobs 1, which shows where it ends.",
                    ) from error

    def _in_pool(self, tasks: Sequence[Task]) -> Iterator[Result]:
        pool, given = self._pool_for(len(tasks)), iter(tasks)
        with deaf():  # the first task begins the processes
            waiting: deque[Future[Any]] = deque(
                pool.submit(_run, task) for task in islice(given, AHEAD * self._jobs)
            )
        try:
            while waiting:
                yield waiting.popleft().result()
                waiting.extend(pool.submit(_run, task) for task in islice(given, 1))
        finally:
            for future in waiting:
                future.cancel()

    def _pool_for(self, tasks: int) -> ProcessPoolExecutor:
        """Processes, no more than there are tasks."""
        count = min(self._jobs, tasks)
        if count > self._processes:
            self._leave()
        if self._pool is None:
            given = get_context("spawn"), _prepare, (self._function, self._shared)
            self._pool, self._processes = ProcessPoolExecutor(count, *given), count
        return self._pool

    def _leave(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool, self._processes = None, 0


# In a worker: what makes a result of a task.
_FUNCTION: list[Callable[[Any], Any]] = []


def _prepare(function: Callable[[Any, Any], Any], shared: Any) -> None:
    """A worker keeps what its tasks share, leaves Ctrl-C to the process that it works for, ends with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    refuse_exit()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    _FUNCTION[:] = [partial(function, shared)]


def _end_with_parent() -> None:
    """End this process when the one that it works for is killed: no pool is there to end it."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        end_process(1)


def _run(task: Any) -> Any:
    with watching(on_stderr):
        return _FUNCTION[0](task)
