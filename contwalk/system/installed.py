"""Systems that are installed: told by the entry points of packages.

To find them the metadata of all packages are looked through, by a part of Python that takes as long to import
as a small study does. So what has been found is kept on disk, under a key of all that tells it: which
packages there are, and when their lists of entry points were written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from typing import Any, NamedTuple

from contwalk import object_cache

GROUP = "contwalk.systems"
# Folders that tell of a package, and their file of entry points.
_TOLD, _POINTS = (".dist-info", ".egg-info"), "entry_points.txt"


class Installed(NamedTuple):
    """An installed system: its name, and where it is, `module:attribute`."""

    name: str
    value: str

    @property
    def module(self) -> str:
        """The module that defines it."""
        return self.value.partition(":")[0].strip()

    def load(self) -> Any:
        """What is defined there.

        Raises
        ------
        ImportError, AttributeError
            If the module, or what it is to define, is missing.
        """
        found: Any = import_module(self.module)
        for part in filter(None, self.value.partition(":")[2].split("[")[0].strip().split(".")):
            found = getattr(found, part)
        return found


@cache
def installed() -> tuple[Installed, ...]:
    """All installed systems."""
    packages = _packages()
    if packages is None:
        return _looked_up()
    name = object_cache.key("installed systems", sys.version, *packages)
    kept = object_cache.load_values(name)
    if kept is not None:
        return tuple(Installed(*point) for point in kept)
    found = _looked_up()
    object_cache.store_values(name, [tuple(point) for point in found])
    return found


def _looked_up() -> tuple[Installed, ...]:
    """As the metadata of the packages tell."""
    from importlib.metadata import entry_points  # takes long: see above

    return tuple(Installed(point.name, point.value) for point in entry_points(group=GROUP))


def _packages() -> list[str] | None:
    """What tells all entry points; None where packages may be found otherwise than in folders."""
    if any(hasattr(finder, "find_distributions") for finder in sys.meta_path if finder is not PathFinder):
        return None
    told: list[str] = []
    for folder in sys.path:
        if os.path.isfile(folder) or folder.endswith(".egg"):
            return None
        told += [folder, *sorted(_told_in(folder or os.curdir))]
    return told


def _told_in(folder: str) -> Iterator[str]:
    """Of each package that a folder tells of its name, and when its list of entry points was written."""
    try:
        names = os.listdir(folder)
    except OSError:
        return
    for name in names:
        if name.endswith(_TOLD):
            place = os.path.join(folder, name, _POINTS)
            try:
                status = os.stat(place)
            except OSError:
                yield name
            else:
                yield f"{name} {status.st_mtime_ns} {status.st_size}"
