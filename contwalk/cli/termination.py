"""SIGTERM as an interruption: what is stored stays whole, and the way to go on is told."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Termination:
    """Whether SIGTERM came."""

    came = False


@contextmanager
def termination() -> Iterator[Termination]:
    """Within it, SIGTERM raises `KeyboardInterrupt`, as Ctrl-C does."""
    seen = Termination()
    if threading.current_thread() is not threading.main_thread():  # only it is told of signals
        yield seen
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        seen.came = True
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield seen
    finally:
        signal.signal(signal.SIGTERM, before)
