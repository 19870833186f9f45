"""Branches walked in processes of this machine, each told as it is found."""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from bisect import insort
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from contwalk.branch import Outcome
from contwalk.diagram.ahead import Ends, Message, Task
from contwalk.workflow.interruptions import deaf
from contwalk.workflow.machine import processors
from contwalk.workflow.requests import Answer, Drop, Failed, Finished, Reported, Walk
from contwalk.workflow.walking_ahead import StudyText, Walker, failed_elsewhere

# A branch that has ended so many processes, and ends one more, is walked by this one where that was killed;
# where they ended by themselves this one would end too.
MOST_LOST = 2
# Some of these signals are not everywhere.
KILLED = [getattr(signal, name, None) for name in ("SIGKILL", "SIGTERM", "SIGINT", "SIGHUP")]
# What is said of a process that has ended.
LOST = (
    "A process that computed a branch has ended, by itself or by a signal; another one computes it again, "
    "to the same points."
)


@dataclass(frozen=True)
class _Again:
    """The process that walked a branch has ended; another one walks it from its beginning."""


@dataclass(frozen=True)
class _Fatal:
    """Whatever walks the branch ends; `how`, in words."""

    how: str


@dataclass
class _Feed:
    """What has been told of a branch and was not taken over yet."""

    answers: queue.SimpleQueue[Answer | _Again | _Fatal] = field(default_factory=queue.SimpleQueue)
    lost: int = 0


class _Process:
    """One process, the branch that it walks, and whether it has told anything yet."""

    def __init__(self, pool: Workers) -> None:
        self.task: Task | None = None
        self.has_answered = False
        self._pool = pool
        threads = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "MKL", "OMP")}
        paths = {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        with deaf():
            self._process = subprocess.Popen(
                [sys.executable, "-m", "contwalk.workflow.worker"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, **threads, **paths},
            )
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    @property
    def number(self) -> int:
        """What the operating system calls it."""
        return self._process.pid

    @property
    def own_end(self) -> str:
        """How it has ended by itself, in words; empty where it was killed."""
        code = self._process.poll()
        if code is None or -code in KILLED:
            return ""
        if code >= 0:
            return f"ended itself with exit code {code}"
        return f"was ended by signal {-code}"

    def send(self, request: Walk | Drop) -> None:
        """Ask it; one that has ended is noticed where it is listened to."""
        assert self._process.stdin is not None
        with suppress(OSError, ValueError):
            pickle.dump(request, self._process.stdin, pickle.HIGHEST_PROTOCOL)
            self._process.stdin.flush()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        while True:
            try:
                answer = pickle.load(self._process.stdout)
            except (EOFError, OSError, ValueError, pickle.UnpicklingError):
                break
            self._pool.answered(self, answer)
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):  # what was asked last and not read
                assert pipe is not None
                pipe.close()
        self._pool.ended(self)

    def end(self) -> None:
        """End it, whatever it does."""
        self._process.kill()
        self._listener.join()


def _ends_processes(how: str) -> Outcome:
    """The outcome of a branch that nobody can compute to its end."""
    return Outcome(
        "failed",
        "plugin_error",
        f"The branch cannot be computed: {MOST_LOST + 1} processes have ended while they did, and the last "
        f"one {how}. Does the plugin, or a library that it calls, end the process? Mend the plugin.",
    )


class Workers:
    """So many processes that walk branches of one run file.

    Parameters
    ----------
    study : StudyText
    count : int
        Processes, at most; each begins when there is something to do for it.
    tell : callable, optional
        Given a sentence where a branch is walked again: what is stored does not show it.
    """

    def __init__(self, study: StudyText, count: int, tell: Callable[[str], None] = lambda text: None) -> None:
        self._study, self._count, self._tell = study, count, tell
        self._lock = threading.RLock()
        self._processes: list[_Process] = []
        self._feeds: dict[Task, _Feed] = {}
        self._waiting: list[tuple[Any, Task]] = []
        self._begun = self._closed = False

    def expect(self, tasks: Sequence[Task]) -> None:
        """These branches are likely to be asked for; none is walked before the first one is."""
        with self._lock:
            for task in tasks:
                if task not in self._feeds:
                    self._feeds[task] = _Feed()
                    insort(self._waiting, (task.turn, task), key=lambda entry: entry[0])
            self._give_out()

    def drop(self, task: Task) -> None:
        """This branch will not be asked for."""
        with self._lock:
            self._feeds.pop(task, None)
            self._waiting = [entry for entry in self._waiting if entry[1] != task]
            for process in self._processes:
                if process.task == task:
                    process.send(Drop(task))

    def messages(self, task: Task) -> Iterator[Message]:
        """What is told of a branch, as it comes; walked in this process where others cannot."""
        self._begun = True
        self.expect([task])
        feed, taken, place = self._feeds[task], 0, 0
        while True:
            answer = feed.answers.get()
            if isinstance(answer, Reported):
                place += 1
                if place > taken:
                    taken = place
                    yield answer.message
            elif isinstance(answer, _Again):
                self._tell(LOST)
                place = 0
            elif isinstance(answer, Finished):
                break
            elif isinstance(answer, _Fatal):
                yield Ends(((task.side or 1.0, _ends_processes(answer.how)),), True)
                break
            else:
                self._tell(failed_elsewhere(answer.trace))
                yield from islice(Walker(self._study).messages(task), taken, None)
                break
        with self._lock:
            del self._feeds[task]

    @property
    def process_ids(self) -> list[int]:
        """Of the processes that there are now."""
        with self._lock:
            return [process.number for process in self._processes]

    def close(self) -> None:
        """End all processes."""
        with self._lock:
            self._closed, self._waiting = True, []
            processes, self._processes = self._processes, []
        for process in processes:
            process.end()

    # -- called by the threads that listen to processes ------------------------------------------------------

    def answered(self, process: _Process, answer: Answer) -> None:
        """A process has told something."""
        with self._lock:
            task = process.task
            if task is not None and task in self._feeds:
                self._feeds[task].answers.put(answer)
            begins, process.has_answered = not process.has_answered, True
            if not isinstance(answer, Reported):
                process.task = None
            if begins or process.task is None:
                self._give_out()

    def ended(self, process: _Process) -> None:
        """A process has ended: what it walked is walked again, by another one."""
        with self._lock:
            if self._closed or process not in self._processes:
                return
            self._processes.remove(process)
            task = process.task
            if task is not None and task in self._feeds:
                feed = self._feeds[task]
                feed.lost += 1
                if feed.lost > MOST_LOST and process.own_end:
                    feed.answers.put(_Fatal(process.own_end))
                elif feed.lost > MOST_LOST:
                    feed.answers.put(Failed(f"{feed.lost} processes have ended while they computed it"))
                else:
                    feed.answers.put(_Again())
                    insort(self._waiting, (task.turn, task), key=lambda entry: entry[0])
            self._give_out()

    def _give_out(self) -> None:
        """Branches that wait to processes that do nothing, the first ones first.

        Where as many processes begin as there are processors another one would only take their time: by when
        they are there, those that are may have done all there is to do.
        """
        while self._begun and self._waiting and not self._closed:
            free = next((process for process in self._processes if process.task is None), None)
            if free is None:
                beginning = sum(not process.has_answered for process in self._processes)
                if len(self._processes) >= self._count or beginning >= processors():
                    return
                free = _Process(self)
                self._processes.append(free)
            task = self._waiting.pop(0)[1]
            free.task = task
            free.send(Walk(self._study, task))
