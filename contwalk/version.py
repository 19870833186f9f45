"""The version of contwalk, as the package says it, and those of others."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from functools import cache

__version__ = "0.1.0"
_TOLD = ".dist-info"


@cache
def version_of(package: str) -> str:
    """The version of an installed package, by the name of the folder that tells of it.

    `importlib.metadata` says the same, but takes a fiftieth of a short study to be imported.
    """
    for folder in sys.path:
        with suppress(OSError):
            for name in os.listdir(folder or os.curdir):
                if name.startswith(f"{package}-") and name.endswith(_TOLD):
                    return name.removeprefix(f"{package}-").removesuffix(_TOLD)
    from importlib.metadata import version  # installed in another way

    return version(package)
