"""Commands in processes forked from one that has imported and compiled everything, with faults if wanted."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(__file__).with_name("faults.c")
# Seconds of CPU and bytes that no command of a trial needs, and seconds after which it hangs on any machine.
LONGEST, LARGEST, HANGS = 60, 4 << 30, 900
WORKERS = ("contwalk.workflow.worker", "spawn_main")  # not those with which Python keeps its own house
PATIENCE = 120  # seconds in which processes that nobody asks any more end
ARMED = "CONTWALK_TRIAL_FAULTS"


def with_faults() -> None:
    """Start this program again with the library that makes writes fail in front of all others."""
    if ARMED in os.environ:
        return
    library = Path(tempfile.mkdtemp(prefix="contwalk_trial_")) / "faults.so"
    compiler = os.environ.get("CC", "cc")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", library, SOURCE, "-ldl"], check=True)
    variables = {**os.environ, ARMED: str(library), "LD_PRELOAD": str(library), "COLUMNS": "200"}
    os.execve(sys.executable, [sys.executable, "-m", "tools.trial", *sys.argv[1:]], variables)


@dataclass(frozen=True)
class Fault:
    """What happens at the nth write: an `errno`, or the process is killed where that is -1; 0: nothing."""

    nth: int = 0
    how: int = 0


@dataclass(frozen=True)
class Done:
    """How a command ended: exit code, negative for a signal; what it has said; how many writes there were."""

    code: int
    said: str
    writes: int


class Running:
    """A command in a process of its own."""

    def __init__(self, folder: Path, arguments: tuple[str, ...], fault: Fault = Fault()) -> None:
        self._said, (self._read, write) = tempfile.TemporaryFile("w+b"), os.pipe()  # noqa: SIM115 (as long as it runs)
        self._pid = os.fork()
        if self._pid == 0:
            os.setpgid(0, 0)
            _become(folder, arguments, fault, self._said.fileno(), write)
        os.close(write)

    def worker(self) -> int | None:
        """A process that works for it, once there is one; None where it ends without."""
        until, children = time.monotonic() + HANGS, Path(f"/proc/{self._pid}/task/{self._pid}/children")
        while time.monotonic() < until:
            try:
                for number in children.read_text(encoding="ascii").split():
                    given = Path(f"/proc/{number}/cmdline").read_text(errors="replace")
                    if any(name in given for name in WORKERS):
                        return int(number)
            except OSError:
                return None
            time.sleep(0.02)
        return None

    def all_ended(self) -> bool:
        """Whether what it has begun ends as well, soon; what does not is ended here."""
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            try:
                os.killpg(self._pid, 0)
            except ProcessLookupError:
                return True
            time.sleep(0.05)
        os.killpg(self._pid, signal.SIGKILL)
        return False

    def done(self) -> Done:
        """Wait for its end."""
        _, status = os.waitpid(self._pid, 0)
        writes = os.read(self._read, 64)
        os.close(self._read)
        self._said.seek(0)
        code = os.waitstatus_to_exitcode(status)
        return Done(code, self._said.read().decode(errors="replace"), int(writes or b"0"))


def done(folder: Path, *arguments: str, fault: Fault = Fault()) -> Done:
    """Run a command to its end."""
    return Running(folder, arguments, fault).done()


def _become(folder: Path, arguments: tuple[str, ...], fault: Fault, said: int, write: int) -> None:
    """Be the command; never returns."""
    code = 99
    try:
        os.chdir(folder)
        os.dup2(said, 1)
        os.dup2(said, 2)
        signal.alarm(HANGS)
        resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST))
        resource.setrlimit(resource.RLIMIT_AS, (LARGEST, LARGEST))
        from contwalk.cli.entry import run

        library = ctypes.CDLL(os.environ[ARMED])
        library.trial_arm(ctypes.c_long(fault.nth), ctypes.c_int(fault.how))
        code = run(arguments)
        library.trial_arm(ctypes.c_long(0), ctypes.c_int(0)) if fault.nth else None
        os.write(write, str(library.trial_count()).encode())
        sys.stdout.flush()
    finally:
        os._exit(code)
