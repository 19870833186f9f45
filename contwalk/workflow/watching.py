"""Where a plugin is that does not come back: a line after half a minute in one call."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from contwalk.errors import is_of_plugin
from contwalk.workflow.interruptions import deaf


@contextmanager
def watching(tell: Callable[[str], None], after: float = 30.0, every: float = 1.0) -> Iterator[None]:
    """Within it, a plugin's function that this thread has called for so many seconds is told of, once.

    Parameters
    ----------
    tell : callable
    after, every : float
        Seconds after which it is told, and between two looks at where this thread is.
    """
    done = threading.Event()
    outside = sys._getframe(2)  # whose `with` this is, beyond contextlib
    given = threading.get_ident(), outside, tell, after, every, done
    thread = threading.Thread(target=_watch, args=given, daemon=True)
    with deaf():  # signals are for this thread
        thread.start()
    try:
        yield
    finally:
        done.set()
        # What it has looked at is let go by then: one that is ended with the process, while it lets go of an
        # object of h5py, keeps that library's lock, for which the process would wait for ever.
        thread.join()


def on_stderr(line: str) -> None:
    """Tell it on the standard error, as a process does that works for another one."""
    print(line, file=sys.stderr, flush=True)


def _watch(
    watched: int,
    outside: FrameType,
    tell: Callable[[str], None],
    after: float,
    every: float,
    done: threading.Event,
) -> None:
    call, since = None, 0.0
    while not done.wait(every):
        frames = list(_frames_of_plugin(sys._current_frames().get(watched), outside))
        outermost = frames[-1] if frames else None
        if outermost is not call:
            call, since = outermost, time.monotonic()
        elif frames and time.monotonic() - since >= after:
            place = f"{frames[0].f_code.co_filename}, line {frames[0].f_lineno}"
            tell(f"note: the plugin has not come back for {after:g} s; it is at {place}. Ctrl-C ends it.")
            since = float("inf")


def _frames_of_plugin(frame: FrameType | None, outside: FrameType) -> Iterator[FrameType]:
    """Those of a plugin, the innermost first, that were called within a frame."""
    while frame is not None and frame is not outside:
        if is_of_plugin(frame.f_code.co_filename):
            yield frame
        frame = frame.f_back
