"""A cluster of dask.distributed as what computes: for `--scheduler`."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from contwalk.errors import ContwalkError

WAIT = 10.0  # seconds, for the scheduler to answer
# A task whose worker dies is computed again by another one, so many times.
MOST_LOST = 3


@contextmanager
def executor_at(address: str | None) -> Iterator[Any]:
    """An executor of the cluster whose scheduler is at an address; None where no address is given.

    Raises
    ------
    ContwalkError
        If dask.distributed is not installed, or no scheduler answers.
    """
    if address is None:
        yield None
        return
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
        yield client.get_executor(pure=False, retries=MOST_LOST)
