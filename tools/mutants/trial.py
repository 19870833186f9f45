"""One mutant tried: in a copy of the tree, by a process forked from one that has the libraries loaded."""

from __future__ import annotations

import importlib
import math
import os
import resource
import signal
import sys
import time
from pathlib import Path

from tools.mutants.sites import Mutant

# What every test needs, loaded once; contwalk itself is imported anew by every trial. Not hypothesis: pytest
# warns of its own plugins that were imported before it, and warnings are errors.
LIBRARIES = (
    "numpy",
    "scipy.integrate",
    "scipy.optimize",
    "h5py",
    "llvmlite.binding",
    "matplotlib.pyplot",
    "mpmath",
    "click",
    "pydantic",
    "pytest",
    "rich.console",
    "ruamel.yaml",
)
# A trial may take so many times what its tests took, and so many seconds more: code that is compiled anew.
# The processor's time counts, since others may use the machine as well; what waits for nothing ends later.
PATIENCE, START, WAITING = 2.0, 25.0, 20.0


def load_libraries() -> None:
    """Import what all trials share."""
    for name in LIBRARIES:
        importlib.import_module(name)


def tried(copy: Path, mutant: Mutant, tests: list[str], seconds: float) -> str:
    """`killed`, `timeout` or `survived`; the copy is as it was afterwards.

    Raises
    ------
    ValueError
        If the line is not what it was when the mutant was made.
    """
    path = copy / mutant.file
    original = path.read_text()
    lines = original.split("\n")
    if lines[mutant.line - 1] != mutant.old:
        raise ValueError(f"{mutant.file}:{mutant.line} is not '{mutant.old.strip()}'")
    lines[mutant.line - 1] = mutant.new
    path.write_text("\n".join(lines))
    try:
        status = passes(copy, tests, PATIENCE * seconds + START)
    finally:
        path.write_text(original)
    return {True: "survived", False: "killed", None: "timeout"}[status]


def passes(copy: Path, tests: list[str], patience: float) -> bool | None:
    """Whether all tests pass in a copy; None where so many seconds of the processor are not enough."""
    child = os.fork()
    if child == 0:
        _run(copy, tests, patience)
    deadline = time.monotonic() + WAITING * patience
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            code = os.waitstatus_to_exitcode(status)
            return None if code == -signal.SIGXCPU else code == 0
        if time.monotonic() > deadline:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return None
        time.sleep(0.02)


def _run(copy: Path, tests: list[str], patience: float) -> None:
    """The forked process: pytest in the copy, silent, stopping at the first failure."""
    os.setpgid(0, 0)
    limit = math.ceil(patience)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 10))
    os.chdir(copy)
    sys.path[:0] = [str(copy)]
    sys.dont_write_bytecode = True
    sys.stdin = open(os.devnull)  # noqa: SIM115 - for as long as the process lives
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    import pytest

    status = 1
    try:
        status = int(
            pytest.main(["-x", "-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:xdist", *tests])
        )
    finally:
        os._exit(status)
