"""What a result was made on, in one line, and how many processors there are."""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any

from contwalk.version import __version__, version_of


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


@cache
def kind_of_processor() -> dict[str, str]:
    """What decides the last bits of what is computed: compiler, linear algebra and processor.

    LLVM compiles for the processor that it finds, and NumPy takes other loops by what a processor can do.
    """
    import llvmlite
    import numpy as np
    from llvmlite import binding

    from contwalk.numerics.threads import kernel

    features = binding.get_host_cpu_features().flatten()
    loops = sorted(name for name, has in _cpu_features().items() if has)
    return {
        "numpy": np.__version__,
        "numba": version_of("numba"),  # to import it takes a tenth of a short study
        "llvmlite": llvmlite.__version__,
        "processor": binding.get_host_cpu_name(),
        "features": hashlib.sha256(f"{features} {loops}".encode()).hexdigest()[:16],
        "kernel": kernel(),
    }


def _cpu_features() -> dict[str, bool]:
    """What NumPy uses of the processor; less where `NPY_DISABLE_CPU_FEATURES` says so."""
    module = import_module("numpy._core._multiarray_umath")
    return dict(getattr(module, "__cpu_features__", {}))


def versions_and_processor() -> dict[str, str]:
    """What the same bytes hang on: versions, and the kind of processor."""
    return {"contwalk_version": __version__, **kind_of_processor()}


def made_elsewhere(*provenances: Mapping[str, Any]) -> str:
    """That what was stored was made by other versions, or on another kind of processor; or ''."""
    now = versions_and_processor()
    before = ((name, str(made[name])) for made in provenances for name in now if name in made)
    other = [f"{name} {value}, now {now[name]}" for name, value in before if value != now[name]]
    if not other:
        return ""
    return (
        f"What is stored was made elsewhere ({'; '.join(other)}): the run goes on, and its last digits, and "
        "counts of points with them, may be others than those of one run."
    )


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
