"""A plugin that calls `os._exit(0)` is told, and the run fails: nothing of Python runs after it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import contwalk as cw
from contwalk.workflow import process_end

PLUGIN = """\
import os

from contwalk.system import Mode, Observable, Parameter, State, System


def field(t, x, p, dx):
    dx[0] = p.a - x[0] ** 2


def seen(t, x, p):
    if x[-1, 0] > LEVEL:
        os._exit(0)
    return float(x[-1, 0])


SYSTEM = System(
    "leaving",
    states=(State("x", "1", 1.0),),
    parameters=(Parameter("a", 1.0),),
    modes=(Mode("smooth", field),),
    observables=(Observable("seen", seen),),
)
"""
RUN = """\
system: ./leaving.py
start: {state: {x: 1.0}}
continue: {parameter: a, range: [0.5, 3.0]}
output: leaving.h5
"""


@pytest.mark.drawn
@pytest.mark.parametrize("jobs", ["1", "2"])
@pytest.mark.parametrize(("level", "where"), [(1.2, "Forward: "), (0.9, "The start fails: ")])
def test_a_plugin_that_ends_the_process_fails_its_branch(folder, jobs, level, where):
    (folder / "leaving.py").write_text(PLUGIN.replace("LEVEL", str(level)), encoding="utf-8")
    (folder / "leaving.yaml").write_text(RUN, encoding="utf-8")
    command = [sys.executable, "-m", "contwalk", "continue", "leaving.yaml", "--no-figures", "--jobs", jobs]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    assert done.returncode == 1
    assert f"branch b1 failed (plugin_error): {where}" in done.stderr
    assert "line 12: SystemExit: 0" in done.stderr
    with cw.open_database(folder / "leaving.h5") as db:
        (branch,) = db.branches()
        assert (branch.outcome.status, branch.outcome.reason) == ("failed", "plugin_error")


def test_a_process_that_is_forked_may_end(monkeypatch):
    ended: list[int] = []
    monkeypatch.setattr(process_end, "end_process", ended.append)
    monkeypatch.setattr(os, "_exit", os._exit)
    process_end.refuse_exit()
    with pytest.raises(SystemExit, match="3"):
        os._exit(3)
    assert not ended
    monkeypatch.setattr(os, "getpid", lambda: -1)
    with pytest.raises(SystemExit):
        os._exit(4)
    assert ended == [4]
