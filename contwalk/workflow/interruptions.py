"""Processes are begun so that Ctrl-C, which a terminal sends to all of them, is left to the one called."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def deaf() -> Iterator[None]:
    """Processes that are begun here never hear of an interruption; this one does as soon as it is left.

    A worker that ignores it by itself would do so only once it has imported what it needs.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
