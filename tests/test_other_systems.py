"""No module needs at import what not every operating system has: tested by hiding it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import contwalk

ROOT = Path(contwalk.__file__).parent
# Windows has no `fcntl` and `resource`, and of the signals these; macOS no affinity of processes.
HIDDEN = """
import importlib, os, signal, sys

for name in ("fcntl", "resource", "grp", "pwd", "termios"):
    sys.modules[name] = None
for name in ("SIGKILL", "SIGHUP", "SIGALRM", "SIGUSR1", "SIGPIPE", "pthread_sigmask", "setitimer"):
    delattr(signal, name)
for name in ("fork", "geteuid", "getuid", "fchmod", "fchown", "chown", "killpg", "sched_getaffinity"):
    delattr(os, name)
"""


def run(code: str, *arguments: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", HIDDEN + code, *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_module_is_imported_without_them(tmp_path):
    names = [
        ".".join(path.relative_to(ROOT.parent).with_suffix("").parts)
        for path in sorted(ROOT.rglob("*.py"))
        if path.name not in ("__init__.py", "__main__.py")
    ]
    # A cluster's library is an extra.
    names.remove("contwalk.workflow.cluster")
    code = "print(len([importlib.import_module(name) for name in sys.argv[1:]]))"
    assert int(run(code, *names, folder=tmp_path)) == len(names)


def test_a_study_runs_without_them(tmp_path):
    """With a figure, a database that is locked as far as there are locks, and two processes."""
    # Python's own `subprocess` ends processes by SIGKILL here.
    code = """
signal.SIGKILL = 9
from contwalk.cli.entry import run
assert run(["new", "fork"]) == 0
assert run(["continue", "fork.yaml", "--quiet", "--jobs", "2"]) == 0
assert run(["show", "fork.h5", "b1/HB1"]) == 0
"""
    assert "supercritical" in run(code, folder=tmp_path)
    assert (tmp_path / "fork_bifurcation_diagram.png").stat().st_size > 0
