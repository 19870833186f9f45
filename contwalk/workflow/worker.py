"""A process that walks branches for another one: `python -m contwalk.workflow.worker`.

It reads pickled requests from its standard input and writes pickled answers to its standard output, until the
input ends. What a plugin prints goes to the standard error.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Iterator
from typing import BinaryIO

from contwalk.diagram.ahead import Task
from contwalk.numerics.threads import one_thread
from contwalk.workflow.process_end import end_process, refuse_exit
from contwalk.workflow.requests import Answer, Drop, Failed, Finished, Reported, Walk
from contwalk.workflow.study_text import StudyText
from contwalk.workflow.walking_ahead import Walker
from contwalk.workflow.watching import on_stderr, watching


class Requests:
    """Requests as they come in, read by a thread: a process that nobody asks any more ends."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._walks: queue.SimpleQueue[Walk] = queue.SimpleQueue()
        self.dropped: set[Task] = set()
        threading.Thread(target=self._listen, daemon=True).start()

    def next(self) -> Walk:
        """The next branch that is wanted."""
        return self._walks.get()

    def _listen(self) -> None:
        while True:
            try:
                request = pickle.load(self._stream)
            except (EOFError, pickle.UnpicklingError):  # the one that asked has ended, or in the middle of it
                end_process(0)
            if isinstance(request, Drop):
                self.dropped.add(request.task)
            else:
                self._walks.put(request)


def main() -> None:
    """Answer requests until there are no more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever asks is told of it
    refuse_exit()
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    requests = Requests(sys.stdin.buffer)
    with one_thread(), watching(on_stderr):
        while True:
            wanted = requests.next()
            for answer in _answers(wanted, requests.dropped):
                try:
                    pickle.dump(answer, answers, pickle.HIGHEST_PROTOCOL)
                    answers.flush()
                except BrokenPipeError:  # nobody is there to read it
                    end_process(0)


_WALKERS: dict[StudyText, Walker] = {}


def _answers(wanted: Walk, dropped: set[Task]) -> Iterator[Answer]:
    try:
        if wanted.study not in _WALKERS:
            _WALKERS[wanted.study] = Walker(wanted.study)
        for message in _WALKERS[wanted.study].messages(wanted.task):
            if wanted.task in dropped:
                break
            yield Reported(message)
        yield Finished()
    except Exception:  # whoever asks walks it, and is told what is wrong where it can be told
        yield Failed(traceback.format_exc())


if __name__ == "__main__":
    main()
