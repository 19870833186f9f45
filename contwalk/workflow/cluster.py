"""A cluster of dask.distributed as what computes: for `--scheduler`."""

from __future__ import annotations

import importlib
import importlib.util
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from contwalk.errors import ContwalkError

ADDRESS = re.compile(r"(inproc://.+|.+:\d+)/?")
WAIT = 10.0  # seconds, for the scheduler to answer
# A task whose worker dies is computed again by another one, so many times.
MOST_LOST = 3

Shared = TypeVar("Shared")
Task = TypeVar("Task")
Result = TypeVar("Result")


class Cluster:
    """A client of dask.distributed as an executor: what its workers hold is computed again if they die.

    Parameters
    ----------
    client : distributed.Client
    """

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, function: Callable[..., Result], *arguments: Any) -> Any:
        """A future of one result."""
        return self._client.submit(function, *arguments, pure=False, retries=MOST_LOST)

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task], /) -> Iterator[Result]:
        """Results in the order of the tasks."""
        return self._results(function, list(tasks))

    def map_shared(
        self, function: Callable[[Shared, Task], Result], shared: Shared, tasks: Sequence[Task]
    ) -> Iterator[Result]:
        """As `map` of a function of what is shared, too, which goes to each worker once.

        It is a result itself, which the scheduler has made anew: data that a client scatters is lost with
        the workers that hold it.
        """
        return self._results(function, [self.submit(_itself, shared)] * len(tasks), tasks)

    def _results(self, function: Callable[..., Result], *arguments: Sequence[Any]) -> Iterator[Result]:
        futures = self._client.map(function, *arguments, pure=False, retries=MOST_LOST)
        try:
            while futures:
                yield futures[0].result()
                del futures[0]
        finally:
            self._client.cancel(futures)


def _itself(shared: Shared) -> Shared:
    return shared


@contextmanager
def executor_at(address: str | None) -> Iterator[Cluster | None]:
    """An executor of the cluster whose scheduler is at an address; None where no address is given.

    Raises
    ------
    ContwalkError
        If it is no address, dask.distributed is not installed, or no scheduler answers.
    """
    if address is None:
        yield None
        return
    if not ADDRESS.fullmatch(address):
        raise ContwalkError(
            f"--scheduler is '{address}', which is no address: it names no port.",
            "Give the address that dask scheduler tells, such as tcp://10.0.0.1:8786.",
        )
    if importlib.util.find_spec("distributed") is None:
        raise ContwalkError(
            "--scheduler needs dask.distributed, which is not installed.",
            "Install it with pip install 'contwalk[distributed]', here and on every worker, or use --jobs.",
        )
    distributed = importlib.import_module("distributed")
    try:
        client = distributed.Client(address, timeout=WAIT, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ContwalkError(
            f"No scheduler of dask.distributed answers at {address}: {error}.",
            "Start one with dask scheduler, its workers with dask worker ADDRESS, and give the address that "
            "it tells, such as tcp://10.0.0.1:8786.",
        ) from error
    with client:
        yield Cluster(client)
