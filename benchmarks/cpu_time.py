"""CPU seconds of other processes."""

from __future__ import annotations

import resource
import subprocess
from typing import Any


def seconds_of(command: list[str], **options: Any) -> float:
    """User and system seconds of a command and what it starts; its output is thrown away.

    Parameters
    ----------
    command : list of str
    **options
        For `subprocess.run`: cwd, env, stdin.

    Raises
    ------
    subprocess.CalledProcessError
        If the command fails.
    """
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
