"""Runs in processes: in their order, and once more where a process was lost."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from contwalk.errors import ContwalkError
from contwalk.workflow.many_runs import in_order


def squared(task):
    return task, os.getpid(), task**2


def killed_once(folder, task):
    """The third task kills its process the first time."""
    mark = Path(folder) / f"{task}"
    if task == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return task


def killed_always(task):
    os.kill(os.getpid(), signal.SIGKILL)


def refused(task):
    raise ContwalkError(f"no {task}", "")


def test_results_come_in_the_order_of_the_tasks_from_other_processes():
    found = list(in_order(squared, list(range(40)), jobs=2))
    assert [square for _, _, square in found] == [n**2 for n in range(40)]
    assert {process for _, process, _ in found}.isdisjoint({os.getpid()})


def test_a_lost_process_loses_nothing(tmp_path):
    assert list(in_order(partial(killed_once, str(tmp_path)), list(range(10)), jobs=2)) == list(range(10))


def test_a_task_that_kills_its_process_each_time_is_told():
    with pytest.raises(ContwalkError, match="has died 3 times"):
        list(in_order(killed_always, [1, 2], jobs=2))


def test_an_error_of_a_run_is_raised_here():
    with pytest.raises(ContwalkError, match="no 1"):
        list(in_order(refused, [1, 2], jobs=2))


def test_anything_with_map_may_compute():
    with ThreadPoolExecutor(2) as executor:
        assert [r[2] for r in in_order(squared, [1, 2, 3], executor=executor)] == [1, 4, 9]
