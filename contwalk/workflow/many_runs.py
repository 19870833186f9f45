"""Many runs that do not depend on each other: here, in processes, or wherever an executor computes them.

A run is a pure function of its task: both can be pickled, and it may be computed twice, or again where a
worker was lost. Results come in the order of the tasks whatever computes them, so that what is made of them
is the same to the last bit.
"""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import get_context
from typing import Any, Protocol, TypeVar

from contwalk.errors import ContwalkError

Task = TypeVar("Task")
Result = TypeVar("Result")

# Tasks that are handed out for each process, done or not, so that none waits for the first of them.
AHEAD = 8
# A task whose worker dies so often is what kills it.
MOST_LOST = 3


class Executor(Protocol):
    """Anything with `map`: a process pool, `dask.distributed.Client.get_executor()`, an MPI pool."""

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task], /) -> Iterable[Result]:
        """Results in the order of the tasks."""


def in_order(
    function: Callable[[Task], Result],
    tasks: Sequence[Task],
    jobs: int = 1,
    executor: Executor | None = None,
) -> Iterator[Result]:
    """Results in the order of the tasks.

    Parameters
    ----------
    function : callable
        Of a module, so that it can be pickled for other processes.
    tasks : sequence
    jobs : int
        Processes; 1 computes here.
    executor : Executor, optional
        Computes instead of processes of this machine.

    Raises
    ------
    ContwalkError
        If a task has killed its process again and again.
    """
    if executor is not None:
        yield from executor.map(function, tasks)
    elif jobs == 1 or len(tasks) < 2:
        yield from map(function, tasks)
    else:
        yield from _in_processes(function, tasks, min(jobs, len(tasks)))


def _in_processes(function: Callable[[Task], Result], tasks: Sequence[Task], jobs: int) -> Iterator[Result]:
    """As `in_order`; with a lost process its whole pool is lost, and what was not done is done again."""
    done, lost = 0, 0
    while done < len(tasks):
        begun = done
        try:
            for result in _in_pool(function, tasks[done:], jobs):
                done += 1
                yield result
        except BrokenProcessPool as error:
            lost = lost + 1 if done == begun else 1
            if lost >= MOST_LOST:
                raise ContwalkError(
                    f"A worker process has died {lost} times at run {done}, without a word.",
                    "Was it killed for its memory? Try --jobs 1, which shows where it ends.",
                ) from error


def _in_pool(function: Callable[[Task], Result], tasks: Sequence[Task], jobs: int) -> Iterator[Result]:
    given = iter(tasks)
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_prepare) as pool:
        waiting: deque[Future[Any]] = deque(
            pool.submit(function, task) for task in islice(given, AHEAD * jobs)
        )
        try:
            while waiting:
                yield waiting.popleft().result()
                waiting.extend(pool.submit(function, task) for task in islice(given, 1))
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _prepare() -> None:
    """A worker leaves Ctrl-C to the process that it works for."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
