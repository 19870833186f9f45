"""What a result was made on, in one line, and how many processors there are."""

from __future__ import annotations

import os
import platform
import sys


def name_of_machine() -> str:
    """System, release, processor and C library, as `platform.platform` tells.

    That one starts a process to ask for the processor, and reads the interpreter's file for the library.
    """
    if not sys.platform.startswith("linux"):
        return platform.platform()
    own = os.uname()
    try:
        library = (os.confstr("CS_GNU_LIBC_VERSION") or "").replace(" ", "")
    except (OSError, ValueError):  # another C library than GNU's
        return platform.platform()
    return (
        "-".join([own.sysname, own.release, own.machine, "with", library]) if library else platform.platform()
    )


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
