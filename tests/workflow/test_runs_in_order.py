"""Runs in processes: in their order, and once more where a process was lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from contwalk.errors import ContwalkError
from contwalk.workflow.interruptions import deaf
from contwalk.workflow.many_runs import Runs


def squared(shared, task):
    return task, os.getpid(), task**2 + shared


def killed_once(folder, task):
    """The third task kills its process the first time."""
    mark = Path(folder) / f"{task}"
    if task == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def killed_always(shared, task):
    os.kill(os.getpid(), signal.SIGKILL)


def refused(shared, task):
    raise ContwalkError(f"no {task}", "")


def in_order(function, shared, tasks, **how):
    with Runs(function, shared, **how) as runs:
        return list(runs.in_order(tasks))


def test_results_come_in_the_order_of_the_tasks_from_other_processes():
    found = in_order(squared, 7, list(range(40)), jobs=2)
    assert [square for _, _, square in found] == [n**2 + 7 for n in range(40)]
    assert {process for _, process, _ in found}.isdisjoint({os.getpid()})


def test_there_are_no_more_processes_than_tasks():
    with Runs(squared, 0, jobs=500) as runs:
        assert [square for _, _, square in runs.in_order([2, 3])] == [4, 9]
        assert len(runs._pool._processes) == 2
        assert [square for _, _, square in runs.in_order([2, 3, 4])] == [4, 9, 16]
        assert len(runs._pool._processes) == 3


def test_a_process_does_not_hear_of_an_interruption_before_it_has_begun():
    with deaf():
        slow = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(0.3)"])
    slow.send_signal(signal.SIGINT)
    assert slow.wait() == 0


class Counted:
    """What is shared, and how often it was sent."""

    def __init__(self):
        self.sent = 0

    def __getstate__(self):
        self.sent += 1
        return {}


def process_of(shared, task):
    return os.getpid()


def test_what_is_shared_goes_to_each_process_once():
    """Also where runs are asked for in several parts, as those of a plane are that is refined."""
    shared = Counted()
    with Runs(process_of, shared, jobs=2) as runs:
        processes = {process for _ in range(3) for process in runs.in_order(list(range(30)))}
    assert len(processes) <= shared.sent <= 2


def test_a_lost_process_loses_nothing(tmp_path):
    assert in_order(killed_once, str(tmp_path), list(range(10)), jobs=2) == list(range(10))


def test_a_task_that_kills_its_process_each_time_is_told():
    with pytest.raises(ContwalkError, match="has died 3 times"):
        in_order(killed_always, None, [1, 2], jobs=2)


def test_an_error_of_a_run_is_raised_here():
    with pytest.raises(ContwalkError, match="no 1"):
        in_order(refused, None, [1, 2], jobs=2)


def test_anything_with_map_may_compute():
    with ThreadPoolExecutor(2) as executor:
        assert [r[2] for r in in_order(squared, 0, [1, 2, 3], executor=executor)] == [1, 4, 9]


KILLED = """\
import os, time
from contwalk.workflow.interruptions import deaf
from contwalk.workflow.many_runs import Runs

def number_of_process(shared, task):
    return os.getpid()

if __name__ == "__main__":
    with Runs(number_of_process, None, jobs=2) as runs:
        for number in runs.in_order([0, 0]):
            print(number, flush=True)
        time.sleep(60)
"""


def test_processes_end_with_the_one_that_they_work_for(tmp_path):
    script = tmp_path / "killed.py"
    script.write_text(KILLED, encoding="utf-8")
    with subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True) as main:
        assert main.stdout is not None
        assert all(int(main.stdout.readline()) != main.pid for _ in range(2))
        main.kill()
        main.communicate(timeout=20.0)  # they have the same output: it ends with the last of them
